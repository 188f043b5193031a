//! The position transducer of the probe.

/// A linear transducer of the height of the ball's lowest point above the base plate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transducer {
    /// Output with the ball on the base plate, fraction of the reference voltage.
    pub zero_ratio: f64,
    /// Sensitivity, mm for the full reference voltage.
    pub mm_per_ratio: f64,
}

impl Transducer {
    /// Output at a height, fraction of the reference voltage.
    pub fn ratio(&self, position_mm: f64) -> f64 {
        self.zero_ratio + position_mm / self.mm_per_ratio
    }
}
