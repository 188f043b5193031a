//! The display's catalogue: what the simulation of a display may get wrong, one departure a file.
//!
//! Each file says which assumption of the base law the effect breaks, where it acts, its parameters with unit, null value and
//! bounds, where it shows, its twins and what separates it from them, and holds the physics of that stage.

pub mod backlash;
pub mod coil_heating;
mod definition;
pub mod delay;
pub mod fluid_response;
pub mod fluid_rest;
pub mod fluid_viscosity;
pub mod gap;
pub mod late;
mod play;
pub mod pulp_relaxation;
pub mod pulp_size;
pub mod rate_limit;
pub mod remanence;
pub mod saturation;
pub mod sensor_creep;
pub mod sensor_hysteresis;
pub mod sensor_nonlinearity;
pub mod stiction;
pub mod yield_law;

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
    &pulp_size::EFFECT,
    &pulp_relaxation::EFFECT,
    &yield_law::POWER,
    &yield_law::SATURATING,
    &fluid_rest::EFFECT,
    &fluid_viscosity::EFFECT,
    &fluid_response::EFFECT,
];

/// An effect by code and form; any form where none is given.
#[must_use]
pub fn find(code: &str, form: Option<&str>) -> Option<&'static Effect> {
    CATALOGUE.iter().copied().find(|e| e.code == code && form.is_none_or(|form| form == e.form))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is to be known of an effect is in its file: its assumption, where it shows, what separates it, its amounts.
    #[test]
    fn an_effect_has_all_its_facts() {
        for (at, effect) in CATALOGUE.iter().enumerate() {
            let what = format!("{} {}", effect.code, effect.form);
            for told in [effect.assumption, effect.signature, effect.separated_by] {
                assert!(told.len() > 10 && !told.ends_with('.'), "{what}: {told:?}");
            }
            let same = |other: &&Effect| (other.code, other.form) == (effect.code, effect.form);
            assert!(!CATALOGUE[..at].iter().copied().any(|other| same(&other)), "{what} is there twice");
            for q in effect.quantities {
                let inside = |x: f64| (q.bounds.0..=q.bounds.1).contains(&x);
                assert!(inside(q.plausible) && q.starts.iter().copied().all(inside), "{what}: {}", q.name);
                assert!(q.null.is_none_or(inside) && q.null != Some(q.plausible), "{what}: {}", q.name);
            }
            for twin in effect.twins {
                assert!(find(twin, None).is_some() && *twin != effect.code, "{what} names {twin}");
            }
        }
    }
}
