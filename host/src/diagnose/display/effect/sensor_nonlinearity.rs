//! A force sensing resistor whose conductance is not a line over force.

use super::{Effect, Quantity, Stage};
use crate::diagnose::display::channel::Channel;

/// The reading bends as a parabola.
pub const QUADRATIC: Effect = Effect {
    code: "sensor-nonlinearity",
    form: "quadratic",
    channel: Channel::Force,
    stage: Stage::Sensor,
    assumption: "conductance is a line over force (Eq. 43)",
    signature: "a function of the force alone: the same at every rate, in both directions, at any time",
    twins: &["sensor-creep"],
    separated_by: "several forces, each held as long and reached from both sides",
    quantities: &[Quantity {
        name: "quadratic_per_N",
        null: Some(0.0),
        bounds: (-0.15, 0.15),
        plausible: 0.01,
        starts: &[0.0],
        logarithmic: false,
    }],
};

/// The reading is a power of the force.
pub const POWER: Effect = Effect {
    code: "sensor-nonlinearity",
    form: "power",
    channel: Channel::Force,
    stage: Stage::Sensor,
    assumption: QUADRATIC.assumption,
    signature: QUADRATIC.signature,
    twins: QUADRATIC.twins,
    separated_by: QUADRATIC.separated_by,
    quantities: &[Quantity {
        name: "exponent",
        null: Some(1.0),
        bounds: (0.4, 2.0),
        plausible: 1.05,
        starts: &[0.9, 1.1],
        logarithmic: true,
    }],
};

/// Force (N) of the power law: relative to 1 N, which the gain makes any other.
#[must_use]
pub fn powered(force_n: f64, exponent: f64) -> f64 {
    force_n.max(0.0).powf(exponent)
}
