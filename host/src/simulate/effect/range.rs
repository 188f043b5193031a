//! A quantity that differs from run to run, as a part of its range within the experiment.

/// The least and the largest value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Range {
    low: f64,
    high: f64,
}

impl Range {
    /// Of all values.
    pub fn of(values: impl Iterator<Item = f64>) -> Self {
        let none = Self { low: f64::INFINITY, high: f64::NEG_INFINITY };
        values.fold(none, |range, x| Self { low: x.min(range.low), high: x.max(range.high) })
    }

    /// Place of a value, evenly in its logarithm: 0 at the low end, 1 at the high one; 0 where all
    /// are equal.
    pub fn part(self, x: f64) -> f64 {
        if self.high > self.low { (x / self.low).ln() / (self.high / self.low).ln() } else { 0.0 }
    }
}
