//! The catalogue: what a simulated indentation may get wrong, one departure a file.
//!
//! Each file says which assumption of the base model the effect breaks, where it acts in the [chain](crate::chain),
//! its parameters with unit, null value and bounds, and holds the physics of that stage.

pub mod adhesion;
pub mod compliance;
pub mod contact_offset;
mod definition;
pub mod depth_gain;
pub mod drift;
mod fading;
pub mod friction;
pub mod lag;
pub mod numerics;
pub mod poisson;
mod quantity;
pub mod radius;
pub mod relaxation;
pub mod second_term;
pub mod sensor_creep;
pub mod sensor_gain;
pub mod sensor_nonlinearity;
pub mod softening;
pub mod thickness;
pub mod time_gain;

pub use definition::{Effect, FormError, Kind, Owner, Share, Stage};
use fading::fading;
pub use quantity::{Grows, Quantity, Sizes, Spread};

/// All effects of an indentation, in physical order.
pub static CATALOGUE: [&Effect; 23] = [
    &thickness::HEIGHT,
    &thickness::EVERY_HEIGHT,
    &thickness::SLIDING,
    &poisson::EFFECT,
    &second_term::EFFECT,
    &relaxation::ONE,
    &relaxation::TWO,
    &softening::EFFECT,
    &friction::EFFECT,
    &adhesion::EFFECT,
    &contact_offset::EFFECT,
    &depth_gain::EFFECT,
    &compliance::EFFECT,
    &radius::EFFECT,
    &lag::FILTER,
    &lag::RATE_LIMIT,
    &sensor_gain::EFFECT,
    &sensor_nonlinearity::EFFECT,
    &sensor_creep::CREEP,
    &sensor_creep::HYSTERESIS,
    &drift::EFFECT,
    &time_gain::EFFECT,
    &numerics::EFFECT,
];

/// The effect of a code and form; without a form its first.
#[must_use]
pub fn find(code: &str, form: Option<&str>) -> Option<&'static Effect> {
    CATALOGUE.into_iter().find(|effect| effect.code == code && form.is_none_or(|form| form == effect.form))
}

#[cfg(test)]
mod tests;
