//! The current behind a command: the coil's own time, which the core's saturation shortens.

use super::channel::{nominal_current_a, nominal_flux_t};
use super::law::RESPONSE_S;
use crate::magnet::circuit::Circuit;

/// Shortest and longest step, s: the inductance is taken as constant in it. The ring's time is 8 ms
/// at rest, and 1 ms at 2.5 A.
const STEP_S: (f64, f64) = (1e-4, 2e-3);

/// Longest step where the fluid follows the current with 3 ms, s: its lag within a tick is to be
/// seen to some uT.
const ANSWER_STEP_S: f64 = 0.5e-3;

/// Change of current in a step, A: the inductance changes by a tenth at most.
const CHANGE_A: f64 = 0.05;

/// Voltage that is left over a coil whose current has settled, V; difference of the answered
/// current, A.
const SETTLED_V: f64 = 1e-5;

/// Current (A) at every stamp. The drive takes a command (A) for what the cold winding of the
/// display's ring would have, and holds its voltage from the stamp before; `share` is the cold
/// winding's resistance over what it is then. A run begins without current.
#[must_use]
pub fn followed(time_s: &[f64], command_a: &[f64], share: &[f64]) -> Vec<f64> {
    let mut out = Vec::with_capacity(command_a.len());
    follow((time_s, command_a, share), STEP_S.1, |current_a, _| current_a, |current_a| out.push(current_a));
    out
}

/// The same as the fluid has answered it so far: the lasting current that would give its flux
/// density at the nominal line.
#[must_use]
pub fn answered(time_s: &[f64], command_a: &[f64], share: &[f64]) -> Vec<f64> {
    let (mut out, mut flux_t, mut before_a) = (Vec::with_capacity(command_a.len()), 0.0, 0.0);
    let answers = |current_a: f64, dt_s: f64| {
        let rest_t = 0.5 * (nominal_flux_t(before_a) + nominal_flux_t(current_a));
        before_a = current_a;
        flux_t -= (rest_t - flux_t) * (-dt_s / RESPONSE_S).exp_m1();
        nominal_current_a(flux_t)
    };
    follow((time_s, command_a, share), ANSWER_STEP_S, answers, |answered_a| out.push(answered_a));
    out
}

/// Walks through a run: `step` makes of the current after a time what is wanted, and is settled
/// when that is the current; `stamp` takes it at every stamp.
fn follow(
    (time_s, command_a, share): (&[f64], &[f64], &[f64]),
    longest_s: f64,
    mut step: impl FnMut(f64, f64) -> f64,
    mut stamp: impl FnMut(f64),
) {
    let circuit = Circuit::ring();
    let cold_ohm = circuit.winding.ohm(circuit.winding.room_c);
    let first_s = time_s.first().zip(time_s.get(1)).map_or(0.0, |(a, b)| b - a);
    let (mut linkage_wb, mut current_a, mut wanted_a) = (0.0, 0.0, 0.0);
    for (k, (command_a, share)) in command_a.iter().zip(share).enumerate() {
        let span_s = if k > 0 { time_s[k] - time_s[k - 1] } else { first_s };
        let (volt, ohm) = (command_a * cold_ohm, cold_ohm / share);
        let mut left_s = span_s;
        while left_s > 0.0 {
            let over_v = (volt - ohm * current_a).abs();
            if over_v < SETTLED_V && (wanted_a - current_a).abs() < SETTLED_V {
                break;
            }
            let changes_s = CHANGE_A * circuit.inductance_h(linkage_wb) / over_v;
            let step_s = changes_s.clamp(STEP_S.0, longest_s).min(left_s);
            linkage_wb = circuit.after_wb(linkage_wb, (volt, ohm), step_s);
            current_a = circuit.current_a(linkage_wb);
            wanted_a = step(current_a, step_s);
            left_s -= step_s;
        }
        stamp(wanted_a);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_currents_lag_and_large_ones_follow() {
        let time_s: Vec<f64> = (0..20).map(|k| 0.02 * f64::from(k)).collect();
        let behind = |from: f64, to: f64| {
            let command: Vec<f64> = (0..20).map(|k| if k < 10 { from } else { to }).collect();
            let found = followed(&time_s, &command, &[1.0; 20]);
            // Settled before and after: 160 ms are 20 times of 8 ms.
            assert!((found[9] - from).abs() < 1e-5 && (found[19] - to).abs() < 1e-5, "{found:?}");
            (found[10] - to) / (from - to)
        };
        // 39.7 mH at 5.22 ohm: exp(-20 / 7.6) is left after a tick.
        assert!((behind(0.0, 0.2) - 0.072).abs() < 3e-3, "{}", behind(0.0, 0.2));
        assert!(behind(1.5, 2.5).abs() < 1e-3, "{}", behind(1.5, 2.5));
    }

    #[test]
    fn a_warm_winding_has_its_share() {
        let time_s: Vec<f64> = (0..20).map(|k| 0.02 * f64::from(k)).collect();
        let found = followed(&time_s, &[1.0; 20], &[0.8; 20]);
        // Within a tick the fluid is behind a current that rises.
        let answered = answered(&time_s, &[1.0; 20], &[0.8; 20]);
        assert!(answered[0] < found[0] && (answered[19] - 0.8).abs() < 1e-4, "{answered:?}");
        assert!((found[19] - 0.8).abs() < 1e-5, "{}", found[19]);
    }
}
