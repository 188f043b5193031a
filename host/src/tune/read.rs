//! Reads a continuous step from samples of error and command with their slopes.

use super::cubic::Cubic;
use super::step::{Extremes, HORIZON_S, Step};

/// The loop at a time.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Sample {
    /// Target less shaft, mm.
    pub error: f64,
    /// Its slope, mm/s.
    pub slope: f64,
    /// Command, V.
    pub command: f64,
    /// Its slope, V/s.
    pub command_slope: f64,
    /// Exact integral of the error over the step before, mm s; none where the cubic between the samples has to do.
    pub area: Option<f64>,
}

/// Cost and extremes so far.
#[derive(Debug, Default)]
pub(super) struct Reader {
    time: f64,
    last: Sample,
    cost: f64,
    extremes: Extremes,
    command: f64,
}

impl Reader {
    /// One sample at the end of a step; the first one has a step of 0.
    pub fn see(&mut self, time: f64, step: f64, now: Sample) {
        if step > 0.0 {
            let last = self.last;
            let error = Cubic::new((last.error, now.error), (step * last.slope, step * now.slope));
            let whole = now.area.unwrap_or_else(|| step * error.area(1.0));
            if last.error * now.error < 0.0 {
                let first = step * error.area(error.crossing());
                self.cost += first.abs() + (whole - first).abs();
            } else {
                self.cost += whole.abs();
            }
            if last.slope * now.slope <= 0.0 {
                error.flat().for_each(|x| self.extremes.see(error.at(x)));
            }
            if last.command_slope * now.command_slope <= 0.0 {
                let slopes = (step * last.command_slope, step * now.command_slope);
                let command = Cubic::new((last.command, now.command), slopes);
                command.flat().for_each(|x| self.command = self.command.max(command.at(x).abs()));
            }
        }
        self.extremes.see(now.error);
        self.command = self.command.max(now.command.abs());
        (self.time, self.last) = (time, now);
    }

    /// The step; what is left of the horizon keeps the last error.
    pub fn finish(self) -> Step {
        Step {
            cost: self.cost + self.last.error.abs() * (HORIZON_S - self.time).max(0.0),
            overshoot: self.extremes.overshoot,
            undershoot: self.extremes.undershoot,
            command: self.command,
        }
    }
}
