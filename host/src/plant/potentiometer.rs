//! The potentiometer inside the display's actuator.

/// Resistance falls linearly with the shaft's length: r = a l + b (thesis Eq. 46 as ERRATA reads it).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Potentiometer {
    /// Slope, kOhm/mm.
    pub slope_kohm_mm: f64,
    /// Resistance of the shaft at zero, kOhm.
    pub offset_kohm: f64,
    /// Fixed resistor of the divider, kOhm.
    pub divider_kohm: f64,
}

impl Potentiometer {
    /// Voltage over the fixed resistor, fraction of the reference.
    pub fn ratio(&self, shaft_mm: f64) -> f64 {
        let r = (self.slope_kohm_mm * shaft_mm + self.offset_kohm).max(0.0);
        self.divider_kohm / (self.divider_kohm + r)
    }
}
