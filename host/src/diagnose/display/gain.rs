//! What naming an effect gains: the fall of the error over repeats that no fit has seen, with its interval.

use nalgebra::{DMatrix, DVector};

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

/// What is missed of one run that was left out, 0 where it is not compared, and what runs differ by.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Missed {
    /// Place of its command.
    pub command: usize,
    /// Measured less predicted with the base.
    pub before: DVector<f64>,
    /// The same with the effects.
    pub after: DVector<f64>,
    /// What it may differ by from its repeats: columns of unit deviation.
    pub scatter: DMatrix<f64>,
    /// Expected sum of the squares of the sensor's noise.
    pub noise: f64,
    /// Samples.
    pub count: f64,
}

/// What repeats of a command tell.
struct Repeats<'a> {
    runs: Vec<&'a Missed>,
    /// Mean error with the base and with the effects.
    before: DVector<f64>,
    after: DVector<f64>,
    /// Expected square of what one run differs by, as it is stated: its own scatter, and the sensor's noise.
    of_a_run: f64,
}

impl<'a> Repeats<'a> {
    fn of(runs: Vec<&'a Missed>) -> Self {
        let least = runs.iter().map(|run| run.before.len()).min().unwrap_or(0);
        let share = 1.0 / runs.len() as f64;
        let mean = |of: &dyn Fn(&Missed) -> DVector<f64>| {
            runs.iter().fold(DVector::zeros(least), |sum, run| sum + share * of(run).rows(0, least))
        };
        Self {
            before: mean(&|run| run.before.clone()),
            after: mean(&|run| run.after.clone()),
            of_a_run: runs.iter().map(|run| share * (run.scatter.norm_squared() + run.noise)).sum(),
            runs,
        }
    }

    fn count(&self) -> f64 {
        self.runs.len() as f64
    }

    /// Sum of the squares of what its runs differ by from their mean.
    fn apart(&self) -> f64 {
        let rows = self.after.len();
        self.runs.iter().map(|run| (run.after.rows(0, rows) - &self.after).norm_squared()).sum()
    }

    /// What the effects take off the error of the run that was left out the `at`-th time.
    fn taken(&self, at: usize) -> DVector<f64> {
        let run = self.runs[at % self.runs.len()];
        let rows = self.after.len();
        run.before.rows(0, rows) - run.after.rows(0, rows)
    }

    /// Variance of a sum over its runs of what they miss times a weight.
    fn variance(&self, weight: &DVector<f64>) -> f64 {
        let own = |run: &&Missed| run.scatter.rows(0, weight.len()).tr_mul(weight).norm_squared();
        self.runs.iter().map(own).sum()
    }
}

