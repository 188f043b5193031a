//! Placebo effects: smooth functions that mean nothing.

use std::f64::consts::TAU;

use rand::Rng;
use rand_distr::StandardNormal;

use super::{Effect, Variable};
use crate::simulate::chance::{Purpose, stream};

/// Cosines of a smooth random function.
const WAVES: usize = 3;
/// Periods across the range of the variable of the shortest wave.
const SHORTEST: f64 = 1.5;

/// A smooth random function of `u`, the variable as a part of its range; its mean square over many seeds is 1.
fn smooth(seed: u64, number: usize, u: f64) -> f64 {
    let mut chance = stream(seed, Purpose::Placebo, number as u64);
    let mut sum = 0.0;
    for wave in 1..=WAVES {
        let weight: f64 = chance.sample(StandardNormal);
        let phase: f64 = chance.random();
        let periods = SHORTEST * wave as f64 / WAVES as f64;
        sum += weight * (TAU * (periods * u + phase)).cos();
    }
    sum * (2.0 / WAVES as f64).sqrt()
}

/// Where a sample lies: the variables as parts of their ranges within the experiment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Place {
    pub depth: f64,
    pub time: f64,
    pub clock: f64,
    pub rate: f64,
    pub radius: f64,
    pub cycle: f64,
    /// Force (N) and the run's largest.
    pub force_n: f64,
    pub peak_n: f64,
}

/// What the placebos add to a reading, N. Those of depth and time grow in over the first tenth of the depth, the others are
/// gains: without contact none shows.
pub(crate) fn added_n(effects: &[Effect], seed: u64, at: &Place) -> f64 {
    let mut sum = 0.0;
    for (number, effect) in effects.iter().enumerate() {
        let Effect::Placebo { variable, amplitude } = effect else { continue };
        let of = |u: f64| smooth(seed, number, u);
        let grown = at.peak_n * (10.0 * at.depth).clamp(0.0, 1.0);
        sum += amplitude
            * match variable {
                Variable::Depth => grown * of(at.depth),
                Variable::Time => grown * of(at.time),
                Variable::Clock => at.force_n * of(at.clock),
                Variable::Rate => at.force_n * of(at.rate),
                Variable::Radius => at.force_n * of(at.radius),
                Variable::Cycle => at.force_n * of(at.cycle),
            };
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sum of cosines with normal weights has mean square 1; of 400 seeds it scatters by about 0.08.
    #[test]
    fn its_mean_square_is_one_and_it_is_smooth() {
        let mut square = 0.0;
        for seed in 0..400 {
            square += smooth(seed, 0, 0.3).powi(2) / 400.0;
            assert!((smooth(seed, 0, 0.3) - smooth(seed, 0, 0.301)).abs() < 0.2);
        }
        assert!((square - 1.0).abs() < 0.35, "{square}");
    }

    #[test]
    fn a_placebo_of_rate_is_a_gain_of_the_force() {
        let effects = [Effect::Placebo { variable: Variable::Rate, amplitude: 0.05 }];
        let place =
            Place { depth: 0.5, time: 0.5, clock: 0.1, rate: 0.4, radius: 0.0, cycle: 0.0, force_n: 2.0, peak_n: 4.0 };
        let twice = Place { force_n: 4.0, ..place };
        assert_eq!(2.0 * added_n(&effects, 1, &place), added_n(&effects, 1, &twice));
        assert_ne!(added_n(&effects, 1, &place), added_n(&effects, 1, &Place { rate: 0.6, ..place }));
    }
}
