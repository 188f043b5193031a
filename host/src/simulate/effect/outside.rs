//! Responses outside the catalogue. They are made of the foam's own computed force, because the finite elements have one
//! isotropic material: each is stated in its function.

use std::f64::consts::TAU;

use super::Effect;

/// Reference lengths of the anisotropic response, mm.
const DEPTH_MM: f64 = 1.0;
const RADIUS_MM: f64 = 5.0;

/// Multiplier and addend (N) of the elastic force at a depth (mm) under a ball (mm).
///
/// Stiff skin: a membrane under a point load answers with the cube of the deflection (its stretch grows with the square, the slope
/// of it with the first power); a sharper ball bends it more, hence `k d^3 / R`. Anisotropic: contacts of different size
/// load the stiff and the soft direction in different parts, which is a power of depth and of radius beside the isotropic law.
pub(crate) fn reshaped(effects: &[Effect], depth_mm: f64, radius_mm: f64) -> (f64, f64) {
    let (mut factor, mut addend) = (1.0, 0.0);
    if depth_mm <= 0.0 {
        return (factor, addend);
    }
    for effect in effects {
        match effect {
            Effect::StiffSkin { stiffness_n_per_mm2 } => addend += stiffness_n_per_mm2 * depth_mm.powi(3) / radius_mm,
            Effect::Anisotropic { depth_power, radius_power } => {
                factor *= (depth_mm / DEPTH_MM).powf(*depth_power) * (radius_mm / RADIUS_MM).powf(*radius_power);
            }
            _ => {}
        }
    }
    (factor, addend)
}

/// How much lower the surface of a spot lies (mm), on the way down and at the end of the way back of cycle `cycle` (from 1) to a
/// depth `peak_mm`. Every cycle takes a part of what is left of the largest depth.
pub(crate) fn set_mm(effects: &[Effect], cycle: usize, peak_mm: f64) -> (f64, f64) {
    let kept: f64 = effects
        .iter()
        .map(|effect| if let Effect::PlasticSet { share } = effect { 1.0 - share } else { 1.0 })
        .product();
    let after = |cycles: usize| peak_mm * (1.0 - kept.powi(i32::try_from(cycles).unwrap_or(i32::MAX)));
    (after(cycle.saturating_sub(1)), after(cycle))
}

/// Fractional relaxation of the forces of one spot, run after run: `F(t) = int k(t - s) dF_e(s)` with
/// `k = 1 - A + A (1 + t/t0)^-beta`, summed over the steps of all its runs, which start at `starts_s`.
pub(crate) fn relaxed_by_power(effects: &[Effect], runs: &mut [Vec<f64>], starts_s: &[f64], dt_s: f64) {
    for effect in effects {
        let Effect::PowerLaw { amplitude, t0_s, beta } = *effect else { continue };
        let lost = |t: f64| amplitude * (1.0 - (1.0 + t / t0_s).powf(-beta));
        let longest = runs.iter().map(Vec::len).max().unwrap_or(0);
        let within: Vec<f64> = (0..longest).map(|k| lost(dt_s * (k as f64 + 0.5))).collect();
        let elastic = runs.to_vec();
        for (at, run) in runs.iter_mut().enumerate() {
            let steps = increments(&elastic[at]);
            for (k, force) in run.iter_mut().enumerate() {
                *force -= steps.iter().take_while(|(j, _)| *j <= k).map(|(j, df)| df * within[k - j]).sum::<f64>();
            }
            for before in 0..at {
                let earlier = increments(&elastic[before]);
                let first = starts_s[at] - starts_s[before];
                // what an unloaded spot still remembers moves slowly: every fiftieth sample, straight between
                let kept = |k: usize| {
                    let t = first + dt_s * k as f64;
                    earlier.iter().map(|(j, df)| df * lost(t - dt_s * *j as f64)).sum::<f64>()
                        - elastic[before].last().copied().unwrap_or(0.0) * lost(t - dt_s * elastic[before].len() as f64)
                };
                let knots: Vec<f64> = (0..run.len().div_ceil(STRIDE) + 1).map(|i| kept(i * STRIDE)).collect();
                for (k, force) in run.iter_mut().enumerate() {
                    let (i, part) = (k / STRIDE, (k % STRIDE) as f64 / STRIDE as f64);
                    // only where the spot is pressed: a gap pulls on nothing
                    if elastic[at][k] > 0.0 {
                        *force -= knots[i] + part * (knots[i + 1] - knots[i]);
                    }
                }
            }
            for force in run.iter_mut() {
                *force = force.max(0.0);
            }
        }
    }
}

const STRIDE: usize = 50;

/// Steps of a force that are not zero, from zero before it.
fn increments(force: &[f64]) -> Vec<(usize, f64)> {
    let mut before = 0.0;
    let step = |(k, f): (usize, &f64)| {
        let df = f - before;
        before = *f;
        (k, df)
    };
    force.iter().enumerate().map(step).filter(|(_, df)| *df != 0.0).collect()
}

/// What is added to a reading (N) besides the sensor's own: hum at a time (s) of the run, and stick-slip while the ball moves.
pub(crate) fn added_n(effects: &[Effect], time_s: f64, depth_mm: f64, moves: bool, phase: f64) -> f64 {
    let one = |effect: &Effect| match effect {
        Effect::Hum { amplitude_n, frequency_hz } => amplitude_n * (TAU * (frequency_hz * time_s + phase)).sin(),
        Effect::StickSlip { amplitude_n, period_mm } if moves && depth_mm > 0.0 => {
            amplitude_n * ((depth_mm / period_mm + phase).rem_euclid(1.0) - 0.5)
        }
        _ => 0.0,
    };
    effects.iter().map(one).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The kernel itself is the answer to a step; it lies half a sample before the first time, which moves it by beta dt / 2 t0.
    #[test]
    fn a_step_relaxes_by_the_power_law() {
        let effects = [Effect::PowerLaw { amplitude: 0.5, t0_s: 0.1, beta: 0.3 }];
        let mut runs = vec![vec![1.0; 500]];
        relaxed_by_power(&effects, &mut runs, &[0.0], 0.002);
        for k in [10, 100, 499] {
            let expected = 0.5 + 0.5 * (1.0 + 0.02 * k as f64).powf(-0.3);
            assert!((runs[0][k] - expected).abs() < 0.003, "{k}: {} {expected}", runs[0][k]);
        }
    }

    #[test]
    fn a_set_grows_from_cycle_to_cycle_towards_the_largest_depth() {
        let effects = [Effect::PlasticSet { share: 0.1 }];
        assert_eq!(set_mm(&effects, 1, 3.0).0, 0.0);
        assert!((set_mm(&effects, 2, 3.0).0 - 0.3).abs() < 1e-12);
        assert!((set_mm(&effects, 3, 3.0).0 - 0.57).abs() < 1e-12);
    }

    #[test]
    fn skin_and_anisotropy_are_what_they_say() {
        let effects = [
            Effect::StiffSkin { stiffness_n_per_mm2: 0.2 },
            Effect::Anisotropic { depth_power: 0.5, radius_power: 1.0 },
        ];
        let (factor, addend) = reshaped(&effects, 4.0, 10.0);
        assert!((factor - 4.0).abs() < 1e-12 && (addend - 0.2 * 64.0 / 10.0).abs() < 1e-12);
        assert_eq!(reshaped(&effects, -1.0, 10.0), (1.0, 0.0));
    }
}
