//! The 1 kHz loop: oversampling for the 50 Hz loop, coil current regulation, over-current trip.
//!
//! If a step comes late the coil keeps its duty for that long; its current then moves by at most a few percent a millisecond. If steps
//! stop altogether the watchdog resets the board, which opens all switches.

use crate::coil::regulator::{CoilCircuit, CoilPi, CoilPiState};
use crate::sensor::{CoilShunt, RawSamples, at_rail, coil_a};
use protocol::fault::Fault;

/// Steps a second.
pub const FAST_HZ: u32 = 1000;

/// Steps a control tick.
pub const FAST_STEPS: u32 = FAST_HZ / protocol::TICK_HZ;

/// Mean readings since the previous tick.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Averaged {
    /// Mean of the readings; the previous one if there were none.
    pub raw: RawSamples,
    /// Number of readings in the mean.
    pub count: u16,
    /// Why the coil was switched off since the previous tick.
    pub coil_trip: Option<Fault>,
    /// Duty of the coil now.
    pub coil_duty: f32,
}

/// Control ticks that the fast loop keeps the coil on without hearing from the control loop.
const PATIENCE_TICKS: u32 = 3;

/// State of the fast loop.
#[derive(Debug, Clone)]
pub struct FastLoop {
    circuit: CoilCircuit,
    pi: CoilPi,
    shunt: CoilShunt,
    trip_a: f32,
    state: CoilPiState,
    target_a: f32,
    duty: f32,
    sums: [f32; 5],
    count: u16,
    above: u8,
    uncommanded: u8,
    missing: u8,
    tripped: Option<Fault>,
    last: RawSamples,
}

/// Readings in a row above the trip current that trip: one may be a spike.
const TRIP_READINGS: u8 = 3;

/// Current beside what the duty gives, A: nine hundredths of the amplifier's range, for its zero and gain.
const BESIDE_A: f32 = 0.3;

/// Readings in a row with more current than the duty gives. The current follows a duty within L/R = 0.23 ms and is read as the mean of a
/// millisecond: two readings may still have the one before.
const UNCOMMANDED_READINGS: u8 = 10;

/// Readings in a row with less. A supply may take its time; an open coil is no hazard.
const MISSING_READINGS: u8 = 100;

impl FastLoop {
    /// Coil off, nothing sampled.
    pub fn new(circuit: &CoilCircuit, shunt: &CoilShunt, trip_a: f32) -> Self {
        FastLoop {
            circuit: *circuit,
            pi: CoilPi::build(circuit, 1.0 / FAST_HZ as f32),
            shunt: *shunt,
            trip_a,
            state: CoilPiState::default(),
            target_a: 0.0,
            duty: 0.0,
            sums: [0.0; 5],
            count: 0,
            above: 0,
            uncommanded: 0,
            missing: 0,
            tripped: None,
            last: RawSamples::default(),
        }
    }

    /// Desired coil current until the next call, A; 0 switches the coil off.
    pub fn set_target_a(&mut self, target_a: f32) {
        self.target_a = target_a;
    }

    /// One step; returns the duty of the coil, 0 to 1.
    pub fn step(&mut self, raw: &RawSamples) -> f32 {
        for (sum, reading) in self.sums.iter_mut().zip(raw.channels()) {
            *sum += reading;
        }
        self.count = self.count.saturating_add(1);
        self.last = *raw;
        let measured_a = coil_a(raw.coil_current, &self.shunt);
        // A reading at a rail, or one that is not a number, says nothing about the current: as bad as too much of it.
        let too_much = at_rail(raw.coil_current) || measured_a > self.trip_a;
        self.above = if too_much { self.above.saturating_add(1) } else { 0 };
        // What the duty of the last step gives says whether switch and coil are sound, at any target.
        let (least_a, most_a) = self.circuit.current_a(self.duty);
        let uncommanded = measured_a > most_a + BESIDE_A;
        self.uncommanded = if uncommanded { self.uncommanded.saturating_add(1) } else { 0 };
        let missing = measured_a < least_a - BESIDE_A;
        self.missing = if missing { self.missing.saturating_add(1) } else { 0 };
        if self.above >= TRIP_READINGS {
            self.tripped = Some(Fault::CurrentLimit);
        } else if self.uncommanded >= UNCOMMANDED_READINGS {
            self.tripped = Some(Fault::CoilUncommanded);
        } else if self.missing >= MISSING_READINGS {
            self.tripped = Some(Fault::CoilOpen);
        }
        // A control loop that has not come for its readings cannot be trusted to switch the coil off.
        let deserted = u32::from(self.count) > PATIENCE_TICKS * FAST_STEPS;
        let target_a = if self.tripped.is_some() || deserted { 0.0 } else { self.target_a };
        self.duty = self.pi.step(&mut self.state, target_a, measured_a);
        self.duty
    }

