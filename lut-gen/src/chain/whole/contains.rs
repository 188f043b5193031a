//! What a model contains.

use crate::chain::Model;
use crate::effect::{Effect, poisson, radius, thickness};

/// True when a model has an effect, in whatever form.
pub(super) fn has(model: &Model, effect: &Effect) -> bool {
    model.settings.iter().any(|s| s.effect.code == effect.code)
}

/// What the chain has exactly of a model: its first term, elastic, with the shapes of ball and block.
pub(super) fn first_term(model: &Model) -> Model {
    let settings = model.settings.iter().filter(|s| is_shape(s.effect.code)).cloned().collect();
    Model { settings, ..model.clone() }
}

/// Effects that only change the numbers of the elastic solve, which the chain's force models contain exactly.
fn is_shape(code: &str) -> bool {
    [poisson::EFFECT.code, thickness::HEIGHT.code, radius::EFFECT.code].contains(&code)
}
