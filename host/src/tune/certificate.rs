//! The worst plant of the box: certified, and of random plants.

use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use rayon::prelude::*;
use serde::Serialize;

use super::gains::Gains;
use super::sampled::Exact;
use super::step::Step;
use super::worst::{self, Worst};
use super::{Asked, MOST_VARIED, Way, bound, bound_sampled, continuous};

/// Why there is no certificate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum NoCertificate {
    /// A continuous loop with dead time has infinitely many poles.
    DeadTime,
    /// Speed, friction, backlash or a cut command: the loop is not linear.
    NotLinear,
    /// Too many coefficients vary.
    TooMany,
    /// Nothing varies.
    NoBox,
}

/// The worst plant of the box for these gains: what is certain, and what was found.
///
/// # Errors
/// The reason why nothing is certain.
pub fn certify(asked: &Asked, gains: &Gains) -> Result<Worst, NoCertificate> {
    let uncertain = &asked.uncertain;
    let size = asked.limits.step_mm;
    if uncertain.bounds.is_empty() {
        return Err(NoCertificate::NoBox);
    }
    if uncertain.bounds.len() > MOST_VARIED {
        return Err(NoCertificate::TooMany);
    }
    if asked.flaws.any() || asked.limits.cut {
        return Err(NoCertificate::NotLinear);
    }
    let evaluate = |values: &[f64]| linear(asked, values, gains);
    let mut worst = match asked.way {
        Way::Continuous if uncertain.plant.delay_s > 0.0 => return Err(NoCertificate::DeadTime),
        Way::Continuous => {
            worst::worst(uncertain, &evaluate, &|middle, halves| bound::bound(uncertain, gains, middle, halves))
        }
        Way::Sampled(sampling) => worst::worst(uncertain, &evaluate, &|middle, halves| {
            bound_sampled::bound(uncertain, sampling, gains, middle, halves)
        }),
    };
    worst.most.command *= size;
    worst.found.command *= size;
    Ok(worst)
}

/// A step of 1 mm of a linear loop with a plant of the box; of a sampled loop at its ticks.
fn linear(asked: &Asked, values: &[f64], gains: &Gains) -> Step {
    let plant = asked.uncertain.at(values);
    match asked.way {
        Way::Continuous => continuous::evaluate(&plant, gains),
        Way::Sampled(sampling) => Exact::of_ticks(&plant, sampling).read_at_ticks(gains),
    }
}

/// The worst of random plants of the box, to compare with [`certify`]: each number at its own plant; the command in V.
pub fn sample(asked: &Asked, gains: &Gains, samples: usize) -> Step {
    let worst = |a: Step, b: Step| Step {
        cost: a.cost.max(b.cost),
        overshoot: a.overshoot.max(b.overshoot),
        undershoot: a.undershoot.max(b.undershoot),
        command: a.command.max(b.command),
    };
    let none = || Step { cost: 0.0, overshoot: 0.0, undershoot: 0.0, command: 0.0 };
    let drawn = (0..samples).into_par_iter().map(|i| {
        let mut chance = Pcg64::seed_from_u64(i as u64);
        let values: Vec<f64> =
            asked.uncertain.bounds.iter().map(|(_, low, high)| chance.random_range(*low..=*high)).collect();
        linear(asked, &values, gains)
    });
    let step = drawn.reduce(none, worst);
    Step { command: asked.limits.step_mm * step.command, ..step }
}
