//! How a diagnosis is asked for.

use std::str::FromStr;

/// Which way of coming to a verdict.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Edition {
    /// Effects must pass a list of demands, one after the other.
    #[default]
    First,
    /// Sets of effects are weighed by their evidence, with what no effect explains in each of them
    /// (docs/decisions/0005-one-model.md). In trial.
    Second,
}

impl FromStr for Edition {
    type Err = String;

    /// `first` or `second`.
    fn from_str(name: &str) -> Result<Self, String> {
        match name {
            "first" => Ok(Self::First),
            "second" => Ok(Self::Second),
            _ => Err("expected first or second".to_owned()),
        }
    }
}

/// How a diagnosis is asked for.
#[derive(Debug, Clone, Copy, Default)]
pub struct Asked<'a> {
    /// Codes that the catalogue lacks: what they would explain should then be unknown.
    pub without: &'a [&'a str],
    /// Which way of coming to a verdict.
    pub edition: Edition,
}
