//! From fractions of the reference voltage ("ratios", 0 to 1) to N, mm and A, and back.
//!
//! Supply of the dividers and reference of the converter are the same 3.3 V, so ratios need no voltage.
//! The inverse of every law stands beside it: the simulated board and the tests make readings with it.

mod coil_current;
mod divider;
mod fsr;
mod load_cell;
mod potentiometer;
mod probe;

pub use coil_current::{CoilShunt, coil_a, coil_ratio};
pub use divider::{resistance_kohm, sensor_ratio};
pub use fsr::{FSR_UNIT_N, fsr_conductance_ms, fsr_n, fsr_ratio, least_n};
pub use load_cell::{load_cell_n, load_cell_ratio, tared};
pub use potentiometer::{potentiometer_ratio, shaft_mm};
pub use probe::{probe_mm, probe_ratio};

use protocol::message::{Calibration, Fitted, LoadCell, ProbePosition, Raw, ResistiveSensor};

/// One oversampled reading of every channel, as fractions of the reference voltage, 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RawSamples {
    /// Load cell of the palpation probe.
    pub load_cell: f32,
    /// Force sensing resistor of the display.
    pub fsr: f32,
    /// Potentiometer of the display's shaft.
    pub potentiometer: f32,
    /// Position transducer of the palpation probe.
    pub probe_position: f32,
    /// Shunt amplifier of the coil.
    pub coil_current: f32,
}

impl RawSamples {
    /// The channels in the order of their conversion.
    pub const fn channels(&self) -> [f32; 5] {
        [self.load_cell, self.fsr, self.potentiometer, self.probe_position, self.coil_current]
    }

    /// Readings from channels in the order of [`RawSamples::channels`].
    pub const fn from_channels(channels: [f32; 5]) -> Self {
        let [load_cell, fsr, potentiometer, probe_position, coil_current] = channels;
        RawSamples { load_cell, fsr, potentiometer, probe_position, coil_current }
    }
}

/// Readings as they travel: 65,535ths of the reference voltage, 0 for what is no number.
impl From<&RawSamples> for Raw {
    fn from(raw: &RawSamples) -> Self {
        let [load_cell, fsr, potentiometer, probe_position, coil_current] =
            // The cast keeps to the range, and makes 0 of a NaN.
            raw.channels().map(|ratio| (ratio * 65_535.0 + 0.5) as u16);
        Raw { load_cell, fsr, potentiometer, probe_position, coil_current }
    }
}

/// What the board believes about its surroundings in one tick.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Measured {
    /// Load cell, N, positive when the probe is pressed.
    pub load_cell_n: f32,
    /// FSR of the display, N; 0 when nothing presses.
    pub fsr_n: f32,
    /// Shaft of the display, mm, 0 at rest and rising when pressed in.
    pub shaft_mm: f32,
    /// Height of the ball's lowest point above the base plate, mm.
    pub probe_mm: f32,
    /// Coil current, A.
    pub coil_a: f32,
}

impl Measured {
    /// Converts one reading with a calibration.
    pub fn from_raw(raw: &RawSamples, calibration: &Calibration, shunt: &CoilShunt) -> Self {
        Measured {
            load_cell_n: load_cell_n(raw.load_cell, &calibration.load_cell),
            fsr_n: fsr_n(raw.fsr, &calibration.fsr),
            shaft_mm: shaft_mm(raw.potentiometer, &calibration.potentiometer),
            probe_mm: probe_mm(raw.probe_position, &calibration.probe),
            coil_a: coil_a(raw.coil_current, shunt),
        }
    }

    /// The same with what is not fitted read as 0.
    #[must_use]
    pub fn fitted(self, fitted: &Fitted) -> Self {
        let kept = |x: f32, is_fitted: bool| if is_fitted { x } else { 0.0 };
        Measured {
            load_cell_n: kept(self.load_cell_n, fitted.palpator),
            fsr_n: kept(self.fsr_n, fitted.actuator || fitted.coil),
            shaft_mm: kept(self.shaft_mm, fitted.actuator),
            probe_mm: kept(self.probe_mm, fitted.palpator),
            coil_a: kept(self.coil_a, fitted.coil),
        }
    }

    /// True if every quantity is a number.
    pub fn is_finite(&self) -> bool {
        [self.load_cell_n, self.fsr_n, self.shaft_mm, self.probe_mm, self.coil_a].iter().all(|x| x.is_finite())
    }
}

