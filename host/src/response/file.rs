//! An identified actuator as `actuator.toml`, which `palpate tune` reads.

use std::fmt::Write as _;

use super::fit::coordinate;
use super::identified::Identified;
use super::interval::Known;
use super::law::{Law, Parameter, Structure};

/// Longest dead time that the file may hold, s.
const LONGEST_DELAY_S: f64 = 1.0;
/// Reach of the numerical derivative of a coefficient by a coordinate.
const REACH: f64 = 1e-5;
const Z95: f64 = 1.959_963_984_540_054;

/// The file. `source` is a sentence, where it comes from; `limit_v` the largest command of the driver.
#[must_use]
pub fn text(found: &Identified, title: &str, source: &str, limit_v: f64) -> String {
    let law = found.law();
    let mut out = String::from("# An actuator, identified by palpate.\n");
    // Writing to a string cannot fail.
    let _ = writeln!(out, "title = {}\nsource = {}", quoted(title), quoted(source));
    let _ = writeln!(out, "delay_s = {}", number(law.delay_s.min(LONGEST_DELAY_S)));
    match found.least_rate_mm_s {
        Some(least) => {
            let _ = writeln!(out, "# rate_limit_mm_per_s: none was reached; it is at least {} mm/s", number(least));
        }
        None => {
            let _ = writeln!(out, "rate_limit_mm_per_s = {}", number(law.rate_mm_s));
        }
    }
    let _ = writeln!(out, "friction_v = {}\nbacklash_mm = {}", number(law.friction_v), number(law.play_mm));
    let _ = writeln!(out, "command_limit_v = {}", number(limit_v));
    let flaws = [
        ("delay_s", Parameter::Delay),
        ("rate_limit_mm_per_s", Parameter::Rate),
        ("friction_v", Parameter::Friction),
        ("backlash_mm", Parameter::Play),
    ];
    let pairs: Vec<String> = flaws
        .iter()
        .filter_map(|(key, parameter)| Some(format!("{key} = {}", pair(found.parameter(*parameter)?)?)))
        .collect();
    if !pairs.is_empty() {
        let _ = writeln!(out, "interval95 = {{ {} }}", pairs.join(", "));
    }
    plant(&mut out, found);
    out
}

/// Interval of a parameter with the value inside; none where an end is not known.
fn pair(known: &Known) -> Option<String> {
    let (low, high) = known.interval95;
    let low = if known.parameter.is_logarithmic() { low } else { low.max(0.0) };
    (low.is_finite() && high.is_finite())
        .then(|| format!("[{}, {}]", number(low.min(known.value)), number(high.max(known.value))))
}

fn plant(out: &mut String, found: &Identified) {
    let law = found.law();
    let sign = if found.inverted { -1.0 } else { 1.0 };
    let _ = writeln!(out, "\n[plant]");
    let each = |of: &dyn Fn(&Law) -> f64| {
        let (value, reach) = with_error(found, of);
        (value, [value - reach, value + reach])
    };
    if matches!(law.structure, Structure::Mass | Structure::MassLag) {
        let numerator = each(&|law| sign * denominator(law).last().copied().unwrap_or(1.0) * law.gain);
        let count = law.structure.order();
        let rest: Vec<_> = (1..=count).map(|k| each(&move |law: &Law| denominator(law)[k])).collect();
        let values: Vec<String> = rest.iter().map(|(value, _)| number(*value)).collect();
        let ends: Vec<String> = rest.iter().map(|(_, ends)| range(*ends)).collect();
        let _ = writeln!(out, "numerator = [{}]\ndenominator = [1.0, {}]", number(numerator.0), values.join(", "));
        let _ = writeln!(
            out,
            "interval95 = {{ numerator = [{}], denominator = [[1.0, 1.0], {}] }}",
            range(numerator.1),
            ends.join(", ")
        );
        return;
    }
    let gain = each(&|law| sign * law.gain);
    let _ = writeln!(out, "gain = {}", number(gain.0));
    if law.structure == Structure::Spindle {
        let _ = writeln!(out, "poles_per_s = [0.0]\ninterval95 = {{ gain = {} }}", range(gain.1));
        return;
    }
    let pole = each(&|law| -law.frequency_rad_s);
    let (zero, fixed) = if law.structure.integrates() { ("0.0, ", "[0.0, 0.0], ") } else { ("", "") };
    let _ = writeln!(out, "poles_per_s = [{zero}{}]", number(pole.0));
    let _ = writeln!(out, "interval95 = {{ gain = {}, poles_per_s = [{fixed}{}] }}", range(gain.1), range(pole.1));
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

fn range([low, high]: [f64; 2]) -> String {
    format!("[{}, {}]", number(low), number(high))
}

/// A float of TOML with seven digits.
fn number(value: f64) -> String {
    let text = format!("{:?}", format!("{value:.6e}").parse::<f64>().unwrap_or(value));
    if text.contains(['.', 'e']) { text } else { format!("{text}.0") }
}

fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}