impl Gain {
    /// Over runs of commands that were given twice or more; `None` where there is none, or the base misses nothing.
    ///
    /// The error of a new run is what all runs of its command miss, and what a run differs by from another. Of few runs
    /// of a large command the second is hardly known from their own squares: gain, zero and time of all commands state
    /// it, times a number that all runs have a say in. What the effects take off is the difference of both predictions,
    /// and what they leave is as much of the mean error as the scatter does not make. To first order the logarithm of the
    /// ratio of both errors varies by that number's uncertainty, by what the scatter moves the means of the runs by, and
    /// by the amounts of the effects.
    pub(super) fn of(runs: &[Missed]) -> Option<Self> {
        let commands = 1 + runs.iter().map(|run| run.command).max()?;
        let of_command = |command| runs.iter().filter(move |run| run.command == command).collect::<Vec<_>>();
        let all = (0..commands).map(of_command).filter(|own| own.len() > 1).map(Repeats::of);
        let all: Vec<Repeats<'_>> = all.collect();
        let sum = |of: &dyn Fn(&Repeats<'_>) -> f64| all.iter().map(of).sum::<f64>();
        let freedom = sum(&|own| own.count() - 1.0);
        let count = sum(&|own| own.runs.iter().map(|run| run.count).sum());
        let scale = sum(&|own| own.apart() / own.of_a_run.max(f64::MIN_POSITIVE)) / freedom;
        let apart = sum(&|own| own.count() * scale * own.of_a_run);
        // the part of the mean error with the effects that their law leaves, and not the scatter of the runs
        let mean = sum(&|own| own.count() * own.after.norm_squared());
        let left = (mean - sum(&|own| scale * own.of_a_run)).max(0.0);
        let share = if mean > 0.0 { left / mean } else { 0.0 };
        let both = sum(&|own| own.count() * 2.0 * own.after.dot(&(&own.before - &own.after)));
        let times = all.iter().map(|own| own.runs.len()).max()?;
        let taken: Vec<f64> = (0..times).map(|at| sum(&|own| own.count() * own.taken(at).norm_squared())).collect();
        let usual = taken.iter().sum::<f64>() / times as f64;
        let after = left + apart;
        let before = usual + share * both + after;
        if !(count > 0.0 && before > 0.0 && after > 0.0) {
            return None;
        }
        let of_scale = 2.0 / freedom * (apart * (1.0 / after - 1.0 / before)).powi(2);
        let of_means = sum(&|own| {
            let change = &own.after * (1.0 / after - 1.0 / before) - (&own.before - &own.after) / before;
            scale * own.variance(&(2.0 * share * change))
        });
        // each time the effects were fitted without another run: jackknife
        let jackknife = (times - 1) as f64 / times as f64;
        let of_amounts = jackknife * taken.iter().map(|own| ((own - usual) / before).powi(2)).sum::<f64>();
        let ratio = (after / before).sqrt();
        let width = match apart > 0.0 {
            true => 0.5 * (of_scale + of_means + of_amounts).sqrt() * student_critical(MISSED, freedom),
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

    const SAMPLES: usize = 20;
    const JITTER: f64 = 0.03;
    const OFF: f64 = 0.05;

    /// Nine commands three times, one of them larger than the others: a run's gain is its own by `JITTER`, the base is off by
    /// `OFF` as well. The scatter that is stated is twice as large.
    fn drawn(chance: &mut Pcg64) -> Vec<Missed> {
        let mut normal = || -> f64 { StandardNormal.sample(chance) };
        let own: Vec<f64> = (0..27).map(|_| JITTER * normal()).collect();
        let run = |i: usize| {
            let size = if i < 3 { 20.0 } else { 1.0 + (i / 3) as f64 };
            let shape = DVector::from_element(SAMPLES, size);
            let scatter = DMatrix::from_columns(&[2.0 * JITTER * &shape]);
            let (before, after) = (&shape * (own[i] + OFF), &shape * own[i]);
            Missed { command: i / 3, before, after, scatter, noise: 0.0, count: SAMPLES as f64 }
        };
        (0..27).map(run).collect()
    }

    #[test]
    fn the_interval_holds_the_true_gain_as_often_as_it_says() {
        let mut chance = Pcg64::seed_from_u64(11);
        let truth = 1.0 - JITTER / JITTER.hypot(OFF);
        let draw = |chance: &mut Pcg64| {
            let runs = drawn(chance);
            let sum = |of: fn(&Missed) -> &DVector<f64>| runs.iter().map(|run| of(run).norm_squared()).sum::<f64>();
            let own = 1.0 - (sum(|run| &run.after) / sum(|run| &run.before)).sqrt();
            (Gain::of(&runs).unwrap(), own)
        };
        let all: Vec<(Gain, f64)> = (0..2000).map(|_| draw(&mut chance)).collect();
        let held = all.iter().filter(|(gain, _)| gain.part95.0 <= truth && truth <= gain.part95.1).count();
        // 95 % but for what is of second order
        assert!((1800..=1970).contains(&held), "{held} of 2000");
        let square = |of: &dyn Fn(&(Gain, f64)) -> f64| all.iter().map(|one| (of(one) - truth).powi(2)).sum::<f64>();
        // the largest command has three runs only, and their own squares say less than the scatter of all
        let (pooled, alone) = (square(&|(gain, _)| gain.part()), square(&|(_, own)| *own));
        assert!(pooled < 0.5 * alone, "{pooled} {alone} {held}");
    }

    #[test]
    fn a_run_alone_tells_no_gain_and_counts_in_nothing() {
        let one = |command: usize, size: f64| Missed {
            command,
            before: DVector::from_element(1, 2.0 * size),
            after: DVector::from_element(1, size),
            scatter: DMatrix::zeros(1, 0),
            noise: 0.0,
            count: 1.0,
        };
        let gain = Gain::of(&[one(0, 1.0), one(0, 1.0)]).unwrap();
        assert_eq!((gain.before, gain.after, gain.part()), (2.0, 1.0, 0.5));
        assert_eq!(gain.part95, (f64::NEG_INFINITY, 1.0));
        assert_eq!(Gain::of(&[one(0, 1.0), one(1, 20.0), one(0, 1.0)]), Some(gain));
        assert_eq!(Gain::of(&[one(0, 1.0), one(1, 1.0)]), None);
        assert_eq!(Gain::of(&[]), None);
    }
}
