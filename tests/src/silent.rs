//! Causes that stay silent: one effect of the catalogue in an experiment, of an amount that laboratories meet and nobody sees.
//!
//! The ranges below are those of instruments and foams as their standards and data sheets state them, and as wide as, or wider than, what the
//! diagnosis takes them to be; nothing here is read from its catalogue. Amounts are even over their range.

use lut_gen::solid::law::PronyTerm;
use palpate::simulate::{Effect, Spec};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;

use crate::hidden::{Case, Design, NoiseKind, What};

/// Codes of the causes that are hidden, one an experiment.
pub const CAUSES: [&str; 18] = [
    "sensor-gain",
    "depth-gain",
    "contact-offset",
    "compliance",
    "radius",
    "thickness",
    "friction",
    "adhesion",
    "poisson",
    "second-term",
    "relaxation",
    "sensor-nonlinearity",
    "lag",
    "sensor-creep",
    "drift",
    "time-gain",
    "numerics",
    "hysteresis",
];

/// A cause with an amount.
fn cause(code: &str, peak_n: f64, chance: &mut Pcg64) -> Option<Effect> {
    let mut even = |low: f64, high: f64| low + (high - low) * chance.random::<f64>();
    Some(match code {
        // force-measuring systems of class 1 (ISO 7500-1), small cells used at a part of their scale twice that
        "sensor-gain" => Effect::SensorGain { gain: even(0.98, 1.02) },
        // extensometers of class 1 (ISO 9513)
        "depth-gain" => Effect::DepthGain { gain: even(0.989, 1.011) },
        // sampling timed in software
        "time-gain" => Effect::TimeGain { gain: even(0.99, 1.01) },
        // triggers of 5 to 15 mN on soft foam
        "contact-offset" => Effect::ContactOffset { offset_mm: even(-0.06, 0.06) },
        // load cells give way by 0.1 to 0.4 mm at full scale, used at a tenth of it
        "compliance" => Effect::Compliance { mm_per_n: even(0.0, 0.04) / peak_n },
        // turned or printed balls
        "radius" => Effect::Radius {
            indenter: if even(0.0, 1.0) < 0.5 { "r4" } else { "r6" }.to_owned(),
            error_mm: 5.0 * even(-0.02, 0.02),
        },
        // a calliper on a soft slab of 12.7 mm
        "thickness" => Effect::Thickness { height_error_mm: 12.7 * even(-0.04, 0.04) },
        // lubricated or powdered
        "friction" => Effect::Friction { coefficient: even(0.0, 0.4) },
        "adhesion" => Effect::Adhesion { work_n_per_mm: even(1e-6, 4e-4) * peak_n, range_mm: 0.05 },
        // open-cell foams in compression
        "poisson" => Effect::Poisson { nu: even(0.0, 0.1) },
        "second-term" => Effect::SecondTerm { mu2_ratio: even(0.002, 0.1), alpha2: even(2.0, 25.0) },
        "relaxation" => {
            let g = even(0.0, 0.1);
            Effect::Relaxation(vec![PronyTerm::alike(g, 0.05 * 800.0_f64.powf(even(0.0, 1.0)))])
        }
        "sensor-nonlinearity" => Effect::SensorNonlinearity { quadratic_per_n: even(-0.01, 0.01) / peak_n },
        // channels that are read one after the other
        "lag" => Effect::Lag { lag_s: even(0.0, 0.02) },
        "sensor-creep" => {
            Effect::SensorCreep { amplitude: even(0.0, 0.02), tau_s: 0.3 * 130.0_f64.powf(even(0.0, 1.0)) }
        }
        "hysteresis" => Effect::SensorHysteresis { width: even(0.0, 0.02) },
        "drift" => Effect::Drift {
            // a few hundredths of a percent of full scale an hour, a tenth of it in use
            n_per_h: even(-0.02, 0.02) * peak_n,
            thermal_n: 0.0,
            thermal_s: 600.0,
        },
        "numerics" => Effect::Numerics { mesh: Some(even(0.7, 1.0)), alpha_step: None },
        _ => return None,
    })
}

/// An experiment with one cause in it, or none.
#[derive(Debug, Clone)]
pub struct Silent {
    /// Its cause; none is clean.
    pub code: Option<&'static str>,
    /// What is simulated.
    pub spec: Spec,
    /// The true modulus, MPa, and exponent.
    pub truth: [f64; 2],
}

impl Silent {
    /// A case of a design, all but the cause drawn by its seed: foam, noise and session are those of [`crate::hidden`].
    #[must_use]
    pub fn new(design: Design, seed: u64, code: Option<&'static str>) -> Self {
        let case = Case::new(design, seed).hiding(What::Clean).in_noise(NoiseKind::Matched);
        let mut spec = case.spec();
        let foam = case.truth().foam;
        let mut chance = Pcg64::seed_from_u64(seed ^ 0x5119_7000);
        // Hertz's force of the larger ball at the deepest, a quarter off for what foams soften
        let peak_n = 0.75 * 8.0 / 3.0 * foam.mu_mpa * 6.0_f64.sqrt() * 3.0_f64.powf(1.5);
        spec.effects = code.and_then(|code| cause(code, peak_n, &mut chance)).into_iter().collect();
        Self { code, spec, truth: [foam.mu_mpa, foam.alpha] }
    }

    /// The same with every error of the instruments in it besides, each even over half its range, as a real rig has them.
    #[must_use]
    pub fn on_a_rig(mut self) -> Self {
        let mut chance = Pcg64::seed_from_u64(self.spec.seed ^ 0x0a11);
        let mut even = |half: f64| half * (2.0 * chance.random::<f64>() - 1.0);
        let peak_n = 0.75 * 8.0 / 3.0 * self.truth[0] * 6.0_f64.sqrt() * 3.0_f64.powf(1.5);
        let rig = [
            Effect::SensorGain { gain: 1.0 + even(0.01) },
            Effect::DepthGain { gain: 1.0 + even(0.0055) },
            Effect::ContactOffset { offset_mm: even(0.03) },
            Effect::Compliance { mm_per_n: even(0.02).abs() / peak_n },
            Effect::SensorNonlinearity { quadratic_per_n: even(0.005) / peak_n },
            Effect::Lag { lag_s: even(0.01).abs() },
        ];
        let other = rig.into_iter().filter(|effect| Some(effect.code()) != self.code);
        self.spec.effects.extend(other.collect::<Vec<_>>());
        self
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// Every cause is drawn, accepted as a specification, and another one with another seed.
    #[test]
    fn every_cause_is_a_specification() {
        for code in CAUSES {
            let [one, other] = [1, 2].map(|seed| Silent::new(Design::D6, seed, Some(code)).spec.effects);
            assert!(one.len() == 1 && one != other, "{code}: {one:?}");
            assert!(one[0].code() == code || code == "hysteresis");
            let text = format!(
                "[indenter.r4]\nradius_mm = 4\n[indenter.r6]\nradius_mm = 6\n[[run]]\ntest = \"air\"\nhold_s = 1\n{}",
                one[0].to_toml()
            );
            let read = palpate::simulate::parse(std::path::Path::new("x.toml"), &text).unwrap();
            assert_eq!(read.effects, one);
        }
        assert!(Silent::new(Design::D6, 1, None).spec.effects.is_empty());
        assert_eq!(Silent::new(Design::D6, 1, Some("lag")).on_a_rig().spec.effects.len(), 6);
    }
}
