//! Effects with amounts and knobs from wide ranges, and the same effects larger or smaller.

use lut_gen::solid::law::PronyTerm;
use palpate::simulate::{Effect, Rest, SimulatedExperiment, Spec};
use rand::Rng;
use rand_pcg::Pcg64;

use super::rig::sign;
use crate::hidden::even;

/// What amounts are measured by.
#[derive(Debug, Clone)]
pub(super) struct Scales {
    pub peak_n: f64,
    pub mu_mpa: f64,
    pub peak_mm: f64,
    pub thinnest_mm: f64,
    pub session_h: f64,
    pub sample_hz: f64,
    /// Names and radii (mm) of the balls.
    pub balls: Vec<(String, f64)>,
    /// Rates, mm/s, from slow to fast.
    pub rates_mm_s: Vec<f64>,
    pub cycles: usize,
    pub unload: bool,
}

impl Scales {
    pub fn of(spec: &Spec, bare: &SimulatedExperiment) -> Self {
        let most = |values: &mut dyn Iterator<Item = f64>| values.fold(f64::MIN_POSITIVE, f64::max);
        let mut rates: Vec<f64> = spec.runs.iter().map(|run| run.rate_mm_s).collect();
        rates.sort_by(f64::total_cmp);
        rates.dedup();
        Self {
            peak_n: most(&mut bare.runs.iter().flat_map(|run| &run.exact_n).copied()),
            mu_mpa: spec.specimens.first().map_or(0.1, |one| one.mu_mpa),
            peak_mm: most(&mut spec.runs.iter().map(|run| run.depth_mm)),
            thinnest_mm: spec.specimens.iter().map(|one| one.height_mm).fold(f64::INFINITY, f64::min),
            session_h: most(&mut bare.runs.iter().map(|run| run.start_s / 3600.0)),
            sample_hz: spec.sample_hz,
            balls: spec.indenters.iter().map(|one| (one.name.clone(), one.radius_mm)).collect(),
            rates_mm_s: rates,
            cycles: spec.runs.iter().map(|run| run.cycles).max().unwrap_or(1),
            unload: spec.runs.iter().any(|run| run.unload),
        }
    }

    fn fastest_mm_s(&self) -> f64 {
        self.rates_mm_s.last().copied().unwrap_or(1.0)
    }
}

/// An effect of a code, smaller where it is a minor one; `None` where the design has nothing that
/// it acts on.
pub(super) fn drawn(code: &str, minor: bool, scales: &Scales, chance: &mut Pcg64) -> Option<Effect> {
    let (peak_n, sign) = (scales.peak_n, sign(chance));
    let amount = |low: f64, high: f64, chance: &mut Pcg64| amount(minor, low, high, chance);
    Some(match code {
        "relaxation" => {
            let whole = amount(0.02, 0.6, chance);
            let two = chance.random_range(0..10) < 3;
            let part = if two { chance.random_range(0.3..0.7) } else { 1.0 };
            let bulk = if chance.random::<bool>() { 1.0 } else { chance.random::<f64>() };
            let mut term = |g: f64| PronyTerm { g, k: bulk * g, tau_s: even(chance, 0.05, 30.0) };
            let first = term(whole * part);
            Effect::Relaxation(if two { vec![first, term(whole * (1.0 - part))] } else { vec![first] })
        }
        "poisson" => Effect::Poisson { nu: amount(0.03, 0.42, chance) },
        "second-term" => Effect::SecondTerm { mu2_ratio: amount(0.02, 1.0, chance), alpha2: even(chance, 1.5, 30.0) },
        "softening" if scales.cycles > 1 || scales.unload => Effect::Softening {
            r: 1.0 / amount(0.03, 0.6, chance),
            m_mpa: scales.mu_mpa * even(chance, 0.002, 0.2),
            beta: even(chance, 0.01, 0.5),
        },
        "thickness" if !minor && chance.random_range(0..5) == 0 => Effect::SlidingBase,
        "thickness" => Effect::Thickness { height_error_mm: sign * amount(0.01, 0.3, chance) * scales.thinnest_mm },
        "friction" => Effect::Friction { coefficient: amount(0.05, 1.0, chance) },
        "adhesion" => Effect::Adhesion {
            work_n_per_mm: amount(0.001, 0.08, chance) * pull_n_mm(scales),
            range_mm: even(chance, 0.02, 0.4),
        },
        "contact-offset" => Effect::ContactOffset { offset_mm: sign * amount(0.003, 0.1, chance) * scales.peak_mm },
        "compliance" => Effect::Compliance { mm_per_n: amount(0.005, 0.25, chance) * scales.peak_mm / peak_n },
        "radius" => {
            let (indenter, radius_mm) = scales.balls.get(chance.random_range(0..scales.balls.len()))?.clone();
            let share = amount(0.005, 0.2, chance);
            Effect::Radius { indenter, error_mm: sign * share * radius_mm }
        }
        "lag" if scales.rates_mm_s.len() > 1 && chance.random_range(0..10) < 3 => {
            Effect::RateLimit { rate_mm_s: scales.fastest_mm_s() / (1.0 + amount(0.01, 1.0, chance)) }
        }
        "lag" => Effect::Lag { lag_s: amount(0.001, 0.06, chance) * scales.peak_mm / scales.fastest_mm_s() },
        "sensor-nonlinearity" => {
            Effect::SensorNonlinearity { quadratic_per_n: sign * amount(0.005, 0.25, chance) / peak_n }
        }
        "sensor-creep" if scales.unload && chance.random_range(0..10) < 4 => {
            Effect::SensorHysteresis { width: amount(0.005, 0.12, chance) }
        }
        "sensor-creep" => Effect::SensorCreep { amplitude: amount(0.005, 0.3, chance), tau_s: even(chance, 0.1, 60.0) },
        "drift" => {
            let size = sign * amount(0.005, 0.3, chance) * peak_n;
            let thermal = if chance.random::<bool>() { 0.0 } else { chance.random_range(0.2..1.0) };
            Effect::Drift {
                n_per_h: size * (1.0 - thermal) / scales.session_h,
                thermal_n: size * thermal,
                thermal_s: even(chance, 30.0, 5000.0),
            }
        }
        _ => return outside(code, sign, scales, chance),
    })
}

