//! The display's catalogue: what the simulation of a display may get wrong, one departure a file.
//!
//! Each file says which assumption of the base law the effect breaks, where it acts, its parameters with unit, null value and
//! bounds, where it shows, its twins and what separates it from them, and holds the physics of that stage.

pub mod backlash;
pub mod coil_heating;
pub mod delay;
pub mod gap;
pub mod rate_limit;
pub mod remanence;
pub mod saturation;
pub mod sensor_creep;
pub mod sensor_hysteresis;
pub mod sensor_nonlinearity;
pub mod stiction;

use super::channel::Channel;

/// Where an effect acts, in the order in which a command passes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// Between command and drive.
    Link,
    /// Spindle and shaft.
    Mechanics,
    /// Winding of the coil.
    Winding,
    /// Steel and gap.
    Core,
    /// The sensor.
    Sensor,
}

impl Stage {
    /// The word in reports.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Stage::Link => "link",
            Stage::Mechanics => "mechanics",
            Stage::Winding => "winding",
            Stage::Core => "core",
            Stage::Sensor => "sensor",
        }
    }
}

/// A parameter of an effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantity {
    /// Name in answers, with its unit.
    pub name: &'static str,
    /// Value at which the effect is absent; none for a shape, whose amplitude is then null.
    pub null: Option<f64>,
    /// Least and largest value that is physically possible.
    pub bounds: (f64, f64),
    /// An amount that displays meet; what a design cannot see of it is a blind spot.
    pub plausible: f64,
    /// Values from which a search begins.
    pub starts: &'static [f64],
    /// Searched in its logarithm.
    pub logarithmic: bool,
}

/// One departure from the base law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effect {
    /// Stable code of the contract.
    pub code: &'static str,
    /// Which of several laws with that code.
    pub form: &'static str,
    /// What it is seen in.
    pub channel: Channel,
    /// Where it acts.
    pub stage: Stage,
    /// Assumption of the base that it breaks.
    pub assumption: &'static str,
    /// Where it shows after the base parameters are fitted again.
    pub signature: &'static str,
    /// Codes that can look alike.
    pub twins: &'static [&'static str],
    /// What separates it from them.
    pub separated_by: &'static str,
    /// Its parameters.
    pub quantities: &'static [Quantity],
}

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

/// Play of a half width that may change: the follower stays until it is pushed.
#[must_use]
pub fn play(values: &[f64], half_width: impl Fn(f64) -> f64) -> Vec<f64> {
    let mut follower = values.first().copied().unwrap_or(0.0);
    values
        .iter()
        .map(|value| {
            let half = half_width(*value).max(0.0);
            // bounds that are no number hold nothing back
            follower = follower.max(value - half).min(value + half);
            follower
        })
        .collect()
}
