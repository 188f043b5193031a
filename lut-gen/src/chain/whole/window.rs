//! Readings that are means over a window of samples.

use super::Passage;
use super::path::between;

/// Samples that a reading is the mean of, evenly over a length of time.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Window {
    /// Samples times their distance (s).
    pub length_s: f64,
    /// Samples; up to 1 for an instant.
    pub samples: usize,
}

/// Readings that stand for a window of more samples.
const READINGS: usize = 8;

impl Window {
    /// Times (s) of its readings: those of the samples themselves where they are few, because next to a turn of the ball half a sample counts.
    pub(super) fn times_s(self, middle_s: f64) -> impl Iterator<Item = f64> {
        let count = self.samples.clamp(1, READINGS);
        (0..count).map(move |k| middle_s + self.length_s * ((k as f64 + 0.5) / count as f64 - 0.5))
    }

    pub(super) fn mean(self, curve: &[(f64, f64)], middle_s: f64) -> f64 {
        let count = self.samples.clamp(1, READINGS) as f64;
        self.times_s(middle_s).map(|t| between(curve, t)).sum::<f64>() / count
    }
}

impl Passage {
    /// The same motion with places for the readings of every window.
    pub(super) fn refined(&self, windows: &[Window]) -> Self {
        let path: Vec<(f64, f64)> = self.time_s.iter().copied().zip(self.depth_mm.iter().copied()).collect();
        let (first, last) = (self.time_s.first().copied().unwrap_or(0.0), self.time_s.last().copied().unwrap_or(0.0));
        let mut time_s = self.time_s.clone();
        for (t, window) in self.time_s.iter().zip(windows) {
            time_s.extend(window.times_s(*t).filter(|t| *t > first && *t < last));
        }
        time_s.sort_by(f64::total_cmp);
        time_s.dedup_by(|b, a| *b - *a < 1e-5);
        let depth_mm = time_s.iter().map(|t| between(&path, *t)).collect();
        Self { time_s, depth_mm, ..self.clone() }
    }
}
