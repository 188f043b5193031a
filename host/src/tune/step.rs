//! A unit step of the loop, and what is read of it.

use serde::Serialize;

/// What is read of a step response; lengths for a step of 1 mm.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Step {
    /// Integral of the absolute error over 100 s (Eq. 53), mm s; of a sampled loop the sum over ticks times the tick (Eq. 54).
    pub cost: f64,
    /// How far the shaft goes beyond the target, mm.
    pub overshoot: f64,
    /// How far it falls back below the target after it was reached first, mm.
    pub undershoot: f64,
    /// Largest absolute command, V.
    pub command: f64,
}

/// What is read at the ticks of a sampled loop alone, mm.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct AtTicks {
    /// As [`Step::overshoot`].
    pub overshoot: f64,
    /// As [`Step::undershoot`].
    pub undershoot: f64,
}

/// Length of Eq. 53, s.
pub const HORIZON_S: f64 = 100.0;

/// What a loop that is not stable is given: large numbers that fall towards stability, so that a search finds back.
pub(super) fn unstable(growth: f64) -> Step {
    let far = 1.0 + growth.clamp(0.0, 1e3);
    Step { cost: HORIZON_S * far, overshoot: 10.0 * far, undershoot: 10.0 * far, command: 100.0 * far }
}

/// Reads overshoot and undershoot from shaft positions in their order.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Extremes {
    reached: bool,
    /// As [`Step::overshoot`].
    pub overshoot: f64,
    /// As [`Step::undershoot`].
    pub undershoot: f64,
}

impl Extremes {
    /// One position by its error, target less shaft.
    pub fn see(&mut self, error: f64) {
        self.reached |= error <= 0.0;
        self.overshoot = self.overshoot.max(-error);
        if self.reached {
            self.undershoot = self.undershoot.max(error);
        }
    }
}
