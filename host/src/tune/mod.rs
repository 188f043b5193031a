//! Gains of the display's position loop, searched (thesis sections 5.5 and 5.6, Appendix E).
//!
//! | file | holds |
//! |---|---|
//! | [`gains`], [`step`] | four gains; what is read of a step |
//! | [`continuous`], `dead_time`, `modal`, `read`, `cubic` | the thesis' continuous loop (Eq. 53), exactly between samples |
//! | [`appendix`] | the same as Appendix E programs it |
//! | [`sampled`], [`windup`], `shaft` | the loop that runs: the board's own controller, hold, delay, limit, flaws (Eq. 54) |
//! | [`frequency`] | loop gain, bandwidth, margins |
//! | [`limits`], `tuning`, `programme`, `search` | limits, and the search by `cobyla` and `slsqp` from several starts |
//! | `judged` | gains on the plant |
//! | [`worst`], `certificate`, `bound`, `bound_sampled`, `discrete`, `interval` | the worst plant of a box, certified |
//! | [`roots`] | roots while coefficients vary (Eq. 56, Fig. 78) |
//! | [`study`] | all of it for one report |
//! | [`setting`] | what a board is set to for an actuator |

pub mod appendix;
mod bound;
mod bound_sampled;
mod certificate;
pub mod continuous;
mod cubic;
mod dead_time;
mod discrete;
mod error;
pub mod frequency;
pub mod gains;
mod interval;
mod judged;
pub mod limits;
mod modal;
mod programme;
mod read;
pub mod roots;
pub mod sampled;
mod search;
pub mod setting;
mod shaft;
pub mod step;
pub mod study;
mod tuning;
mod way;
pub mod windup;
pub mod worst;

pub use certificate::{NoCertificate, certify, sample};
pub use error::TuneError;
pub use gains::Gains;
pub use judged::judge;
pub use tuning::tune;
pub use way::Way;

use nalgebra::Complex;

use crate::actuator::flaws::Flaws;
use crate::actuator::uncertain::Uncertain;
use frequency::Margins;
use limits::{Limits, Rule};
use sampled::Sampling;
use step::{AtTicks, Step};

impl Way {
    /// The board's limit on its command, if it cuts.
    #[must_use]
    pub fn limited(self, limits: &Limits) -> Self {
        match self {
            Self::Sampled(sampling) if limits.cut => {
                Self::Sampled(Sampling { limit_v: Some(limits.command_v), ..sampling })
            }
            other => other,
        }
    }

    fn late_s(self) -> f64 {
        match self {
            Self::Continuous => 0.0,
            // A hold is late by half a tick on average.
            Self::Sampled(sampling) => sampling.tick_s * (0.5 + sampling.ticks_late as f64),
        }
    }
}

/// What gains are wanted for.
#[derive(Debug, Clone, PartialEq)]
pub struct Asked {
    /// The plant, and the box around it.
    pub uncertain: Uncertain,
    /// What the actuator adds; only in a sampled loop.
    pub flaws: Flaws,
    /// Which loop.
    pub way: Way,
    /// What the gains must keep to.
    pub limits: Limits,
    /// What is least.
    pub rule: Rule,
    /// Least for the worst corner of the box, and limits for all of them, instead of for the plant alone.
    pub robust: bool,
}

/// Gains that were searched.
#[derive(Debug, Clone)]
pub struct Tuned {
    /// The gains, as the link carries them.
    pub gains: Gains,
    /// Largest cost over the plants that they were searched for, mm s for 1 mm.
    pub cost: f64,
    /// Costs at the ends of the searches that keep the limits, the best first.
    pub ends: Vec<f64>,
    /// Steps that were computed.
    pub calls: usize,
    /// How long the search took, s.
    pub seconds: f64,
}

/// Gains on one plant.
#[derive(Debug, Clone)]
pub struct Judged {
    /// The gains.
    pub gains: Gains,
    /// Their step.
    pub step: Step,
    /// The same read at the ticks alone, of a sampled loop.
    pub at_ticks: Option<AtTicks>,
    /// Bandwidth and margins.
    pub margins: Margins,
    /// Poles of the closed loop, 1/s, or in `z`; none of a continuous loop with dead time, which has infinitely many.
    pub poles: Vec<Complex<f64>>,
}

/// Corners that a robust search looks at: of more coefficients they would be too many.
const MOST_VARIED: usize = 6;

#[cfg(test)]
mod tests;