/// Between a sixth of the range, in the logarithm, and its end for what is to dominate; in its
/// lower half for a minor effect.
fn amount(minor: bool, low: f64, high: f64, chance: &mut Pcg64) -> f64 {
    let (from, to) = if minor { (0.0, 0.5) } else { (0.16, 1.0) };
    low * (high / low).powf(chance.random_range(from..to))
}

/// Work of adhesion (N/mm) that pulls the middle ball with the largest force: 3/2 pi w R (Johnson,
/// Kendall and Roberts 1971).
fn pull_n_mm(scales: &Scales) -> f64 {
    scales.peak_n / (1.5 * std::f64::consts::PI * middle_mm(scales))
}

fn middle_mm(scales: &Scales) -> f64 {
    scales.balls.get(scales.balls.len() / 2).map_or(5.0, |ball| ball.1)
}

fn outside(code: &str, sign: f64, scales: &Scales, chance: &mut Pcg64) -> Option<Effect> {
    Some(match code {
        "outside-power-law" => Effect::PowerLaw {
            amplitude: even(chance, 0.06, 0.8),
            t0_s: even(chance, 0.01, 1.0),
            beta: chance.random_range(0.1..0.7),
        },
        "outside-plastic-set" if scales.cycles > 1 => Effect::PlasticSet { share: even(chance, 0.005, 0.15) },
        "outside-stiff-skin" => Effect::StiffSkin {
            stiffness_n_per_mm2: even(chance, 0.03, 0.6) * scales.peak_n * middle_mm(scales) / scales.peak_mm.powi(3),
        },
        "outside-anisotropic" => {
            let power = sign * even(chance, 0.03, 0.4);
            Effect::Anisotropic { depth_power: power, radius_power: -power * chance.random_range(0.3..2.0) }
        }
        "outside-tilt" => Effect::Tilt { angle_deg: even(chance, 1.5, 14.0), distance_mm: 8.0 },
        "outside-hum" => {
            let beat_hz = even(chance, 0.1, 5.0);
            let carrier_hz = if chance.random::<bool>() { scales.sample_hz } else { 0.0 };
            Effect::Hum { amplitude_n: even(chance, 0.01, 0.25) * scales.peak_n, frequency_hz: carrier_hz + beat_hz }
        }
        "outside-stick-slip" => Effect::StickSlip {
            amplitude_n: even(chance, 0.01, 0.25) * scales.peak_n,
            period_mm: even(chance, 0.03, 0.3) * scales.peak_mm,
        },
        _ => return None,
    })
}