    /// Mean readings for the control tick; starts the next mean. A trip is reported once and then re-armed: the latched fault
    /// of the control loop keeps the target at 0.
    pub fn take(&mut self) -> Averaged {
        let mut channels = self.last.channels();
        if self.count > 0 {
            for (channel, sum) in channels.iter_mut().zip(self.sums) {
                *channel = sum / f32::from(self.count);
            }
        }
        let averaged = Averaged {
            raw: RawSamples::from_channels(channels),
            count: self.count,
            coil_trip: self.tripped,
            coil_duty: self.duty,
        };
        self.sums = [0.0; 5];
        self.count = 0;
        if self.tripped.take().is_some() {
            self.target_a = 0.0;
        }
        averaged
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensor::coil_ratio;

    fn fast() -> FastLoop {
        FastLoop::new(&CoilCircuit::default(), &CoilShunt::default(), 2.7)
    }

    fn raw(coil_a: f32) -> RawSamples {
        RawSamples { coil_current: coil_ratio(coil_a, &CoilShunt::default()), fsr: 0.25, ..RawSamples::default() }
    }

    #[test]
    fn readings_are_averaged_between_ticks() {
        let mut fast = fast();
        for fsr in [0.1, 0.2, 0.6] {
            fast.step(&RawSamples { fsr, ..raw(0.0) });
        }
        let averaged = fast.take();
        assert_eq!(averaged.count, 3);
        // f32 rounding of a sum of three.
        assert!((averaged.raw.fsr - 0.3).abs() < 1e-6);
        // Nothing new: the last reading, and a count that says so.
        let stale = fast.take();
        assert_eq!((stale.count, stale.raw.fsr), (0, 0.6));
    }

    #[test]
    fn over_current_switches_off_in_three_milliseconds_and_is_told() {
        let mut fast = fast();
        fast.set_target_a(2.5);
        assert!(fast.step(&raw(1.0)) > 0.0);
        // A spike of two readings passes.
        assert!((0..2).all(|_| fast.step(&raw(3.0)) >= 0.0));
        assert!(fast.step(&raw(1.0)) > 0.0);
        let duties = [0, 1, 2].map(|_| fast.step(&raw(3.0)));
        assert_eq!(duties[2], 0.0);
        assert_eq!(fast.step(&raw(0.5)), 0.0);
        assert_eq!(fast.take().coil_trip, Some(Fault::CurrentLimit));
        assert_eq!(fast.step(&raw(0.5)), 0.0);
        assert_eq!(fast.take().coil_trip, None);
    }

    #[test]
    fn a_dead_amplifier_and_a_reading_that_is_not_a_number_trip() {
        for coil_current in [0.0, 1.0, f32::NAN] {
            let mut fast = fast();
            fast.set_target_a(1.0);
            for _ in 0..3 {
                fast.step(&RawSamples { coil_current, ..raw(0.0) });
            }
            assert_eq!(fast.step(&raw(0.5)), 0.0);
            assert_eq!(fast.take().coil_trip, Some(Fault::CurrentLimit));
        }
    }

    /// A coil of `ohm` at the supply, under the loop, with the switch or the amplifier as `spoil` has them (current, duty to
    /// applied duty and reading); the fault within `ms`, and when.
    fn driven(
        ohm: f32,
        target_a: f32,
        ms: u32,
        spoil: impl Fn(f32, u32) -> (f32, Option<f32>),
    ) -> Option<(Fault, u32)> {
        let (mut fast, mut current_a) = (fast(), 0.0f32);
        let circuit = CoilCircuit::default();
        for i in 0..ms {
            fast.set_target_a(target_a);
            let (applied, reading_a) = spoil(fast.duty, i);
            let rest_a = applied * circuit.supply_v / ohm;
            current_a = rest_a + (current_a - rest_a) * (-ohm / circuit.inductance_mh).exp();
            fast.step(&raw(reading_a.unwrap_or(current_a)));
            if let Some(fault) = fast.tripped {
                return Some((fault, i));
            }
            if i % FAST_STEPS == 19 {
                fast.take();
            }
        }
        None
    }

    #[test]
    fn sound_coils_from_cold_to_hot_never_trip_at_any_target_or_step() {
        for ohm in [12.0, 13.0, 16.0, 17.3] {
            for targets in [[2.5, 0.1], [0.1, 2.5], [2.5, 0.0], [1.0, 1.0]] {
                let mut current_a = 0.0f32;
                let mut fast = fast();
                for i in 0..4000 {
                    fast.set_target_a(targets[i / 200 % 2]);
                    // The board's reading is the mean over the step, which has some of the current before.
                    let rest_a = fast.duty * 36.0 / ohm;
                    let next_a = rest_a + (current_a - rest_a) * (-ohm / 3.0f32).exp();
                    fast.step(&raw(0.5 * (current_a + next_a)));
                    current_a = next_a;
                    assert_eq!(fast.tripped, None, "{ohm} ohm {targets:?} step {i}");
                    if i % 20 == 19 {
                        fast.take();
                    }
                }
            }
        }
    }

    /// 36 V over 17.3 ohm are 2.08 A, which no over-current trip of 2.7 A sees.
    #[test]
    fn a_switch_that_does_not_open_is_told_in_twenty_milliseconds_hot_or_cold() {
        for ohm in [13.0, 17.3] {
            for target_a in [0.0, 0.5, 1.0, 1.5] {
                let found = driven(ohm, target_a, 200, |duty, ms| (if ms < 50 { duty } else { 1.0 }, None));
                let by = if ohm < 14.0 {
                    [Fault::CoilUncommanded, Fault::CurrentLimit]
                } else {
                    [Fault::CoilUncommanded; 2]
                };
                assert!(found.is_some_and(|(f, ms)| by.contains(&f) && ms <= 70), "{ohm} ohm, {target_a} A: {found:?}");
            }
        }
    }

    #[test]
    fn an_open_coil_and_a_missing_supply_are_told_in_a_fifth_of_a_second() {
        let found = driven(13.0, 2.0, 400, |_, _| (0.0, None));
        assert!(found.is_some_and(|(f, ms)| f == Fault::CoilOpen && ms < 200), "{found:?}");
    }

    /// An amplifier whose wire is off reads what it last read, or less: the duty stays below what the hottest coil needs for the target.
    #[test]
    fn a_reading_that_stands_does_not_drive_the_coil_beyond_what_a_hot_one_needs() {
        for target_a in [0.3, 0.6, 1.0] {
            let mut fast = fast();
            let mut most = 0.0f32;
            for i in 0..80 {
                fast.set_target_a(target_a);
                most = most.max(fast.step(&raw(0.5 * target_a)));
                if i % 20 == 19 {
                    fast.take();
                }
            }
            assert!(most <= 1.65 * 13.0 / 36.0 * target_a + 1e-6, "{target_a} A: {most}");
        }
    }

    #[test]
    fn a_control_loop_that_does_not_come_switches_the_coil_off() {
        let mut fast = fast();
        fast.set_target_a(1.0);
        let off = (0..200).position(|_| fast.step(&raw(0.5)) == 0.0);
        // 60 steps are tolerated.
        assert_eq!(off, Some(60));
        fast.take();
        assert!(fast.step(&raw(0.5)) > 0.0);
    }
}