/// Readings below this, or above 1 minus this, are at a rail: the sensor is open or shorted.
/// 1 % of the reference (33 mV) is beyond offset and noise of any channel.
pub const RAIL_RATIO: f32 = 0.01;

/// True if a reading lies at either rail, or is not a number.
pub fn at_rail(ratio: f32) -> bool {
    !(ratio > RAIL_RATIO && ratio < 1.0 - RAIL_RATIO)
}

/// The calibration a board starts with until one is stored.
///
/// Load cell (assumed 10 N cell with bridge amplifier): -1 to 9 N. FSR: Eq. 43 by least squares over Table 7 (ERRATA row
/// Eq. 43: mS and units of 100 gf; the thesis rounds to 0.079 and -0.016), 10 kOhm.
/// Potentiometer: Eq. 46 (ERRATA: linear in resistance) with the 1.6 kOhm divider of the 3.3 V board.
/// Probe position (assumed 100 mm transducer): -10 to 90 mm.
pub const DEFAULT_CALIBRATION: Calibration = Calibration {
    load_cell: LoadCell { zero_ratio: 0.1, n_per_ratio: 10.0 },
    fsr: ResistiveSensor { slope: 0.077_66, offset: -0.015_96, divider_kohm: 10.0 },
    potentiometer: ResistiveSensor { slope: -0.080_279, offset: 2.5829, divider_kohm: 1.6 },
    probe: ProbePosition { zero_ratio: 0.1, mm_per_ratio: 100.0 },
};

/// The whole board of `docs/board.md`.
pub const ALL_FITTED: Fitted = Fitted { palpator: true, actuator: true, coil: true };

