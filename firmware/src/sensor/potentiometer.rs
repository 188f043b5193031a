//! Potentiometer of the display's shaft: resistance is linear in length (ERRATA row Eq. 46).

use super::divider::{resistance_kohm, sensor_ratio};
use protocol::message::ResistiveSensor;

/// Shaft position, mm: `l = (R (V+/V_s - 1) - b) / a` (ERRATA row Eq. 46), valid 0 to 20 mm.
pub fn shaft_mm(ratio: f32, law: &ResistiveSensor) -> f32 {
    (resistance_kohm(ratio, law.divider_kohm) - law.offset) / law.slope
}

/// Reading for a position; the inverse of [`shaft_mm`].
pub fn potentiometer_ratio(shaft_mm: f32, law: &ResistiveSensor) -> f32 {
    sensor_ratio(law.slope * shaft_mm + law.offset, law.divider_kohm)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensor::DEFAULT_CALIBRATION;

    #[test]
    fn ends_of_the_stroke() {
        let law = DEFAULT_CALIBRATION.potentiometer;
        // Fig. 69 (ERRATA row Eq. 46): 2.5829 kOhm at 0 mm, 0.97732 kOhm at 20 mm.
        assert!(shaft_mm(sensor_ratio(2.5829, 1.6), &law).abs() < 1e-4);
        assert!((shaft_mm(sensor_ratio(0.977_32, 1.6), &law) - 20.0).abs() < 1e-4);
    }
}
