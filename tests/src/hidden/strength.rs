//! How strong effects are: five levels each, from below what any design sees to well above.

use lut_gen::solid::law::PronyTerm;
use palpate::simulate::Effect;
use rand::Rng;
use rand_pcg::Pcg64;

use super::Design;
use super::draw::{Foam, even};
use super::layout::{Layout, ball};

/// Levels of strength.
pub const LEVELS: usize = 5;

/// Codes of the catalogue that are hidden.
pub const CATALOGUE: [&str; 16] = [
    "relaxation",
    "poisson",
    "second-term",
    "softening",
    "thickness",
    "friction",
    "adhesion",
    "contact-offset",
    "compliance",
    "radius",
    "lag",
    "sensor-gain",
    "sensor-nonlinearity",
    "sensor-creep",
    "drift",
    "numerics",
];

/// Codes outside the catalogue.
pub const OUTSIDE: [&str; 7] = [
    "outside-power-law",
    "outside-plastic-set",
    "outside-stiff-skin",
    "outside-anisotropic",
    "outside-tilt",
    "outside-hum",
    "outside-stick-slip",
];

/// Ten pairs of different stages; relaxation with sensor creep, which cancel, is not among them.
pub const PAIRS: [[&str; 2]; 10] = [
    ["relaxation", "compliance"],
    ["relaxation", "sensor-nonlinearity"],
    ["relaxation", "radius"],
    ["relaxation", "drift"],
    ["softening", "contact-offset"],
    ["softening", "sensor-nonlinearity"],
    ["second-term", "drift"],
    ["thickness", "lag"],
    ["compliance", "sensor-creep"],
    ["friction", "drift"],
];

/// What strengths are measured by; amounts in mm are stated for slabs of 12.7 mm and depths of 3 mm.
pub(super) struct Scales {
    pub peak_n: f64,
    pub foam: Foam,
    pub design: Design,
    pub layout: Layout,
}

/// Hours from the first run of a design to its last, about.
fn session_h(scales: &Scales) -> f64 {
    match scales.design {
        Design::D6 => 0.04,
        Design::D18 => 0.12,
        Design::D36 => 0.35,
        Design::D60 => 0.6,
        Design::Own => scales.layout.session_h(),
    }
}

