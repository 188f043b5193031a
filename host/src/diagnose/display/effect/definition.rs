//! What the display's catalogue says of each effect.

use crate::diagnose::display::channel::Channel;
use crate::infer::evidence::Prior;

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

impl Quantity {
    /// The coordinate of a value.
    #[must_use]
    pub fn of(&self, value: f64) -> f64 {
        if self.logarithmic { value.max(f64::MIN_POSITIVE).ln() } else { value }
    }

    /// What is known of it beforehand, as a coordinate: half of all displays have less than the plausible
    /// amount, and once in a while one has much more; of a shape its bounds are known.
    #[must_use]
    pub fn known(&self) -> Prior {
        match self.null {
            Some(null) => Prior::Cauchy { null: self.of(null), scale: (self.of(self.plausible) - self.of(null)).abs() },
            None => Prior::between((self.of(self.bounds.0), self.of(self.bounds.1))),
        }
    }

    /// True for an amount of one sign.
    #[must_use]
    pub fn is_one_sided(&self) -> bool {
        self.null.is_some_and(|null| self.bounds.0 >= null || self.bounds.1 <= null)
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
