//! Force sensing resistor of the display (Interlink 400 series): conductance is linear in force.

use super::divider::{resistance_kohm, sensor_ratio};
use protocol::message::ResistiveSensor;

/// Unit of force in Eq. 43: 100 gf (ERRATA, Table 7).
pub const FSR_UNIT_N: f32 = 0.980_665;

/// Below this conductance nothing presses, mS. The data sheet gives more than 10 MOhm (0.1 uS) unloaded; Eq. 45 would
/// read 0.2 N there.
const UNLOADED_MS: f32 = 1e-3;

/// Conductance, mS, from a reading (Eq. 44).
pub fn fsr_conductance_ms(ratio: f32, law: &ResistiveSensor) -> f32 {
    1.0 / resistance_kohm(ratio, law.divider_kohm)
}

/// Force, N (ERRATA row Eq. 45): `F = 1 / ((V+/V_r - 1) R a) - b / a` in units of 100 gf, R in kOhm; 0 when
/// unloaded.
pub fn fsr_n(ratio: f32, law: &ResistiveSensor) -> f32 {
    let conductance_ms = fsr_conductance_ms(ratio, law);
    if conductance_ms < UNLOADED_MS {
        return 0.0;
    }
    let force_n = (conductance_ms - law.offset) / law.slope * FSR_UNIT_N;
    if force_n > 0.0 { force_n } else { 0.0 }
}

/// Least force that the sensor tells, N: what it reads of the first that it conducts. 0 where the law has no threshold.
pub fn least_n(law: &ResistiveSensor) -> f32 {
    let force_n = (UNLOADED_MS - law.offset) / law.slope * FSR_UNIT_N;
    if force_n > 0.0 { force_n } else { 0.0 }
}

/// Reading for a force; the inverse of [`fsr_n`]. Forces below the law's zero give no conductance.
pub fn fsr_ratio(force_n: f32, law: &ResistiveSensor) -> f32 {
    let conductance_ms = law.slope * force_n / FSR_UNIT_N + law.offset;
    if conductance_ms > 0.0 { sensor_ratio(1.0 / conductance_ms, law.divider_kohm) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensor::DEFAULT_CALIBRATION;

    /// Table 7: conductance in mS at 100, 200, ... 900 gf (ERRATA row Eq. 43).
    const TABLE_7_MS: [f32; 9] = [0.0733, 0.1518, 0.2151, 0.2603, 0.3589, 0.4611, 0.5314, 0.6217, 0.6774];

    #[test]
    fn every_point_of_table_7() {
        // The fit's residual deviation of 0.0173 mS is 0.22 units of 100 gf; the worst point (400 gf) lies 2 deviations off.
        let law = DEFAULT_CALIBRATION.fsr;
        for (i, ms) in TABLE_7_MS.into_iter().enumerate() {
            let units = (i + 1) as f32;
            let n = fsr_n(sensor_ratio(1.0 / ms, law.divider_kohm), &law);
            assert!((n - units * FSR_UNIT_N).abs() < 0.47 * FSR_UNIT_N, "{units}00 gf: {n} N");
        }
    }

    /// Just below the threshold nothing is read, just above it hardly more than it.
    #[test]
    fn the_threshold_is_the_least_that_is_read() {
        let law = DEFAULT_CALIBRATION.fsr;
        let least = least_n(&law);
        assert!((0.19..0.22).contains(&least), "{least}");
        assert_eq!(fsr_n(fsr_ratio(0.999 * least, &law), &law), 0.0);
        assert!((fsr_n(fsr_ratio(1.001 * least, &law), &law) - least).abs() < 1e-3);
        // a load cell's line has none
        assert!(least_n(&ResistiveSensor { offset: 0.0, ..law.clone() }) < 0.02);
        assert_eq!(least_n(&ResistiveSensor { offset: 0.1, ..law }), 0.0);
    }

    #[test]
    fn unloaded_reads_zero_not_two_tenths_of_a_newton() {
        let law = DEFAULT_CALIBRATION.fsr;
        assert_eq!(fsr_n(0.0, &law), 0.0);
        // Just above "unloaded" Eq. 45 gives -b/a = 0.2055 units.
        let n = fsr_n(sensor_ratio(900.0, law.divider_kohm), &law);
        assert!((n - (0.2055 + 0.0143) * FSR_UNIT_N).abs() < 2e-3, "{n}");
    }
}
