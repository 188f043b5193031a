//! Recordings freed from what only the rig did to them: the depth that the ball truly had, the force that truly was on it.

use lut_gen::chain::Setting;
use lut_gen::effect::{depth_gain, drift, lag, sensor_creep, time_gain};

/// Rounds in which a force is found from its reading. Each leaves less than the part by which a sensor misses (a creep of 0.3
/// leaves 1e-4 after eight).
const ROUNDS: usize = 8;

/// Takes effects of machine, sensor and clock off a run: times (s) from its start at `start_s` on the session clock, recorded depth
/// (mm) and reading (N). Returns depth of the ball and force on it.
#[must_use]
pub fn freed(
    rig: &[Setting],
    time_s: &[f64],
    start_s: f64,
    depth_mm: &[f64],
    reading_n: &[f64],
) -> (Vec<f64>, Vec<f64>) {
    let clock = of_all(rig, &time_gain::EFFECT);
    let time_s: Vec<f64> = time_s.iter().map(|t| t / clock).collect();
    let (time_s, start_s) = (time_s.as_slice(), start_s / clock);
    let force = force_of(rig, time_s, start_s, reading_n);
    let gain = of_all(rig, &depth_gain::EFFECT);
    let mut depth: Vec<f64> = depth_mm.iter().map(|d| depth_gain::true_mm(*d, gain)).collect();
    let of = |code: &'static str| rig.iter().filter(move |s| s.effect.code == code);
    for setting in of("contact-offset") {
        depth.iter_mut().for_each(|d| *d += setting.values[0]);
    }
    for setting in of("lag") {
        depth = if setting.effect.form == lag::FILTER.form {
            lag::filtered(time_s, &depth, setting.values[0])
        } else {
            lag::limited(time_s, &depth, setting.values[0])
        };
    }
    for setting in of("compliance") {
        depth.iter_mut().zip(&force).for_each(|(d, f)| *d -= setting.values[0] * f);
    }
    (depth, force)
}

/// Value of an effect that belongs to the whole experiment; its null value without a setting.
fn of_all(rig: &[Setting], effect: &lut_gen::effect::Effect) -> f64 {
    let own = rig.iter().find(|s| s.effect.code == effect.code);
    own.and_then(|s| s.values.first().copied()).unwrap_or(effect.quantities[0].null)
}

fn force_of(rig: &[Setting], time_s: &[f64], start_s: f64, reading_n: &[f64]) -> Vec<f64> {
    if rig.is_empty() {
        return reading_n.to_vec();
    }
    let mut force = reading_n.to_vec();
    for _ in 0..ROUNDS {
        let read = reading(rig, time_s, start_s, &force);
        for ((f, wanted), got) in force.iter_mut().zip(reading_n).zip(&read) {
            *f += wanted - got;
        }
    }
    force
}

/// What the sensor makes of a force, in the order of the chain.
fn reading(rig: &[Setting], time_s: &[f64], start_s: f64, force_n: &[f64]) -> Vec<f64> {
    let mut out = force_n.to_vec();
    let of = |code: &'static str| rig.iter().filter(move |s| s.effect.code == code);
    for setting in of("sensor-creep") {
        match setting.values[..] {
            [amplitude, tau_s] => sensor_creep::creep(time_s, &mut out, (amplitude, tau_s)),
            [width] => sensor_creep::hysteresis(&mut out, width),
            _ => {}
        }
    }
    for setting in of("sensor-nonlinearity") {
        out.iter_mut().for_each(|f| *f += setting.values[0] * *f * *f);
    }
    for setting in of("sensor-gain") {
        out.iter_mut().for_each(|f| *f *= setting.values[0]);
    }
    for setting in of("drift") {
        out.iter_mut().zip(time_s).for_each(|(f, t)| *f += drift::zero_n(setting.values[0], start_s + t));
    }
    out
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use lut_gen::effect;

    use super::*;

    fn setting(code: &str, form: &str, values: &[f64]) -> Setting {
        Setting { effect: effect::find(code, Some(form)).unwrap(), owner: 0, values: values.to_vec() }
    }

    /// A rig that gives way, with a sensor that creeps, bends, is off by a tenth and drifts: the force and the depth are found again.
    #[test]
    fn what_the_rig_added_is_taken_off() {
        let time_s: Vec<f64> = (0..200).map(|i| 0.02 * f64::from(i)).collect();
        let depth: Vec<f64> = time_s.iter().map(|t| f64::min(*t, 3.0)).collect();
        let force: Vec<f64> = depth.iter().map(|d| 0.4 * d.powf(1.5)).collect();
        let rig = [
            setting("contact-offset", "constant", &[0.1]),
            setting("compliance", "linear", &[0.05]),
            setting("sensor-creep", "creep", &[0.05, 1.0]),
            setting("sensor-nonlinearity", "quadratic", &[0.02]),
            setting("sensor-gain", "constant", &[1.1]),
            setting("drift", "linear", &[0.5]),
        ];
        let read = reading(&rig, &time_s, 100.0, &force);
        let recorded: Vec<f64> = depth.iter().zip(&force).map(|(d, f)| d + 0.05 * f - 0.1).collect();
        assert!(read.iter().zip(&force).any(|(r, f)| (r - f).abs() > 0.2), "the rig shows");
        let (true_depth, true_force) = freed(&rig, &time_s, 100.0, &recorded, &read);
        for i in 0..time_s.len() {
            assert!((true_force[i] - force[i]).abs() < 1e-5, "{i}: {} {}", true_force[i], force[i]);
            assert!((true_depth[i] - depth[i]).abs() < 1e-5, "{i}: {} {}", true_depth[i], depth[i]);
        }
    }

    #[test]
    fn without_effects_nothing_changes() {
        let (depth, force) = freed(&[], &[0.0, 1.0], 0.0, &[0.0, 1.0], &[0.1, 0.4]);
        assert_eq!((depth, force), (vec![0.0, 1.0], vec![0.1, 0.4]));
    }
}
