//! The board as one object: a talk for each link, and the machine behind them.
//!
//! The image feeds it from embassy tasks, the host's simulated board from a plant; both run this very code.
//! A control tick is [`Board::tick`] with the readings of [`crate::fast::FastLoop::take`]; bytes of a link go in by [`Board::receive`] and
//! come out by [`Board::take_transmit`] at any time between ticks.
//!
//! # Two halves
//! In the same tick load cell and probe feed the palpation half, FSR and shaft the display half
//! ([`crate::mode`]). Limits, faults, lease and interlock are of the board.
//!
//! # Links and owners
//! Each link has its own decoder, queue, schema and telemetry. The link that asks for a motion holds it by a
//! lease, which only its own requests renew; the other one may stop it, but not change it.
//!
//! # Deadline
//! A tick has 20 ms. One that takes longer, or begins late, is counted, and latched as a fault if outputs are on, because
//! controller and search assume 20 ms between samples. Ticks do not pile up.

mod halves;
mod lease;
mod machine;
mod press;
mod requests;
mod talk;

use crate::config::BoardConfig;
use crate::fast::Averaged;
use crate::flash::{CalibrationStore, TableStore};
use crate::interlock::{Power, Trip};
use crate::link::{LinkId, Priority};
use crate::sensor::{Measured, RawSamples};
use protocol::fault::Fault;
use protocol::lut::Table;
use protocol::message::{Build, LastRun, Report, ResetCause, State};

pub use lease::LEASE_MS;
use machine::Machine;
use talk::Talk;

/// What a control tick gets.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Inputs {
    /// Mean readings since the previous tick, fractions of the reference voltage.
    pub raw: RawSamples,
    /// False if there was no new reading since the previous tick; `raw` is then not used.
    pub fresh: bool,
    /// The converter's ring overran since the previous tick.
    pub adc_overrun: bool,
    /// Why the fast loop has switched the coil off since the previous tick.
    pub coil_trip: Option<Fault>,
    /// Mean duty of the coil since the previous tick: what heats it in the thermal model; for
    /// telemetry.
    pub coil_duty: f32,
    /// Measured duration of the previous tick, us.
    pub tick_us: u16,
    /// Measured time from the start of the previous tick to the start of this one, us.
    pub period_us: u32,
    /// The stop button is pressed.
    pub stop_pressed: bool,
    /// The interlock has ended or refused a permit since the board rested.
    pub interlock: Option<Trip>,
}

impl Inputs {
    /// Inputs from the fast loop's mean.
    pub const fn from_fast(averaged: &Averaged, adc_overrun: bool, tick_us: u16) -> Self {
        Inputs {
            raw: averaged.raw,
            fresh: averaged.count > 0,
            adc_overrun,
            coil_trip: averaged.coil_trip,
            coil_duty: averaged.coil_duty,
            tick_us,
            period_us: 0,
            stop_pressed: false,
            interlock: None,
        }
    }
}

/// What a control tick wants. `Default` is everything off.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Outputs {
    /// Which outputs may be on at all: what the interlock is asked for.
    pub power: Power,
    /// Command of the display's actuator, V, positive pulls the cap in; to the H-bridge as duty over its supply.
    pub actuator_v: f32,
    /// Desired coil current, A, for the fast loop.
    pub coil_target_a: f32,
    /// Duty that holds this current in a cold coil, 0 to 1: for a board without fast loop.
    pub coil_duty: f32,
    /// The palpation arm presses at `arm_rate_mm_s` while true, and returns to its home when false.
    pub arm_run: bool,
    /// Rate of the arm, mm/s; 0 when it does not run.
    pub arm_rate_mm_s: f32,
}

/// Numbers of a board that no configuration holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Identity {
    /// Unique number of the microcontroller.
    pub unique_id: [u8; 12],
    /// Why it last started.
    pub reset_cause: ResetCause,
    /// What it runs.
    pub build: Build,
    /// What the run before this one left behind.
    pub last_run: LastRun,
}

/// Firmware version: major, minor, patch.
pub const FIRMWARE_VERSION: [u8; 3] = [0, 1, 0];

/// The board; `S` is its flash.
#[derive(Debug, Clone)]
pub struct Board<S> {
    machine: Machine<S>,
    talks: [Talk; LinkId::ALL.len()],
}

impl<S: TableStore + CalibrationStore> Board<S> {
    /// A board at start: looks for a table and a calibration in `store`, outputs off.
    pub fn new(config: BoardConfig, store: S, identity: Identity) -> Self {
        Board { machine: Machine::new(config, store, identity), talks: core::array::from_fn(|_| Talk::default()) }
    }

    /// Takes bytes from a link and carries out what they ask for.
    pub fn receive(&mut self, link: LinkId, bytes: &[u8]) {
        let talk = talk_of(&mut self.talks, link);
        for byte in bytes {
            if let Some((request, seq)) = talk.push(*byte) {
                self.machine.carry_out(link, talk, &request, seq);
            }
        }
    }

    /// Moves bytes for a link into `out`; returns how many.
    pub fn take_transmit(&mut self, link: LinkId, out: &mut [u8]) -> usize {
        talk_of(&mut self.talks, link).take_transmit(out)
    }

    /// One control tick.
    pub fn tick(&mut self, inputs: &Inputs) -> Outputs {
        let Board { machine, talks } = self;
        let outputs = machine.tick(inputs, |report| {
            for talk in talks.iter_mut() {
                talk.report(report, Priority::Answer);
            }
        });
        if let Some((link, report)) = machine.poll_upload() {
            talk_of(talks, link).report(&report, Priority::Answer);
        }
        for talk in talks {
            if talk.record_is_due() {
                talk.report(&Report::Telemetry(machine.record(inputs)), Priority::Telemetry);
                if machine.mode.by_halves() && talk.knows_halves() {
                    talk.report(&Report::Halves(machine.halves()), Priority::Telemetry);
                }
            }
        }
        outputs
    }

    /// Latches a fault of the start, which a person must learn of.
    pub fn latch(&mut self, fault: Fault) {
        self.machine.safety.latch(fault);
    }

    /// True if a tick of this duration may be followed by a permit for the outputs.
    pub const fn is_punctual(&self, tick_us: u16) -> bool {
        tick_us <= self.machine.config.safety.tick_us
    }

    /// True while a fault is latched.
    pub const fn is_faulted(&self) -> bool {
        !self.machine.safety.latched().is_empty()
    }

    /// What the board is doing.
    pub const fn state(&self) -> State {
        self.machine.state()
    }

    /// Quantities of the last tick.
    pub const fn measured(&self) -> &Measured {
        &self.machine.measured
    }

    /// The flash.
    pub const fn store(&self) -> &S {
        &self.machine.store
    }

    /// The flash, e.g. to cut its power in a test.
    pub fn store_mut(&mut self) -> &mut S {
        &mut self.machine.store
    }

    /// Gives the flash back, as a restart would find it.
    pub fn into_store(self) -> S {
        self.machine.store
    }

    /// The table in use, if there is one.
    pub fn table(&self) -> Option<Table<'_>> {
        self.machine.table()
    }
}

/// The talk of a link.
fn talk_of(talks: &mut [Talk; LinkId::ALL.len()], link: LinkId) -> &mut Talk {
    let [usb, uart] = talks;
    match link {
        LinkId::Usb => usb,
        LinkId::Uart => uart,
    }
}

#[cfg(test)]
mod tests;
