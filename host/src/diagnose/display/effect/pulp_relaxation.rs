//! A pulp whose force falls while it is held.

use super::{Effect, Quantity, Stage, late};
use crate::diagnose::display::channel::Channel;

/// A part of the force goes with a time constant (skin and tissue relax by a quarter to a half: Pawluk and Howe 1999, doi:10.1115/1.2835100).
pub const EFFECT: Effect = Effect {
    code: "pulp-relaxation",
    form: "exponential",
    channel: Channel::Pulp,
    stage: Stage::Pulp,
    assumption: "the force of the pulp is that of its compression at once",
    signature: "the force falls through every hold, is larger in fast presses, and less on the way back",
    twins: &["pulp-size"],
    separated_by: "a hold of several seconds after a fast press",
    quantities: &[
        Quantity {
            name: "part",
            null: Some(0.0),
            bounds: (0.0, 3.0),
            plausible: 0.15,
            starts: &[0.2],
            logarithmic: false,
        },
        Quantity {
            name: "tau_s",
            null: None,
            bounds: (0.02, 100.0),
            plausible: 1.0,
            starts: &[0.1, 0.7, 5.0],
            logarithmic: true,
        },
    ],
};

/// Force (N) with what relaxes added: `part` of the force at rest, as far as it is younger than `tau_s`.
#[must_use]
pub fn relaxing(time_s: &[f64], force_n: &[f64], (part, tau_s): (f64, f64)) -> Vec<f64> {
    let late_n = late::followed(time_s, force_n, tau_s);
    // a finger pushes and cannot pull
    force_n.iter().zip(late_n).map(|(n, late_n)| (n + part * (n - late_n)).max(0.0)).collect()
}
