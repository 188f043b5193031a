//! The board that is there when no hardware is: the very firmware library, in lock-step with a [`Bench`].
//!
//! Time is virtual: [`SimulatedBoard::step`] lets one control tick (20 ms) pass, in which the bench and the firmware's fast loop take
//! twenty steps of 1 ms and then the firmware its tick. Given a seed everything but the measured duration of a tick repeats exactly.

#[cfg(test)]
mod samples;
mod server;

use std::time::Instant;

use firmware::board::{Board, Identity, Inputs, Outputs};
use firmware::config::BoardConfig;
use firmware::fast::{FAST_STEPS, FastLoop};
use firmware::flash::{BANK_LEN, RamFlash};
use firmware::link::LinkId;
use firmware::sensor::RawSamples;
use protocol::TICK_HZ;
use protocol::lut::Table;
use protocol::message::{Build, LastRun, ResetCause, State};

#[cfg(test)]
pub(crate) use samples::{foam, press_table, stiffer_foam};
pub use server::{Server, serve};

use crate::plant::{Bench, Broken, Foam, Input, Jitter, Touch, Truth};

/// Truths kept for a listener that does not take them: ten seconds.
const TRUTHS: usize = 500;

/// When the control tick comes and acts, against the fast loop's steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Timing {
    /// Steps of the fast loop before those of the first tick.
    pub early_steps: u32,
    /// A tick falls into a step that has begun under the previous outputs, as on the real board; otherwise right between two.
    pub within_step: bool,
}

/// A board with simulated surroundings.
#[derive(Debug)]
pub struct SimulatedBoard {
    board: Board<RamFlash<Vec<u8>>>,
    fast: FastLoop,
    bench: Bench,
    timing: Timing,
    outputs: Outputs,
    /// Readings of the step into which the last tick fell.
    begun: Option<RawSamples>,
    coil_duty: f32,
    tick: u32,
    tick_us: u16,
    /// Longest tick that the board is told of, us.
    tick_us_max: u16,
    truths: std::collections::VecDeque<Truth>,
}

impl SimulatedBoard {
    /// A board just powered on, without table, on an empty bench.
    pub fn new(seed: u64, jitter: Jitter) -> Self {
        let config = BoardConfig { simulated: true, ..BoardConfig::default() };
        let mut unique_id = *b"palpate-sim\0";
        unique_id[11] = seed as u8;
        let identity =
            Identity { unique_id, reset_cause: ResetCause::PowerOn, build: Build::UNKNOWN, last_run: LastRun::NONE };
        SimulatedBoard {
            fast: FastLoop::new(&config.circuit, &config.shunt, config.safety.coil_a),
            tick_us_max: config.safety.tick_us,
            board: Board::new(config, RamFlash::new(vec![0xff; BANK_LEN]), identity),
            bench: Bench::new(seed, jitter),
            timing: Timing::default(),
            outputs: Outputs::default(),
            begun: None,
            coil_duty: 0.0,
            tick: 0,
            tick_us: 0,
            truths: std::collections::VecDeque::new(),
        }
    }

    /// Gives a board that has not been stepped yet other surroundings.
    #[must_use]
    pub fn on(self, bench: Bench) -> Self {
        SimulatedBoard { bench, ..self }
    }

    /// The surroundings, to change them.
    pub fn bench_mut(&mut self) -> &mut Bench {
        &mut self.bench
    }

    /// Gives a board that has not been stepped yet another timing.
    pub fn set_timing(&mut self, timing: Timing) {
        self.timing = timing;
    }

    /// Breaks a sensor, or mends it.
    pub fn set_broken(&mut self, input: Input, broken: Option<Broken>) {
        self.bench.set_broken(input, broken);
    }

    /// Bytes from the host.
    pub fn receive(&mut self, bytes: &[u8]) {
        self.board.receive(LinkId::Usb, bytes);
    }

    /// Appends bytes for the host.
    pub fn transmit(&mut self, into: &mut Vec<u8>) {
        let mut buffer = [0u8; 512];
        loop {
            match self.board.take_transmit(LinkId::Usb, &mut buffer) {
                0 => return,
                n => into.extend_from_slice(&buffer[..n]),
            }
        }
    }

    /// What reaches the coil's switch: the interlock passes nothing on unless the coil is on.
    fn driven_duty(&self) -> f32 {
        if self.outputs.power.coil { self.coil_duty } else { 0.0 }
    }

    /// Lets one control tick pass.
    pub fn step(&mut self) {
        let early = if self.tick == 0 { self.timing.early_steps } else { 0 };
        self.bench.next_sample();
        for _ in 0..early + FAST_STEPS {
            let begun = self.begun.take();
            let raw = begun.unwrap_or_else(|| self.bench.step(&self.outputs, self.driven_duty()));
            self.coil_duty = self.fast.step(&raw);
        }
        if self.timing.within_step {
            self.begun = Some(self.bench.step(&self.outputs, self.driven_duty()));
        }
        let inputs =
            Inputs { period_us: 1_000_000 / TICK_HZ, ..Inputs::from_fast(&self.fast.take(), false, self.tick_us) };
        let started = Instant::now();
        self.outputs = self.board.tick(&inputs);
        // Host time, not board time: it shows the order of magnitude only. A host that was busy elsewhere must not look like
        // a board that missed its deadline, so the board is never told of more than its limit.
        let host_us = started.elapsed().as_micros().min(u128::from(self.tick_us_max));
        self.tick_us = host_us as u16;
        self.fast.set_target_a(self.outputs.coil_target_a);
        self.tick = self.tick.wrapping_add(1);
        if self.truths.len() == TRUTHS {
            self.truths.pop_front();
        }
        self.truths.push_back(self.bench.truth(self.tick, self.time_s()));
    }

    /// Virtual time since power on, s.
    pub fn time_s(&self) -> f64 {
        f64::from(self.tick) / f64::from(TICK_HZ)
    }

    /// True physics of the ticks since the last call, at most the last ten seconds.
    pub fn take_truth(&mut self) -> Vec<Truth> {
        self.truths.drain(..).collect()
    }

    /// Lays a foam under the probe; see [`Bench::place`].
    pub fn place(&mut self, foam: Foam) {
        self.bench.place(foam);
    }

    /// Starts pressing the display, or lifts the finger.
    pub fn touch(&mut self, touch: Option<Touch>) {
        self.bench.touch(touch);
    }

    /// The surroundings.
    pub fn bench(&self) -> &Bench {
        &self.bench
    }

    /// What the board is doing.
    pub fn state(&self) -> State {
        self.board.state()
    }

    /// The table in use.
    pub fn table(&self) -> Option<Table<'_>> {
        self.board.table()
    }

    /// The flash, to cut its power in a test.
    pub fn flash_mut(&mut self) -> &mut RamFlash<Vec<u8>> {
        self.board.store_mut()
    }
}
