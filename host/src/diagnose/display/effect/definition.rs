//! What the display's catalogue says of each effect.

use crate::diagnose::display::channel::Channel;
pub use crate::infer::quantity::Quantity;

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
    /// The finger's pulp.
    Pulp,
    /// The fluid under it.
    Fluid,
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
            Stage::Pulp => "pulp",
            Stage::Fluid => "fluid",
            Stage::Sensor => "sensor",
        }
    }
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
