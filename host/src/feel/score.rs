//! How near what is felt is to the material.

use super::{Felt, Pressed, Sample};
use crate::experiment::signal::mean;

/// Force below which the FSR of the thesis reads nothing, N (Eq. 45): scores are of more, the part below is told.
pub const LEAST_N: f64 = 0.2;

/// The loading of a press: from the first force to the largest.
#[derive(Debug, Clone, Copy)]
pub struct Loading<'a> {
    /// Its samples.
    pub samples: &'a [Sample],
}

/// The actuator's display of a material in loading, as the thesis judges it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ActuatorScore {
    /// Mean distance of the shaft from where the material wants it at the true force, over the largest such place.
    pub position: f64,
    /// Mean distance of the force from what the material wants at the true shaft, over the largest force.
    pub force: f64,
    /// Largest distance between the wanted and the read shaft, over the largest wanted place.
    pub tracking: f64,
    /// Mean distance of the bone from the finger's travel on the material, over the largest.
    pub travel: f64,
    /// The same as `position` where the force is below [`LEAST_N`].
    pub position_below: Option<f64>,
    /// Samples that are scored.
    pub scored: usize,
}

/// The fluid's display of a material in loading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FluidScore {
    /// Mean of the smaller over the larger of both forces, display's and material's, at the same travel.
    pub agreement: f64,
    /// Part of the material's curve, in force, that the table marks reachable.
    pub reachable: f64,
    /// Samples that are scored: reachable, and of more than [`LEAST_N`] on the material.
    pub scored: usize,
}

impl Pressed {
    /// Down to the largest force.
    #[must_use]
    pub fn loading(&self) -> Loading<'_> {
        let most = self.samples.iter().enumerate().max_by(|a, b| a.1.force_n.total_cmp(&b.1.force_n));
        let first = self.samples.iter().position(|s| s.force_n > 0.0).unwrap_or(0);
        let last = most.map_or(0, |(at, _)| at + 1).max(first);
        Loading { samples: self.samples.get(first..last).unwrap_or_default() }
    }
}

impl Felt {
    /// How near the actuator comes in one of the presses; `None` where nothing is scored.
    #[must_use]
    pub fn actuator(&self, press: &Pressed) -> Option<ActuatorScore> {
        let (curve, loading) = (&self.curve, press.loading().samples);
        let above = || loading.iter().filter(|s| s.force_n >= LEAST_N);
        let most = |of: &dyn Fn(&Sample) -> f64| above().map(of).fold(0.0, f64::max).max(f64::MIN_POSITIVE);
        let away = |s: &Sample| (s.shaft_mm - curve.shaft_at(s.force_n)).abs();
        let shaft_most = most(&|s| curve.shaft_at(s.force_n));
        let below = loading.iter().filter(|s| s.force_n < LEAST_N).map(away);
        Some(ActuatorScore {
            position: mean(above().map(away))? / shaft_most,
            force: mean(above().filter_map(|s| Some((s.force_n - curve.force_at_shaft(s.shaft_mm)?).abs())))?
                / most(&|s| s.force_n),
            tracking: above().map(|s| (s.target_mm - s.read_mm).abs()).fold(0.0, f64::max) / most(&|s| s.target_mm),
            travel: mean(above().map(|s| (s.bone_mm - curve.travel_at(s.force_n)).abs()))?
                / most(&|s| curve.travel_at(s.force_n)),
            position_below: mean(below).map(|mm| mm / shaft_most),
            scored: above().count(),
        })
    }

    /// How near the fluid comes in one of the presses; `None` where nothing is scored.
    #[must_use]
    pub fn fluid(&self, press: &Pressed) -> Option<FluidScore> {
        let curve = &self.curve;
        let (from, to) = curve.reachable_n;
        let scored = || {
            let both = press.loading().samples.iter().map(|s| (s, curve.force_at_travel(s.bone_mm)));
            both.filter_map(|(s, wanted)| Some((s.force_n, wanted?)))
                .filter(|(_, wanted)| *wanted >= LEAST_N && *wanted >= from && *wanted <= to)
        };
        Some(FluidScore {
            agreement: mean(scored().map(|(own, wanted)| own.min(wanted) / own.max(wanted)))?,
            reachable: (to - from) / curve.most_n(),
            scored: scored().count(),
        })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::control::ControlCurve;
    use crate::feel::{Display, Pace};

    fn sample(curve: &ControlCurve, time_s: f64, force_n: f64) -> Sample {
        Sample {
            time_s,
            force_n,
            bone_mm: curve.travel_at(force_n),
            shaft_mm: curve.shaft_at(force_n),
            yield_kpa: 0.0,
            flux_t: 0.0,
            read_n: force_n,
            read_mm: curve.shaft_at(force_n),
            target_mm: curve.shaft_at(force_n),
            wanted_a: 0.0,
            unreachable: false,
        }
    }

    /// A press to and fro whose samples are changed.
    fn felt(change: fn(&mut Sample)) -> Felt {
        let curve = ControlCurve::built_in("EVA").unwrap();
        let force = |i: i32| 4.0 * (1.0 - f64::from((i - 100).abs()) / 100.0);
        let mut samples: Vec<Sample> = (0..=200).map(|i| sample(&curve, 0.02 * f64::from(i), force(i))).collect();
        samples.iter_mut().for_each(change);
        Felt { curve, display: Display::Actuator, presses: vec![Pressed { pace: Pace::Slow, samples }], is_read: false }
    }

    #[test]
    fn a_display_that_is_the_material_has_no_error_and_one_that_is_off_has_its_own() {
        let score = |felt: &Felt| felt.actuator(&felt.presses[0]).unwrap();
        let exact = score(&felt(|_| {}));
        assert!(exact.position < 1e-12 && exact.force < 1e-12 && exact.tracking == 0.0 && exact.travel < 1e-12);
        // 0.2 to 4 N in steps of 0.04 N
        assert_eq!(exact.scored, 96);
        let off = felt(|s| s.shaft_mm += 0.1);
        let most_mm = off.curve.shaft_at(4.0);
        assert!((score(&off).position - 0.1 / most_mm).abs() < 1e-12);
        assert!(score(&off).force > 0.0 && score(&off).travel < 1e-12);
        // what happens on the way up does not count
        assert_eq!(
            score(&felt(|s| if s.time_s > 2.0 {
                s.shaft_mm = 0.0
            }))
            .position,
            exact.position
        );
    }

    #[test]
    fn a_fluid_that_is_as_stiff_agrees_and_half_the_force_agrees_by_half() {
        let of = |felt: &Felt| felt.fluid(&felt.presses[0]).unwrap();
        assert!((of(&felt(|_| {})).agreement - 1.0).abs() < 1e-9);
        assert!((of(&felt(|s| s.force_n *= 0.5)).agreement - 0.5).abs() < 1e-9);
        assert_eq!(of(&felt(|_| {})).reachable, 1.0);
    }
}
