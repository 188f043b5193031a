//! A whole experiment as a chain of stages: specimen, material, contact, machine, sensor, clock.
//!
//! The elastic force of a ball comes from continuous force models ([`Library`]); every [effect](crate::effect) changes one
//! stage of the chain. The chain is what a diagnosis fits in milliseconds; that it agrees with finite elements of the whole
//! path is tested in `tests/chain.rs`.

mod coupon;
mod kept;
mod library;
mod passage;
mod platens;
mod predict;
mod whole;

pub use coupon::{Shortening, Sides};
pub use library::{Geometry, Library, LibraryError, Missing, Need, RUBBER_NU};
pub use passage::Passage;
pub use platens::Rubbing;
pub use predict::{Chain, Prediction};
pub use whole::{Detail, ROUGH, Whole, Window, is_rough};

use std::sync::Arc;

use crate::effect::{Effect, thickness};

/// An effect with values of its parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Setting {
    /// The effect.
    pub effect: &'static Effect,
    /// Which ball or specimen it belongs to, as its index in the experiment; of no meaning for [`crate::effect::Owner::All`].
    pub owner: usize,
    /// One value a quantity of the effect.
    pub values: Vec<f64>,
}

/// The base model of one material with effects added to it.
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    /// Shear modulus (MPa).
    pub mu_mpa: f64,
    /// Exponent.
    pub alpha: f64,
    /// Effects, in any order: the chain applies them in that of their stages.
    pub settings: Vec<Setting>,
    /// What finite elements of the whole path add near this model, if they were asked.
    pub whole: Option<Arc<Whole>>,
}

impl Model {
    /// The base alone.
    #[must_use]
    pub fn base(mu_mpa: f64, alpha: f64) -> Self {
        Self { mu_mpa, alpha, settings: Vec::new(), whole: None }
    }

    /// Settings of one form of an effect.
    pub(crate) fn of<'a>(&'a self, effect: &'a Effect) -> impl Iterator<Item = &'a Setting> {
        self.settings.iter().filter(move |s| s.effect.code == effect.code && s.effect.form == effect.form)
    }

    /// By how much a specimen is higher than declared, mm.
    pub(crate) fn height_error_mm(&self, specimen: usize) -> f64 {
        self.first(&thickness::HEIGHT, specimen) + self.first(&thickness::EVERY_HEIGHT, 0)
    }

    /// First value of the setting of one owner; the null value when there is none.
    pub(crate) fn first(&self, effect: &Effect, owner: usize) -> f64 {
        let own = self.of(effect).find(|s| effect.owner == crate::effect::Owner::All || s.owner == owner);
        own.and_then(|s| s.values.first().copied()).unwrap_or(effect.quantities[0].null)
    }
}
