//! The ratiometric divider of Eq. 44: sensor from V+ to the tap, fixed resistor from the tap to ground.

use crate::number::limit;

/// Ratios closer to 0 or 1 than this (one count of the 12-bit converter) are taken there, so that
/// no resistance is infinite or negative.
const EDGE: f32 = 1.0 / 4096.0;

/// Resistance of the sensor, kOhm, from the reading `V_r / V+` across the fixed resistor (Eq. 44):
/// `r = (V+ / V_r - 1) R`.
pub fn resistance_kohm(ratio: f32, divider_kohm: f32) -> f32 {
    let ratio = limit(ratio, EDGE, 1.0 - EDGE);
    (1.0 / ratio - 1.0) * divider_kohm
}

/// Reading for a resistance; the inverse of [`resistance_kohm`].
pub fn sensor_ratio(resistance_kohm: f32, divider_kohm: f32) -> f32 {
    divider_kohm / (divider_kohm + resistance_kohm)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_resistors_halve_the_supply() {
        assert_eq!(resistance_kohm(0.5, 10.0), 10.0);
        assert_eq!(sensor_ratio(10.0, 10.0), 0.5);
    }

    #[test]
    fn edges_stay_finite_and_positive() {
        for ratio in [-1.0, 0.0, 1.0, 2.0, f32::NAN] {
            let r = resistance_kohm(ratio, 1.6);
            assert!(r.is_finite() && r > 0.0, "{ratio}: {r}");
        }
    }
}
