//! A winding that warms and lets less current through.

use super::{Effect, Quantity, Stage};
use crate::diagnose::display::channel::Channel;
use crate::magnet::circuit::Circuit;

/// Resistance grows with temperature, temperature with the heat of the current, and falls with a time constant.
pub const EFFECT: Effect = Effect {
    code: "coil-heating",
    form: "first-order",
    channel: Channel::Current,
    stage: Stage::Winding,
    assumption: "the winding keeps its resistance",
    signature: "current sinks through every hold, faster at larger currents, and comes back after a pause",
    twins: &[],
    separated_by: "a long hold at a large current, a pause, and the same again",
    quantities: &[
        Quantity {
            name: "warming_K_per_J",
            null: Some(0.0),
            bounds: (0.0, 2.0),
            plausible: 0.03,
            starts: &[0.02, 0.1],
            logarithmic: false,
        },
        Quantity {
            name: "tau_s",
            null: None,
            bounds: (0.5, 5000.0),
            plausible: 100.0,
            starts: &[10.0, 120.0],
            logarithmic: true,
        },
    ],
};

/// Resistance of the cold winding over what it is at every stamp, for a drive whose command (A) is
/// what the cold winding would take: that of the display's ring. A run begins cold.
#[must_use]
pub fn kept(time_s: &[f64], command_a: &[f64], (k_per_j, tau_s): (f64, f64)) -> Vec<f64> {
    let winding = &Circuit::ring().winding;
    let cold_ohm = winding.ohm(winding.room_c);
    let mut above_k = 0.0;
    let mut out = Vec::with_capacity(command_a.len());
    for (k, command_a) in command_a.iter().enumerate() {
        let share = cold_ohm / winding.ohm(winding.room_c + above_k);
        out.push(share);
        if let Some(next_s) = time_s.get(k + 1) {
            let watt = command_a * command_a * cold_ohm * share;
            let (span_s, rest_k) = (next_s - time_s[k], k_per_j * watt * tau_s);
            above_k = rest_k + (above_k - rest_k) * (-span_s / tau_s).exp();
        }
    }
    out
}
