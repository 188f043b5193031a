//! A fluid that bears something without a field.

use super::{Effect, Quantity, Stage};
use crate::diagnose::display::channel::Channel;

/// Yield stress at no flux density: thickened or settled fluids bear tens of pascal and more.
pub const EFFECT: Effect = Effect {
    code: "fluid-rest",
    form: "constant",
    channel: Channel::Fluid,
    stage: Stage::Fluid,
    assumption: "the fluid bears nothing without a field",
    signature: "a force without current, and the same more at every current",
    twins: &["yield-law"],
    separated_by: "a press without current",
    quantities: &[Quantity {
        name: "rest_kPa",
        null: Some(0.0),
        bounds: (0.0, 5.0),
        plausible: 0.05,
        starts: &[0.05, 0.3],
        logarithmic: false,
    }],
};