/// The same effect by a factor larger, in the amount that makes it large; `None` beyond what is
/// still one, and for what has no amount.
pub(super) fn scaled(effect: &Effect, by: f64, scales: &Scales) -> Option<Effect> {
    let within = |value: f64, most: f64| (value.abs() <= most).then_some(value);
    let peak_n = scales.peak_n;
    Some(match effect {
        Effect::Relaxation(terms) => {
            within(by * terms.iter().map(|term| term.g).sum::<f64>(), 0.9)?;
            Effect::Relaxation(terms.iter().map(|t| PronyTerm { g: by * t.g, k: by * t.k, ..*t }).collect())
        }
        Effect::Poisson { nu } => Effect::Poisson { nu: within(by * nu, 0.45)? },
        Effect::SecondTerm { mu2_ratio, alpha2 } => {
            Effect::SecondTerm { mu2_ratio: within(by * mu2_ratio, 5.0)?, alpha2: *alpha2 }
        }
        Effect::Softening { r, m_mpa, beta } => {
            Effect::Softening { r: 1.0 / within(by / r, 0.85)?, m_mpa: *m_mpa, beta: *beta }
        }
        Effect::Thickness { height_error_mm } => {
            Effect::Thickness { height_error_mm: within(by * height_error_mm, 0.4 * scales.thinnest_mm)? }
        }
        Effect::Friction { coefficient } => Effect::Friction { coefficient: within(by * coefficient, 1.5)? },
        Effect::Adhesion { work_n_per_mm, range_mm } => Effect::Adhesion {
            work_n_per_mm: within(by * work_n_per_mm, 0.2 * pull_n_mm(scales))?,
            range_mm: *range_mm,
        },
        Effect::ContactOffset { offset_mm } => {
            Effect::ContactOffset { offset_mm: within(by * offset_mm, 0.15 * scales.peak_mm)? }
        }
        Effect::Compliance { mm_per_n } => {
            Effect::Compliance { mm_per_n: within(by * mm_per_n, 0.5 * scales.peak_mm / peak_n)? }
        }
        Effect::Radius { indenter, error_mm } => {
            let radius_mm = scales.balls.iter().find(|ball| ball.0 == *indenter)?.1;
            Effect::Radius { indenter: indenter.clone(), error_mm: within(by * error_mm, 0.35 * radius_mm)? }
        }
        Effect::Lag { lag_s } => {
            Effect::Lag { lag_s: within(by * lag_s, 0.3 * scales.peak_mm / scales.fastest_mm_s())? }
        }
        Effect::RateLimit { rate_mm_s } => {
            let fastest = scales.fastest_mm_s();
            Effect::RateLimit { rate_mm_s: fastest / (1.0 + within(by * (fastest / rate_mm_s - 1.0), 3.0)?) }
        }
        Effect::SensorNonlinearity { quadratic_per_n } => {
            Effect::SensorNonlinearity { quadratic_per_n: within(by * quadratic_per_n, 0.35 / peak_n)? }
        }
        Effect::SensorCreep { amplitude, tau_s } => {
            Effect::SensorCreep { amplitude: within(by * amplitude, 0.6)?, tau_s: *tau_s }
        }
        Effect::SensorHysteresis { width } => Effect::SensorHysteresis { width: within(by * width, 0.25)? },
        Effect::Drift { n_per_h, thermal_n, thermal_s } => {
            within(by * (n_per_h * scales.session_h + thermal_n), peak_n)?;
            Effect::Drift { n_per_h: by * n_per_h, thermal_n: by * thermal_n, thermal_s: *thermal_s }
        }
        Effect::PowerLaw { amplitude, t0_s, beta } => {
            Effect::PowerLaw { amplitude: within(by * amplitude, 0.95)?, t0_s: *t0_s, beta: *beta }
        }
        Effect::PlasticSet { share } => Effect::PlasticSet { share: within(by * share, 0.3)? },
        Effect::StiffSkin { stiffness_n_per_mm2 } => {
            Effect::StiffSkin { stiffness_n_per_mm2: by * stiffness_n_per_mm2 }
        }
        Effect::Anisotropic { depth_power, radius_power } => Effect::Anisotropic {
            depth_power: within(by * depth_power, 0.8)?,
            radius_power: within(by * radius_power, 1.6)?,
        },
        Effect::Tilt { angle_deg, distance_mm } => {
            Effect::Tilt { angle_deg: within(by * angle_deg, 18.0)?, distance_mm: *distance_mm }
        }
        Effect::Hum { amplitude_n, frequency_hz } => {
            Effect::Hum { amplitude_n: within(by * amplitude_n, 0.5 * peak_n)?, frequency_hz: *frequency_hz }
        }
        Effect::StickSlip { amplitude_n, period_mm } => {
            Effect::StickSlip { amplitude_n: within(by * amplitude_n, 0.5 * peak_n)?, period_mm: *period_mm }
        }
        Effect::Rest(rest) => Effect::Rest(Rest { amplitude: within(by * rest.amplitude, 0.3)?, ..*rest }),
        _ => return None,
    })
}
