//! The 1 kHz loop: oversampling for the 50 Hz loop, coil current regulation, over-current trip.
//!
//! If a step comes late the coil keeps its duty for that long: its current goes on towards what
//! that duty holds, at most what the hottest circuit needs for the target. If steps stop altogether
//! the watchdog resets the board, which opens all switches.

use crate::coil::expected::{Expected, ExpectedLaw};
use crate::coil::regulator::{CoilPi, CoilPiState};
use crate::coil::winding::CoilCircuit;
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
    /// Mean duty of the coil since the previous tick; the duty now if there was no step.
    pub coil_duty: f32,
}

/// Control ticks that the fast loop keeps the coil on without hearing from the control loop.
const PATIENCE_TICKS: u32 = 3;

/// State of the fast loop.
#[derive(Debug, Clone)]
pub struct FastLoop {
    law: ExpectedLaw,
    pi: CoilPi,
    shunt: CoilShunt,
    trip_a: f32,
    expected: Expected,
    state: CoilPiState,
    target_a: f32,
    duty: f32,
    duty_sum: f32,
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

/// Readings in a row with more current than the duties so far have made in the coldest circuit
/// ([`crate::coil::expected`] knows how slowly it falls).
const UNCOMMANDED_READINGS: u8 = 10;

/// Readings in a row with less. A supply may take its time; an open coil is no hazard.
const MISSING_READINGS: u8 = 100;

impl FastLoop {
    /// Coil off, nothing sampled.
    pub fn new(circuit: &CoilCircuit, shunt: &CoilShunt, trip_a: f32) -> Self {
        FastLoop {
            law: ExpectedLaw::build(circuit, 1.0 / FAST_HZ as f32),
            pi: CoilPi::build(circuit, 1.0 / FAST_HZ as f32),
            shunt: *shunt,
            trip_a,
            expected: Expected::default(),
            state: CoilPiState::default(),
            target_a: 0.0,
            duty: 0.0,
            duty_sum: 0.0,
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
        // What the duties until the last step give says whether switch and coil are sound, at any
        // target.
        self.duty_sum += self.duty;
        self.law.step(&mut self.expected, self.duty);
        let uncommanded = measured_a > self.expected.most_a + BESIDE_A;
        self.uncommanded = if uncommanded { self.uncommanded.saturating_add(1) } else { 0 };
        let missing = measured_a < self.expected.least_a - BESIDE_A;
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
        let mut coil_duty = self.duty;
        if self.count > 0 {
            coil_duty = self.duty_sum / f32::from(self.count);
            for (channel, sum) in channels.iter_mut().zip(self.sums) {
                *channel = sum / f32::from(self.count);
            }
        }
        let averaged = Averaged {
            raw: RawSamples::from_channels(channels),
            count: self.count,
            coil_trip: self.tripped,
            coil_duty,
        };
        self.sums = [0.0; 5];
        self.duty_sum = 0.0;
        self.count = 0;
        if self.tripped.take().is_some() {
            self.target_a = 0.0;
        }
        averaged
    }
}

#[cfg(test)]
mod tests;
