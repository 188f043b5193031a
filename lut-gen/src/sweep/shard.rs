//! One part of a sweep, for one of several machines.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// Part `index` of `count`, counted from 1: every `count`-th point. Neighbours in the grid cost about
/// the same, so the parts do too.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shard {
    index: usize,
    count: usize,
}

/// A shard that is none.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("shard \"{0}\" is not one; expected i/n, part i of n with i from 1 to n and n at most 1000000, such as 1/4")]
pub struct ShardError(String);

impl Shard {
    /// The whole sweep as one part.
    pub const WHOLE: Self = Self { index: 1, count: 1 };

    /// Its number, from 1.
    #[must_use]
    pub fn index(self) -> usize {
        self.index
    }

    /// How many there are.
    #[must_use]
    pub fn count(self) -> usize {
        self.count
    }

    /// Whether a job belongs to it.
    #[must_use]
    pub fn holds(self, job: usize) -> bool {
        job % self.count == self.index - 1
    }
}

impl FromStr for Shard {
    type Err = ShardError;

    fn from_str(text: &str) -> Result<Self, ShardError> {
        let refused = || ShardError(text.to_owned());
        let (index, count) = text.split_once('/').ok_or_else(refused)?;
        let whole = |t: &str| t.parse::<usize>().ok().filter(|n| (1..=1_000_000).contains(n));
        match (whole(index), whole(count)) {
            (Some(index), Some(count)) if index <= count => Ok(Self { index, count }),
            _ => Err(refused()),
        }
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn every_job_belongs_to_one_shard() {
        let shards: Vec<Shard> = ["1/3", "2/3", "3/3"].iter().map(|t| t.parse().unwrap()).collect();
        for job in 0..10 {
            assert_eq!(shards.iter().filter(|s| s.holds(job)).count(), 1);
        }
        assert!((0..10).all(|job| Shard::WHOLE.holds(job)));
        assert_eq!(shards[1].to_string(), "2/3");
    }

    #[test]
    fn what_is_no_shard_is_refused() {
        for text in ["5/4", "0/4", "1/0", "1", "", "a/b", "-1/2", "1/2/3", "1/99999999999999999999"] {
            let error = text.parse::<Shard>().unwrap_err().to_string();
            assert!(error.starts_with(&format!("shard \"{text}\" is not one; expected i/n")), "{error}");
        }
    }
}
