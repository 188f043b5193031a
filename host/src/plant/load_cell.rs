//! The load cell of the palpation probe with its amplifier.

/// A linear cell: its own sensitivity, not the one the board believes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoadCell {
    /// Output without force, fraction of the reference voltage.
    pub zero_ratio: f64,
    /// Sensitivity, N for the full reference voltage.
    pub n_per_ratio: f64,
}

impl LoadCell {
    /// Output under a force, fraction of the reference voltage.
    pub fn ratio(&self, force_n: f64) -> f64 {
        self.zero_ratio + force_n / self.n_per_ratio
    }
}
