//! An identified actuator as `actuator.toml`, which `palpate tune` reads.

use super::fit::coordinate;
use super::identified::Identified;
use super::interval::Known as Estimated;
use super::law::{Law, Parameter, Structure};
use crate::actuator::{Actuator, Form, Known, Pole};

/// Longest dead time that the file may hold, s.
const LONGEST_DELAY_S: f64 = 1.0;
/// Reach of the numerical derivative of a coefficient by a coordinate.
const REACH: f64 = 1e-5;
const Z95: f64 = 1.959_963_984_540_054;

/// The file. `source` is a sentence, where it comes from; `limit_v` the largest command of the driver.
#[must_use]
pub fn text(found: &Identified, title: &str, source: &str, limit_v: f64) -> String {
    let mut out = String::from("# An actuator, identified by palpate.\n");
    if let Some(least) = found.least_rate_mm_s {
        let least = rounded(least);
        out.push_str(&format!("# rate_limit_mm_per_s: none was reached; it is at least {least:?} mm/s\n"));
    }
    out + &actuator(found, title, source, limit_v).to_toml()
}

fn actuator(found: &Identified, title: &str, source: &str, limit_v: f64) -> Actuator {
    let law = found.law();
    let flaw = |value: f64, parameter: Parameter| Known {
        value: rounded(value),
        interval95: found.parameter(parameter).and_then(ends),
    };
    Actuator {
        title: title.to_owned(),
        source: source.to_owned(),
        form: form(found),
        delay_s: flaw(law.delay_s.min(LONGEST_DELAY_S), Parameter::Delay),
        rate_limit_mm_per_s: found.least_rate_mm_s.is_none().then(|| flaw(law.rate_mm_s, Parameter::Rate)),
        friction_v: flaw(law.friction_v, Parameter::Friction),
        backlash_mm: flaw(law.play_mm, Parameter::Play),
        back_mm_per_n: Known::exactly(0.0),
        command_limit_v: rounded(limit_v),
    }
}

/// Interval of a parameter with the value inside; none where an end is not known.
fn ends(known: &Estimated) -> Option<(f64, f64)> {
    let (low, high) = known.interval95;
    let low = if known.parameter.is_logarithmic() { low } else { low.max(0.0) };
    (low.is_finite() && high.is_finite()).then(|| (rounded(low.min(known.value)), rounded(high.max(known.value))))
}

fn form(found: &Identified) -> Form {
    let law = found.law();
    let sign = if found.inverted { -1.0 } else { 1.0 };
    let each = |of: &dyn Fn(&Law) -> f64| {
        let (value, reach) = with_error(found, of);
        Known { value: rounded(value), interval95: Some((rounded(value - reach), rounded(value + reach))) }
    };
    if matches!(law.structure, Structure::Mass | Structure::MassLag) {
        let numerator = each(&|law| sign * denominator(law).last().copied().unwrap_or(1.0) * law.gain);
        let rest = (1..=law.structure.order()).map(|k| each(&move |law: &Law| denominator(law)[k]));
        let denominator = std::iter::once(Known::exactly(1.0)).chain(rest).collect();
        return Form::Coefficients { numerator: vec![numerator], denominator };
    }
    let gain = each(&|law| sign * law.gain);
    if law.structure == Structure::Spindle {
        return Form::Poles { gain, poles: vec![Pole::Real(Known::exactly(0.0))] };
    }
    let integrator = law.structure.integrates().then_some(Known { value: 0.0, interval95: Some((0.0, 0.0)) });
    let pole = each(&|law| -law.frequency_rad_s);
    Form::Poles { gain, poles: integrator.into_iter().chain([pole]).map(Pole::Real).collect() }
}

/// Coefficients of the denominator, the highest power of s first, which has 1.
fn denominator(law: &Law) -> Vec<f64> {
    let (w, a1) = (law.frequency_rad_s, 2.0 * law.damping * law.frequency_rad_s);
    if law.structure == Structure::Mass {
        return vec![1.0, a1, w * w];
    }
    let rate = 1.0 / law.lag_s;
    vec![1.0, a1 + rate, w * w + a1 * rate, w * w * rate]
}

/// A function of the law with half its 95 % interval, by the derivatives of the coordinates and their covariance.
fn with_error(found: &Identified, of: &dyn Fn(&Law) -> f64) -> (f64, f64) {
    let (law, free) = (found.law(), &found.best().fitted.free);
    let gradient: Vec<f64> = free
        .iter()
        .map(|parameter| {
            let at = coordinate(*parameter, parameter.of(law));
            let moved = |by: f64| {
                let mut law = *law;
                parameter.set(&mut law, super::fit::value(*parameter, at + by));
                of(&law)
            };
            (moved(REACH) - moved(-REACH)) / (2.0 * REACH)
        })
        .collect();
    let covariance = &found.known.covariance;
    let variance: f64 = (0..free.len())
        .flat_map(|i| (0..free.len()).map(move |j| (i, j)))
        .map(|(i, j)| gradient[i] * covariance[(i, j)] * gradient[j])
        .sum();
    (of(law), Z95 * variance.max(0.0).sqrt())
}

/// Seven digits.
fn rounded(value: f64) -> f64 {
    format!("{value:.6e}").parse().unwrap_or(value)
}
