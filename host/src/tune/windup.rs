//! Controllers of the sampled loop: the board's own code, and the textbook's for comparison.

use firmware::pid::{Pid, PidState};
use serde::Serialize;

use super::gains::Gains;

/// What the integral does while the command is at its limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Windup {
    /// It grows until the command is at its limit and no further: the board's code.
    #[default]
    Board,
    /// It stands still while the command is cut and the error pushes outward: the textbook's rule, which does not run on the board.
    Frozen,
}

/// More than any plant is commanded, V: a controller without a limit.
const NO_LIMIT_V: f64 = 1e9;

/// A controller on its way.
#[derive(Debug, Clone)]
pub(super) enum Controller {
    /// `firmware::pid`, in f32 as on the board.
    Board(Pid, PidState),
    /// The textbook's.
    Frozen { gains: Gains, tick_s: f64, limit_v: f64, integral_v: f64, derivative_v: f64, before: f64 },
}

impl Controller {
    /// At rest.
    pub fn new(gains: &Gains, tick_s: f64, limit_v: Option<f64>, windup: Windup) -> Self {
        let limit_v = limit_v.unwrap_or(NO_LIMIT_V);
        match windup {
            Windup::Board => Self::Board(Pid::build(&gains.sent(), tick_s as f32, limit_v as f32), PidState::default()),
            Windup::Frozen => {
                Self::Frozen { gains: *gains, tick_s, limit_v, integral_v: 0.0, derivative_v: 0.0, before: 0.0 }
            }
        }
    }

    /// The command for an error, V.
    pub fn step(&mut self, error_mm: f64) -> f64 {
        match self {
            Self::Board(pid, state) => f64::from(pid.step(state, error_mm as f32)),
            Self::Frozen { gains, tick_s, limit_v, integral_v, derivative_v, before } => {
                let jump = gains.kd * gains.n * (error_mm - *before);
                *derivative_v = (*derivative_v + jump) / (1.0 + gains.n * *tick_s);
                *before = error_mm;
                let grown = *integral_v + gains.ki * *tick_s * error_mm;
                let wanted = gains.kp * error_mm + grown + *derivative_v;
                let outward = wanted.abs() > *limit_v && wanted * error_mm > 0.0;
                if !outward {
                    *integral_v = grown;
                }
                wanted.clamp(-*limit_v, *limit_v)
            }
        }
    }
}
