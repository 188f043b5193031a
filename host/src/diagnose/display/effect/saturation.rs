//! Steel that carries no more flux.

use super::{Effect, Quantity, Stage};
use crate::diagnose::display::channel::Channel;

/// Flux density bends towards a largest value.
pub const EFFECT: Effect = Effect {
    code: "saturation",
    form: "bend",
    channel: Channel::Flux,
    stage: Stage::Core,
    assumption: "flux follows the current by the measured line of Table 6",
    signature: "large currents only, in both directions and at any time alike",
    twins: &["remanence", "gap"],
    separated_by: "currents well above and well below the bend",
    quantities: &[Quantity {
        name: "limit_T",
        null: None,
        bounds: (0.02, 5.0),
        plausible: 0.2,
        starts: &[0.08, 0.15, 0.3, 0.6],
        logarithmic: true,
    }],
};

/// Flux density (T) with a largest value `limit_t`: x / sqrt(1 + x^2) of what the line gives.
#[must_use]
pub fn bent(line_t: f64, limit_t: f64) -> f64 {
    line_t / (1.0 + (line_t / limit_t).powi(2)).sqrt()
}
