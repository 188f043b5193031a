//! A finger of another size, or with softer tissue over its bone.

use super::{Effect, Quantity, Stage};
use crate::diagnose::display::channel::Channel;

/// The curve of force over compression is stretched: the same force at another compression, beside a stiffness that is free.
pub const EFFECT: Effect = Effect {
    code: "pulp-size",
    form: "stretched",
    channel: Channel::Pulp,
    stage: Stage::Pulp,
    assumption: "the pulp stiffens over its compression as the round finger of the control curves does",
    signature: "a function of the compression alone: the same at every rate and on both ways",
    twins: &["pulp-relaxation"],
    separated_by: "presses to several depths, slow and fast",
    quantities: &[Quantity {
        name: "ratio",
        null: Some(1.0),
        bounds: (0.4, 2.5),
        plausible: 1.1,
        starts: &[0.8, 0.95, 1.05, 1.25],
        logarithmic: true,
    }],
};
