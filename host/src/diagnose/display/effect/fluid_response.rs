//! A fluid that answers its field late.

use super::{Effect, Quantity, Stage};
use crate::diagnose::display::channel::Channel;

/// The yield stress follows the flux density with a time constant, beyond the milliseconds that such fluids take.
pub const EFFECT: Effect = Effect {
    code: "fluid-response",
    form: "first-order",
    channel: Channel::Fluid,
    stage: Stage::Fluid,
    assumption: "the yield stress is that of the flux density of the moment",
    signature: "after every change of the current under a moving finger",
    twins: &["fluid-viscosity"],
    separated_by: "steps of the current while the finger goes down slowly",
    quantities: &[Quantity {
        name: "tau_s",
        null: Some(0.0),
        bounds: (0.0, 5.0),
        plausible: 0.02,
        starts: &[0.05, 0.5],
        logarithmic: false,
    }],
};
