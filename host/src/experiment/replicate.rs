//! Which runs repeat each other.

use super::motion::Motion;
use super::{Experiment, Run, Test};

/// Rates that differ by less than this share are one rate.
const SAME_RATE: f64 = 0.05;

/// Two runs that repeat each other by declaration.
pub(super) fn declared(one: &Run, other: &Run) -> bool {
    one.repeats.is_some() && one.repeats == other.repeats
}

/// Two runs of one test on one specimen with one ball.
pub(super) fn comparable(one: &Run, other: &Run) -> bool {
    (one.test, one.specimen, one.indenter) == (other.test, other.specimen, other.indenter)
}

/// Groups the runs that deform a specimen and agree in test, specimen, indenter, rate, motion (hold, unloading)
/// and cycle; each group holds indices into [`Experiment::runs`]. Runs that repeat nothing form
/// groups of one. `motions` has one entry a run. Runs that declare what they repeat ([`Run::repeats`]) form
/// the group of their label, whatever their motion, and no other.
pub fn groups(experiment: &Experiment, motions: &[Option<Motion>]) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for (at, run) in experiment.runs.iter().enumerate() {
        let Some(Some(motion)) = motions.get(at) else {
            continue;
        };
        if !matches!(run.test, Test::Indentation | Test::Uniaxial | Test::Confined | Test::Tension) {
            continue;
        }
        let same = groups.iter_mut().find(|group| {
            let other = &experiment.runs[group[0]];
            let Some(Some(its)) = motions.get(group[0]) else {
                return false;
            };
            if !comparable(run, other) || run.repeats != other.repeats {
                return false;
            }
            let rates = (motion.rate_mm_per_s / its.rate_mm_per_s - 1.0).abs();
            run.repeats.is_some()
                || (run.cycle == other.cycle
                    && rates < SAME_RATE
                    && motion.hold.is_some() == its.hold.is_some()
                    && motion.unloading.is_some() == its.unloading.is_some())
        });
        match same {
            Some(group) => group.push(at),
            None => groups.push(vec![at]),
        }
    }
    groups
}