/// An effect of a code at a level (0 to 4); `None` for a code that is not known.
pub(super) fn effect(code: &str, level: usize, scales: &Scales, chance: &mut Pcg64) -> Option<Effect> {
    let at = |levels: [f64; LEVELS]| levels[level.min(LEVELS - 1)];
    let peak_n = scales.peak_n;
    let sign = if chance.random::<bool>() { 1.0 } else { -1.0 };
    Some(match code {
        "relaxation" => {
            Effect::Relaxation(vec![PronyTerm::alike(at([0.01, 0.03, 0.08, 0.2, 0.4]), even(chance, 0.2, 3.0))])
        }
        "poisson" => Effect::Poisson { nu: at([0.02, 0.05, 0.1, 0.2, 0.35]) },
        "second-term" => Effect::SecondTerm {
            mu2_ratio: at([0.02, 0.05, 0.12, 0.3, 0.6]),
            alpha2: if sign > 0.0 { 25.0 } else { 2.0 },
        },
        "softening" => Effect::Softening {
            r: 1.0 / at([0.02, 0.05, 0.12, 0.25, 0.45]),
            m_mpa: scales.foam.mu_mpa * even(chance, 0.005, 0.05),
            beta: 0.1,
        },
        "thickness" if level + 1 >= LEVELS && chance.random::<f64>() < 0.3 => Effect::SlidingBase,
        "thickness" => Effect::Thickness {
            height_error_mm: sign * at([0.1, 0.3, 0.8, 1.8, 3.5]) * (scales.layout.thinnest_mm() / 12.7),
        },
        "friction" => Effect::Friction { coefficient: at([0.03, 0.08, 0.2, 0.4, 0.8]) },
        // the pull of a ball of 5 mm is 3/2 pi w R (Johnson, Kendall and Roberts 1971)
        "adhesion" => Effect::Adhesion {
            work_n_per_mm: at([0.001, 0.003, 0.008, 0.02, 0.05]) * peak_n / (1.5 * std::f64::consts::PI * 5.0),
            range_mm: 0.1,
        },
        "contact-offset" => Effect::ContactOffset {
            offset_mm: sign * at([0.005, 0.02, 0.05, 0.12, 0.25]) * (scales.layout.peak_mm / 3.0),
        },
        "compliance" => Effect::Compliance { mm_per_n: at([0.01, 0.03, 0.1, 0.25, 0.6]) / peak_n },
        "radius" => {
            let radii = scales.layout.radii_mm();
            let radius = radii[chance.random_range(0..radii.len())];
            Effect::Radius { indenter: ball(radius), error_mm: sign * radius * at([0.004, 0.012, 0.03, 0.07, 0.15]) }
        }
        // a design of one rate meets no limit that one would set
        "lag" if level >= 2 && scales.layout.rates_mm_s().len() > 1 && chance.random::<f64>() < 0.3 => {
            let fastest = scales.layout.rates_mm_s().iter().copied().fold(0.0, f64::max);
            Effect::RateLimit { rate_mm_s: fastest / 8.0 * at([7.9, 7.8, 7.3, 6.0, 4.0]) }
        }
        "lag" => Effect::Lag { lag_s: at([0.001, 0.004, 0.012, 0.03, 0.08]) },
        "sensor-gain" => Effect::SensorGain { gain: 1.0 + sign * at([0.005, 0.015, 0.04, 0.1, 0.25]) },
        "sensor-nonlinearity" => {
            Effect::SensorNonlinearity { quadratic_per_n: sign * at([0.003, 0.01, 0.03, 0.08, 0.2]) / peak_n }
        }
        "sensor-creep" => {
            Effect::SensorCreep { amplitude: at([0.003, 0.01, 0.03, 0.08, 0.2]), tau_s: even(chance, 0.5, 10.0) }
        }
        "drift" => Effect::Drift {
            n_per_h: sign * at([0.002, 0.006, 0.02, 0.06, 0.2]) * peak_n / session_h(scales),
            thermal_n: 0.0,
            thermal_s: 600.0,
        },
        "numerics" if sign > 0.0 => Effect::Numerics { mesh: Some(at([0.9, 0.75, 0.6, 0.5, 0.4])), alpha_step: None },
        "numerics" => Effect::Numerics { mesh: None, alpha_step: Some(at([1.0, 2.0, 4.0, 7.0, 12.0])) },
        _ => return outside(code, at, scales, sign, chance),
    })
}

fn outside(
    code: &str,
    at: impl Fn([f64; LEVELS]) -> f64,
    scales: &Scales,
    sign: f64,
    chance: &mut Pcg64,
) -> Option<Effect> {
    let part_of_peak = at([0.003, 0.01, 0.03, 0.08, 0.2]) * scales.peak_n;
    Some(match code {
        "outside-power-law" => Effect::PowerLaw {
            amplitude: at([0.02, 0.06, 0.15, 0.35, 0.7]),
            t0_s: even(chance, 0.03, 0.5),
            beta: chance.random_range(0.2..0.5),
        },
        "outside-plastic-set" => Effect::PlasticSet { share: at([0.002, 0.006, 0.02, 0.05, 0.12]) },
        // k d^3 / R at 3 mm under a ball of 5 mm
        "outside-stiff-skin" => {
            Effect::StiffSkin { stiffness_n_per_mm2: at([0.005, 0.02, 0.06, 0.2, 0.5]) * scales.peak_n * 5.0 / 27.0 }
        }
        "outside-anisotropic" => {
            let power = sign * at([0.01, 0.03, 0.08, 0.15, 0.3]);
            Effect::Anisotropic { depth_power: power, radius_power: -1.5 * power }
        }
        "outside-tilt" => Effect::Tilt { angle_deg: at([0.5, 1.5, 4.0, 8.0, 14.0]), distance_mm: 8.0 },
        "outside-hum" => Effect::Hum {
            amplitude_n: part_of_peak,
            // sampled at 50 Hz it beats with 0.1 to 2 Hz
            frequency_hz: 50.0 + sign * even(chance, 0.1, 2.0),
        },
        "outside-stick-slip" => Effect::StickSlip { amplitude_n: part_of_peak, period_mm: even(chance, 0.15, 0.6) },
        _ => return None,
    })
}
