//! Play between spindle and what the potentiometer feels.

use super::{Effect, Quantity, Stage, play};
use crate::diagnose::display::channel::Channel;

/// The measured shaft follows the driven one with play.
pub const EFFECT: Effect = Effect {
    code: "stiction",
    form: "backlash",
    channel: Channel::Position,
    stage: Stage::Mechanics,
    assumption: "the shaft follows the spindle without play",
    signature: "a reversal is not seen until the play is taken up, at any speed",
    twins: &["delay"],
    separated_by: "a slow triangle against a fast one",
    quantities: &[Quantity {
        name: "play_mm",
        null: Some(0.0),
        bounds: (0.0, 3.0),
        plausible: 0.1,
        starts: &[0.05, 0.2, 0.8],
        logarithmic: false,
    }],
};

/// Position behind a play of `play_mm` in all, mm.
#[must_use]
pub fn behind(position_mm: &[f64], play_mm: f64) -> Vec<f64> {
    play(position_mm, |_| 0.5 * play_mm)
}
