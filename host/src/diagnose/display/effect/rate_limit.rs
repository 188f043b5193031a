//! A spindle with a largest speed.

use super::{Effect, Quantity, Stage};
use crate::diagnose::display::channel::Channel;

/// The shaft's speed does not exceed a limit.
pub const EFFECT: Effect = Effect {
    code: "rate-limit",
    form: "speed",
    channel: Channel::Position,
    stage: Stage::Mechanics,
    assumption: "the shaft can be as fast as the linear law asks",
    signature: "fast motions of large amplitude only: straight flanks",
    twins: &["delay", "stiction"],
    separated_by: "steps of several heights: a small one is not limited",
    quantities: &[Quantity {
        name: "limit_mm_per_s",
        null: None,
        bounds: (0.5, 500.0),
        plausible: 10.0,
        starts: &[2.0, 4.0, 7.0, 10.0, 14.0, 20.0, 28.0],
        logarithmic: true,
    }],
};

/// Speed within the limit, mm/s.
#[must_use]
pub fn limited(speed_mm_s: f64, limit_mm_s: f64) -> f64 {
    speed_mm_s.max(-limit_mm_s).min(limit_mm_s)
}
