//! The display's linear actuator as data: transfer function, dead time, flaws, and how well each number is known.
//!
//! | file | holds |
//! |---|---|
//! | [`plant`], [`polynomial`] | command in V to shaft in mm, as a transfer function with a dead time |
//! | [`flaws`] | limit of speed, dry friction, backlash |
//! | [`uncertain`] | a plant whose coefficients lie in a box |
//! | `file`, `writing` | `actuator.toml` |

mod file;
pub mod flaws;
pub mod plant;
pub mod polynomial;
pub mod uncertain;
mod writing;

pub use file::{parse, read};

use std::path::Path;

use crate::experiment::ExperimentError;
use flaws::Flaws;
use plant::Plant;
use uncertain::Uncertain;

/// The file of a voice coil.
const VOICE_COIL: &str = include_str!("../../actuators/voice-coil.toml");

/// A number with its interval, the lower end first; none where it is not known how well it is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Known {
    /// Best value.
    pub value: f64,
    /// 95 % interval.
    pub interval95: Option<(f64, f64)>,
}

impl Known {
    /// Without an interval.
    pub const fn exactly(value: f64) -> Self {
        Self { value, interval95: None }
    }
}

/// How the transfer function is written in the file.
#[derive(Debug, Clone, PartialEq)]
pub enum Form {
    /// Coefficients, the highest power of `s` first.
    Coefficients {
        /// mm/V times powers of 1/s.
        numerator: Vec<Known>,
        /// Powers of 1/s.
        denominator: Vec<Known>,
    },
    /// `gain / (s^m prod(1 - s/p))` over the poles that are not 0, `m` of them being 0.
    Poles {
        /// mm/V; with a pole at 0 mm/(V s).
        gain: Known,
        /// 1/s.
        poles: Vec<Pole>,
    },
}

/// A pole, or a pair of them, 1/s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Pole {
    /// One on the real axis.
    Real(Known),
    /// `real +- imaginary i`.
    Pair(Known, Known),
}

/// An actuator as `actuator.toml` describes it.
#[derive(Debug, Clone, PartialEq)]
pub struct Actuator {
    /// What it is.
    pub title: String,
    /// Where its numbers come from, in a sentence; empty if nothing is told.
    pub source: String,
    /// Its transfer function.
    pub form: Form,
    /// Dead time of the plant, without the board's own tick, s.
    pub delay_s: Known,
    /// Largest speed, mm/s; none for no limit.
    pub rate_limit_mm_per_s: Option<Known>,
    /// Dry friction, as the command that a resting shaft resists, V.
    pub friction_v: Known,
    /// Whole width of the gap between spindle and shaft, mm.
    pub backlash_mm: Known,
    /// How far a force on the shaft drives it back at rest, mm/N: 0 for a spindle.
    pub back_mm_per_n: Known,
    /// Largest command of the driver, V.
    pub command_limit_v: f64,
}

impl Actuator {
    /// The thesis' actuator (section 5.5), without flaws.
    pub fn thesis() -> Self {
        let exact = |list: &[f64]| list.iter().map(|value| Known::exactly(*value)).collect();
        Self {
            title: "the thesis' actuator".to_owned(),
            source: "thesis section 5.5".to_owned(),
            form: Form::Coefficients { numerator: exact(&[86.0]), denominator: exact(&[1.0, 23.4, 86.0]) },
            delay_s: Known::exactly(0.0),
            rate_limit_mm_per_s: None,
            friction_v: Known::exactly(0.0),
            backlash_mm: Known::exactly(0.0),
            back_mm_per_n: Known::exactly(0.0),
            command_limit_v: f64::from(firmware::pid::U_MAX_V),
        }
    }

    /// A voice coil (thesis section 6.2), its numbers assumed: the file that comes with the program.
    ///
    /// # Errors
    /// None that a test would not show.
    pub fn voice_coil() -> Result<Self, ExperimentError> {
        parse(Path::new("voice-coil.toml"), VOICE_COIL)
    }

    /// The one that a word names: `thesis`, `voice-coil`, or a file, which goes before both.
    ///
    /// # Errors
    /// As [`read`].
    pub fn named(word: &Path) -> Result<Self, ExperimentError> {
        match word.to_str() {
            Some("thesis") if !word.is_file() => Ok(Self::thesis()),
            Some("voice-coil") if !word.is_file() => Self::voice_coil(),
            _ => read(word),
        }
    }

    /// The plant with the best values.
    pub fn plant(&self) -> Plant {
        let values = |list: &[Known]| list.iter().map(|known| known.value).collect::<Vec<_>>();
        match &self.form {
            Form::Coefficients { numerator, denominator } => {
                Plant::of(&values(numerator), &values(denominator), self.delay_s.value)
            }
            Form::Poles { gain, poles } => uncertain::expanded(gain.value, poles, self.delay_s.value),
        }
    }

    /// What it adds to the plant.
    pub fn flaws(&self) -> Flaws {
        Flaws {
            rate_mm_s: self.rate_limit_mm_per_s.map_or(f64::INFINITY, |known| known.value),
            friction_v: self.friction_v.value,
            backlash_mm: self.backlash_mm.value,
        }
    }

    /// The box of its intervals, or, where it has none, of a part of every coefficient.
    pub fn uncertain(&self, part: f64) -> Uncertain {
        let found = Uncertain::known(self);
        if found.bounds.is_empty() { Uncertain::within(&self.plant(), part) } else { found }
    }
}

#[cfg(test)]
mod tests;
