//! A fluid that bears more the faster it is pressed.

use super::{Effect, Quantity, Stage};
use crate::diagnose::display::channel::{Channel, slope};

/// Bingham's plastic viscosity: the stress grows in proportion to the speed of the finger.
pub const EFFECT: Effect = Effect {
    code: "fluid-viscosity",
    form: "bingham",
    channel: Channel::Fluid,
    stage: Stage::Fluid,
    assumption: "the fluid bears its yield stress at any speed",
    signature: "forces of fast presses are larger, and fall where the finger stops",
    twins: &["fluid-response"],
    separated_by: "the same press slow and fast",
    quantities: &[Quantity {
        name: "kPa_s_per_mm",
        null: Some(0.0),
        bounds: (0.0, 2.0),
        plausible: 0.01,
        starts: &[0.01, 0.1],
        logarithmic: false,
    }],
};

/// Speed downwards at every stamp, mm/s.
#[must_use]
pub fn down_mm_s(time_s: &[f64], place_mm: &[f64]) -> Vec<f64> {
    (0..place_mm.len()).map(|k| slope(time_s, place_mm, k).max(0.0)).collect()
}
