//! What naming an effect gains: the fall of the error over repeats that no fit has seen, with its interval.

use crate::calibration::distribution::student_critical;

/// Level that an interval misses: 95 % intervals.
const MISSED: f64 = 0.05;

/// Fall of the error over repeats of every command, each predicted from the others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gain {
    /// Root mean square error with the base, in the channel's unit.
    pub before: f64,
    /// The same with the effects.
    pub after: f64,
    /// The part of the error that is gone, with 95 % certainty, from what runs of a command differ by. From minus infinity
    /// where they do not differ at all.
    pub part95: (f64, f64),
}

/// Squared errors of one run that was left out: with the base and with the effects, and its samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Missed {
    /// Place of its command.
    pub command: usize,
    /// With the base.
    pub before: f64,
    /// With the effects.
    pub after: f64,
    /// Samples.
    pub count: f64,
}

impl Gain {
    /// Over runs of commands that were given twice or more; `None` where there is none, or the base misses nothing.
    ///
    /// A run's gain, zero and time are its own, so runs scatter, and their samples do not add up to more. To first order the
    /// logarithm of the ratio of both sums varies by what `after / sum - before / sum` of a command's runs varies by. Degrees
    /// of freedom are Satterthwaite's: of few runs of one large command there are few.
    pub(super) fn of(runs: &[Missed]) -> Option<Self> {
        let is_repeated = |run: &&Missed| runs.iter().filter(|other| other.command == run.command).count() > 1;
        let runs: Vec<Missed> = runs.iter().filter(is_repeated).copied().collect();
        let sum = |of: fn(&Missed) -> f64| runs.iter().map(of).sum::<f64>();
        let (count, before, after) = (sum(|r| r.count), sum(|r| r.before), sum(|r| r.after));
        if !(count > 0.0 && before > 0.0 && after > 0.0) {
            return None;
        }
        let commands = 1 + runs.iter().map(|run| run.command).max()?;
        let (mut variance, mut fourth) = (0.0, 0.0);
        for command in 0..commands {
            let own = runs.iter().filter(|run| run.command == command);
            let moves: Vec<f64> = own.map(|run| run.after / after - run.before / before).collect();
            if !moves.is_empty() {
                let (n, mean) = (moves.len() as f64, moves.iter().sum::<f64>() / moves.len() as f64);
                let own = n * moves.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (n - 1.0);
                variance += own;
                fourth += own * own / (n - 1.0);
            }
        }
        let ratio = (after / before).sqrt();
        let width = match fourth > 0.0 {
            true => 0.5 * variance.sqrt() * student_critical(MISSED, variance * variance / fourth),
            false => f64::INFINITY,
        };
        Some(Gain {
            before: (before / count).sqrt(),
            after: (after / count).sqrt(),
            part95: (1.0 - ratio * width.exp(), 1.0 - ratio * (-width).exp()),
        })
    }

    /// The part of the error that is gone.
    #[must_use]
    pub fn part(&self) -> f64 {
        1.0 - self.after / self.before
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64;

    use super::*;

    /// Nine commands three times, one of them larger than the others: a run's gain is its own by `JITTER`, the base is off by
    /// `OFF` as well.
    fn drawn(chance: &mut Pcg64) -> Vec<Missed> {
        let mut normal = || -> f64 { StandardNormal.sample(chance) };
        let run = |i: usize| {
            let size = if i < 3 { 20.0 } else { 1.0 + (i / 3) as f64 };
            let own = JITTER * normal();
            Missed { command: i / 3, before: size * (own + OFF).powi(2), after: size * own * own, count: 100.0 }
        };
        (0..27).map(run).collect()
    }
    const JITTER: f64 = 0.03;
    const OFF: f64 = 0.05;

    #[test]
    fn the_interval_holds_the_true_gain_as_often_as_it_says() {
        let mut chance = Pcg64::seed_from_u64(11);
        let truth = 1.0 - JITTER / JITTER.hypot(OFF);
        let all: Vec<Gain> = (0..2000).map(|_| Gain::of(&drawn(&mut chance)).unwrap()).collect();
        let held = all.iter().filter(|gain| gain.part95.0 <= truth && truth <= gain.part95.1).count();
        // 95 % but for the skew of squares of few draws
        assert!((1740..=1940).contains(&held), "{held} of 2000");
        let first = all[0];
        assert!(first.part95.0 < first.part() && first.part() < first.part95.1, "{first:?}");
    }

    #[test]
    fn runs_that_do_not_differ_tell_no_interval_and_a_run_alone_no_gain() {
        let one = Missed { command: 0, before: 4.0, after: 1.0, count: 1.0 };
        let gain = Gain::of(&[one, one]).unwrap();
        assert_eq!((gain.before, gain.after, gain.part()), (2.0, 1.0, 0.5));
        assert_eq!(gain.part95, (f64::NEG_INFINITY, 1.0));
        // a large command that was given once counts in nothing
        let large = Missed { command: 1, before: 400.0, after: 400.0, count: 1.0 };
        assert_eq!(Gain::of(&[one, large, one]), Some(gain));
        assert_eq!(Gain::of(&[one, Missed { command: 1, ..one }]), None);
        assert_eq!(Gain::of(&[]), None);
    }
}