/// True if a calibration can be used: every number finite, and near enough to the default that the limits of [`crate::safety`], which are
/// compared in N and mm, keep their meaning whatever a host sends.
///
/// Sensitivities and dividers may be half to double the default's, with its sign; the load cell's zero may move as far as 8 N can
/// still be read.
pub fn calibration_is_usable(c: &Calibration) -> bool {
    let d = &DEFAULT_CALIBRATION;
    let sensitivities = [
        (c.load_cell.n_per_ratio, d.load_cell.n_per_ratio),
        (c.fsr.slope, d.fsr.slope),
        (c.fsr.divider_kohm, d.fsr.divider_kohm),
        (c.potentiometer.slope, d.potentiometer.slope),
        (c.potentiometer.offset, d.potentiometer.offset),
        (c.potentiometer.divider_kohm, d.potentiometer.divider_kohm),
        (c.probe.mm_per_ratio, d.probe.mm_per_ratio),
    ];
    // Comparisons with NaN are false, and an infinite value fails the upper bound.
    let near = |x: f32, default: f32, by: f32| x >= default - by && x <= default + by;
    sensitivities.iter().all(|(x, default)| x / default >= 0.5 && x / default <= 2.0)
        && near(c.load_cell.zero_ratio, d.load_cell.zero_ratio, 0.08)
        && near(c.probe.zero_ratio, d.probe.zero_ratio, 0.1)
        && near(c.fsr.offset, d.fsr.offset, 0.05)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_default_calibration_is_usable_and_a_zero_slope_is_not() {
        assert!(calibration_is_usable(&DEFAULT_CALIBRATION));
        let mut broken = DEFAULT_CALIBRATION;
        broken.potentiometer.slope = 0.0;
        assert!(!calibration_is_usable(&broken));
        broken = DEFAULT_CALIBRATION;
        broken.probe.mm_per_ratio = f32::NAN;
        assert!(!calibration_is_usable(&broken));
    }

    /// Limits are compared in N, mm and kOhm: a calibration that would keep them from ever acting is refused.
    #[test]
    fn no_calibration_can_put_a_limit_out_of_reach() {
        let with = |change: fn(&mut Calibration)| {
            let mut c = DEFAULT_CALIBRATION;
            change(&mut c);
            calibration_is_usable(&c)
        };
        assert!(with(|c| c.load_cell.n_per_ratio = 12.0), "another cell");
        assert!(!with(|c| c.load_cell.n_per_ratio = 0.001), "8 N never read");
        assert!(!with(|c| c.load_cell.n_per_ratio = -10.0), "pressing reads as pulling");
        assert!(!with(|c| c.load_cell.zero_ratio = 0.85), "8 N beyond the rail");
        assert!(!with(|c| c.potentiometer.slope = -1e30), "the shaft never moves");
        assert!(!with(|c| c.fsr.divider_kohm = 1e9), "a short is never seen");
        assert!(!with(|c| c.probe.mm_per_ratio = -100.0), "the probe rises as it falls");
        assert!(!with(|c| c.fsr.offset = f32::INFINITY));
    }

    /// Half to double the default's sensitivities, and zeros as near as the limits can bear.
    #[test]
    fn every_number_of_a_calibration_is_bounded() {
        type Number = fn(&mut Calibration) -> &mut f32;
        let usable = |number: Number, x: f32| {
            let mut c = DEFAULT_CALIBRATION;
            *number(&mut c) = x;
            calibration_is_usable(&c)
        };
        let sensitivities: [Number; 7] = [
            |c| &mut c.load_cell.n_per_ratio,
            |c| &mut c.fsr.slope,
            |c| &mut c.fsr.divider_kohm,
            |c| &mut c.potentiometer.slope,
            |c| &mut c.potentiometer.offset,
            |c| &mut c.potentiometer.divider_kohm,
            |c| &mut c.probe.mm_per_ratio,
        ];
        for (i, number) in sensitivities.into_iter().enumerate() {
            let own = *number(&mut DEFAULT_CALIBRATION.clone());
            for by in [0.51, 1.99] {
                assert!(usable(number, by * own), "{i}: {by}");
            }
            for by in [0.49, 2.01, -1.0, 0.0, f32::NAN, f32::INFINITY] {
                assert!(!usable(number, by * own), "{i}: {by}");
            }
        }
        let zeros: [(Number, f32); 3] = [
            (|c| &mut c.load_cell.zero_ratio, 0.08),
            (|c| &mut c.probe.zero_ratio, 0.1),
            (|c| &mut c.fsr.offset, 0.05),
        ];
        for (i, (number, by)) in zeros.into_iter().enumerate() {
            let own = *number(&mut DEFAULT_CALIBRATION.clone());
            assert!(usable(number, own + 0.99 * by) && usable(number, own - 0.99 * by), "{i}");
            for off in [1.01 * by, -1.01 * by, f32::NAN, f32::INFINITY] {
                assert!(!usable(number, own + off), "{i}: {off}");
            }
        }
    }

    #[test]
    fn rails_and_nan_are_at_the_rail() {
        for ratio in [0.0, 0.005, 0.995, 1.0, f32::NAN] {
            assert!(at_rail(ratio), "{ratio}");
        }
        assert!(!at_rail(0.5));
    }

    proptest! {
        /// Readings made with the inverse laws convert back: f32 keeps 7 digits, the divider law loses up to two.
        #[test]
        fn conversion_round_trips(force in 0.0f32..8.0, pressed in 0.5f32..9.0, shaft in 0.0f32..20.0, probe in 0.0f32..80.0, amps in 0.0f32..3.0) {
            let c = DEFAULT_CALIBRATION;
            let shunt = CoilShunt::default();
            let raw = RawSamples {
                load_cell: load_cell_ratio(force, &c.load_cell),
                fsr: fsr_ratio(pressed, &c.fsr),
                potentiometer: potentiometer_ratio(shaft, &c.potentiometer),
                probe_position: probe_ratio(probe, &c.probe),
                coil_current: coil_ratio(amps, &shunt),
            };
            prop_assert_eq!(RawSamples::from_channels(raw.channels()), raw);
            let m = Measured::from_raw(&raw, &c, &shunt);
            prop_assert!((m.load_cell_n - force).abs() < 1e-5);
            prop_assert!((m.fsr_n - pressed).abs() < 1e-4);
            prop_assert!((m.shaft_mm - shaft).abs() < 1e-4);
            prop_assert!((m.probe_mm - probe).abs() < 1e-4);
            prop_assert!((m.coil_a - amps).abs() < 1e-5);
        }

        /// No reading, however absurd, gives a quantity that is not a number.
        #[test]
        fn finite_readings_give_finite_quantities(ratios in proptest::array::uniform5(-10.0f32..10.0)) {
            let m = Measured::from_raw(&RawSamples::from_channels(ratios), &DEFAULT_CALIBRATION, &CoilShunt::default());
            prop_assert!(m.is_finite());
        }
    }
}
