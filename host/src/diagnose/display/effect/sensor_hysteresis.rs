//! A force sensing resistor that reads more on the way back.

use super::{Effect, Quantity, Stage, play};
use crate::diagnose::display::channel::Channel;

/// A play whose width grows with the force (Interlink 400 data sheet: hysteresis of 10 %).
pub const EFFECT: Effect = Effect {
    code: "sensor-creep",
    form: "hysteresis",
    channel: Channel::Force,
    stage: Stage::Sensor,
    assumption: "the reading on the way back is that of the way there",
    signature: "changes sign with the direction of the force, in proportion to it, at any rate",
    twins: &["sensor-nonlinearity"],
    separated_by: "slow and fast loops to several peaks",
    quantities: &[Quantity {
        name: "half_width",
        null: Some(0.0),
        bounds: (0.0, 0.5),
        plausible: 0.03,
        starts: &[0.02, 0.06],
        logarithmic: false,
    }],
};

/// Force (N) that the sensor feels with a half width relative to the force.
#[must_use]
pub fn felt(force_n: &[f64], half_width: f64) -> Vec<f64> {
    play(force_n, |now_n| half_width * now_n)
}
