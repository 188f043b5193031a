//! Dry friction of spindle and shaft.

use super::{Effect, Quantity, Stage};
use crate::diagnose::display::channel::Channel;

/// Coulomb friction: a resting shaft stays until the command differs by more than the friction, a moving one is held back by as much.
pub const EFFECT: Effect = Effect {
    code: "stiction",
    form: "friction",
    channel: Channel::Position,
    stage: Stage::Mechanics,
    assumption: "the shaft moves without dry friction",
    signature: "changes sign with the direction of motion; steps end short of the command, small ones do not move it",
    twins: &["rate-limit", "delay"],
    separated_by: "steps smaller than the friction, and a slow triangle",
    quantities: &[Quantity {
        name: "friction_mm",
        null: Some(0.0),
        bounds: (0.0, 3.0),
        plausible: 0.1,
        starts: &[0.03, 0.1, 0.4],
        logarithmic: false,
    }],
};

/// True when the friction holds a resting shaft at `position_mm` against a command, mm.
#[must_use]
pub fn holds(command_mm: f64, position_mm: f64, friction_mm: f64) -> bool {
    (command_mm - position_mm).abs() <= friction_mm
}
