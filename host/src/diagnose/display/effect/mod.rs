//! The display's catalogue: what the simulation of a display may get wrong, one departure a file.
//!
//! Each file says which assumption of the base law the effect breaks, where it acts, its parameters with unit, null value and
//! bounds, where it shows, its twins and what separates it from them, and holds the physics of that stage.

pub mod backlash;
pub mod coil_heating;
mod definition;
pub mod delay;
pub mod gap;
mod play;
pub mod rate_limit;
pub mod remanence;
pub mod saturation;
pub mod sensor_creep;
pub mod sensor_hysteresis;
pub mod sensor_nonlinearity;
pub mod stiction;

pub use definition::{Effect, Quantity, Stage};
pub use play::play;

/// All effects.
pub const CATALOGUE: &[&Effect] = &[
    &delay::EFFECT,
    &rate_limit::EFFECT,
    &stiction::EFFECT,
    &backlash::EFFECT,
    &sensor_creep::LOGARITHMIC,
    &sensor_creep::MEMORY,
    &sensor_hysteresis::EFFECT,
    &sensor_nonlinearity::QUADRATIC,
    &sensor_nonlinearity::POWER,
    &coil_heating::EFFECT,
    &saturation::EFFECT,
    &remanence::EFFECT,
    &gap::EFFECT,
];

/// An effect by code and form; any form where none is given.
#[must_use]
pub fn find(code: &str, form: Option<&str>) -> Option<&'static Effect> {
    CATALOGUE.iter().copied().find(|e| e.code == code && form.is_none_or(|form| form == e.form))
}
