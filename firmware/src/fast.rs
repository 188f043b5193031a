//! The 1 kHz loop: oversampling for the 50 Hz loop, coil current regulation, over-current trip.
//!
//! If a step comes late the coil keeps its duty for that long; its current then moves by at most a few percent a millisecond. If steps
//! stop altogether the watchdog resets the board, which opens all switches.

use crate::coil::regulator::{CoilCircuit, CoilPi, CoilPiState};
use crate::sensor::{CoilShunt, RawSamples, at_rail, coil_a};

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
    /// The over-current trip has acted since the previous tick.
    pub coil_tripped: bool,
    /// Duty of the coil now.
    pub coil_duty: f32,
}

/// Control ticks that the fast loop keeps the coil on without hearing from the control loop.
const PATIENCE_TICKS: u32 = 3;

/// State of the fast loop.
#[derive(Debug, Clone)]
pub struct FastLoop {
    pi: CoilPi,
    shunt: CoilShunt,
    trip_a: f32,
    state: CoilPiState,
    target_a: f32,
    duty: f32,
    sums: [f32; 5],
    count: u16,
    above: u8,
    tripped: bool,
    last: RawSamples,
}

/// Readings in a row above the trip current that trip: one may be a spike.
const TRIP_READINGS: u8 = 3;

impl FastLoop {
    /// Coil off, nothing sampled.
    pub fn new(circuit: &CoilCircuit, shunt: &CoilShunt, trip_a: f32) -> Self {
        FastLoop {
            pi: CoilPi::build(circuit, 1.0 / FAST_HZ as f32),
            shunt: *shunt,
            trip_a,
            state: CoilPiState::default(),
            target_a: 0.0,
            duty: 0.0,
            sums: [0.0; 5],
            count: 0,
            above: 0,
            tripped: false,
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
        if self.above >= TRIP_READINGS {
            self.tripped = true;
        }
        // A control loop that has not come for its readings cannot be trusted to switch the coil off.
        let deserted = u32::from(self.count) > PATIENCE_TICKS * FAST_STEPS;
        let target_a = if self.tripped || deserted { 0.0 } else { self.target_a };
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
            coil_tripped: self.tripped,
            coil_duty: self.duty,
        };
        self.sums = [0.0; 5];
        self.count = 0;
        if self.tripped {
            self.target_a = 0.0;
            self.tripped = false;
        }
        averaged
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensor::coil_ratio;

    fn fast() -> FastLoop {
        FastLoop::new(&CoilCircuit::default(), &CoilShunt::default(), 2.875)
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
        assert!(fast.take().coil_tripped);
        assert_eq!(fast.step(&raw(0.5)), 0.0);
        assert!(!fast.take().coil_tripped);
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
            assert!(fast.take().coil_tripped);
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
