//! A force sensing resistor that reads more the longer it is loaded.

use super::{Effect, Quantity, Stage, late};
use crate::diagnose::display::channel::Channel;

const AMOUNT: Quantity = Quantity {
    name: "per_decade",
    null: Some(0.0),
    bounds: (-0.3, 0.3),
    plausible: 0.03,
    starts: &[0.03],
    logarithmic: false,
};

/// The reading grows by a fraction per decade of time under load (Interlink 400 data sheet: below 5 %).
pub const LOGARITHMIC: Effect = Effect {
    code: "sensor-creep",
    form: "logarithmic",
    channel: Channel::Force,
    stage: Stage::Sensor,
    assumption: "the reading depends on the force of the moment",
    signature: "grows through every hold, in proportion to the force, in the logarithm of time since the sensor was touched",
    twins: &["sensor-nonlinearity"],
    separated_by: "a long hold at one force, and short touches at many",
    quantities: &[AMOUNT],
};

/// The reading has a part that follows the force late.
pub const MEMORY: Effect = Effect {
    code: "sensor-creep",
    form: "memory",
    channel: Channel::Force,
    stage: Stage::Sensor,
    assumption: "the reading depends on the force of the moment",
    signature: "grows through every hold towards a new value, and stays behind after it",
    twins: &["sensor-nonlinearity"],
    separated_by: "holds of several lengths",
    quantities: &[
        Quantity {
            name: "amplitude",
            null: Some(0.0),
            bounds: (-0.5, 0.5),
            plausible: 0.05,
            starts: &[0.05],
            logarithmic: false,
        },
        Quantity {
            name: "tau_s",
            null: None,
            bounds: (0.05, 500.0),
            plausible: 2.0,
            starts: &[0.3, 2.0, 12.0],
            logarithmic: true,
        },
    ],
};

/// Time from which decades are counted, s.
const SINCE_S: f64 = 0.1;
/// Force below which the sensor counts as released, N.
const RELEASED_N: f64 = 0.1;

/// Force (N) with the logarithmic creep.
#[must_use]
pub fn crept(time_s: &[f64], force_n: &[f64], per_decade: f64) -> Vec<f64> {
    let mut touched_s = f64::NAN;
    time_s
        .iter()
        .zip(force_n)
        .map(|(now_s, force_n)| {
            if *force_n < RELEASED_N {
                touched_s = f64::NAN;
                return *force_n;
            }
            if touched_s.is_nan() {
                touched_s = *now_s;
            }
            force_n * (1.0 + per_decade * ((now_s - touched_s) / SINCE_S).ln_1p() / std::f64::consts::LN_10)
        })
        .collect()
}

/// Force (N) with a part `amplitude` of it that follows with `tau_s`, the force straight between samples.
#[must_use]
pub fn remembered(time_s: &[f64], force_n: &[f64], (amplitude, tau_s): (f64, f64)) -> Vec<f64> {
    let late_n = late::followed(time_s, force_n, tau_s);
    force_n.iter().zip(late_n).map(|(now_n, late_n)| now_n + amplitude * late_n).collect()
}
