//! A gap that is not what was measured.

use super::{Effect, Quantity, Stage};
use crate::diagnose::display::channel::Channel;

/// The true gap differs from the recorded one.
pub const EFFECT: Effect = Effect {
    code: "gap",
    form: "offset",
    channel: Channel::Flux,
    stage: Stage::Core,
    assumption: "the gap is as recorded, and holds all the circuit's reluctance",
    signature: "only between gaps: at one gap it is the line's slope",
    twins: &["saturation"],
    separated_by: "the same currents at a second gap, set with a shim",
    quantities: &[Quantity {
        name: "offset_mm",
        null: Some(0.0),
        bounds: (-2.0, 5.0),
        plausible: 0.2,
        starts: &[-0.1, 0.2],
        logarithmic: false,
    }],
};

/// Factor on the flux at a recorded gap, over that at the smallest recorded one, mm; 1 where no gap is recorded.
#[must_use]
pub fn factor(gap_mm: f64, smallest_mm: f64, offset_mm: f64) -> f64 {
    if gap_mm <= 0.0 {
        return 1.0;
    }
    // a gap is never closed altogether
    (smallest_mm + offset_mm).max(0.05 * smallest_mm) / (gap_mm + offset_mm).max(0.05 * smallest_mm)
}
