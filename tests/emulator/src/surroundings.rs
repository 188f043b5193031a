//! The simulated bench of the in-process board, wired to the chip's pins.

use std::cell::RefCell;
use std::rc::Rc;

use firmware::board::Outputs;
use palpate::plant::{Bench, OVERSAMPLED};

use crate::chip::{INPUTS, Pins, Wiring};

/// Supply of the actuator's bridge, V (`docs/board.md`, pins).
const ACTUATOR_SUPPLY_V: f64 = 12.0;

/// Rate of the arm at full duty of its set point, mm/s (same).
const ARM_FULL_RATE_MM_S: f64 = 10.0;

/// Inputs of the converter (ADC1 channels) of the bench's sensors, in the order of the firmware's readings (`docs/board.md`, pins).
const CHANNELS: [usize; 5] = [3, 10, 13, 12, 9];

/// A bench that board and test share.
pub type SharedBench = Rc<RefCell<Bench>>;

/// Bench and what its sensors show in this millisecond.
pub struct Surroundings {
    bench: SharedBench,
    voltages: [[f64; OVERSAMPLED]; 5],
    /// Nothing moves before the first reading, as in the in-process board.
    started: bool,
    /// The noise of this millisecond is drawn when the first reading asks for it.
    fresh: bool,
}

impl Surroundings {
    /// Wires a bench.
    pub fn new(bench: SharedBench) -> Self {
        Surroundings { bench, voltages: [[0.0; OVERSAMPLED]; 5], started: false, fresh: false }
    }
}

/// What the pins' state means to the bench.
fn outputs(pins: &Pins) -> Outputs {
    Outputs {
        actuator_v: ((pins.forward - pins.reverse) * ACTUATOR_SUPPLY_V) as f32,
        arm_run: pins.arm_run,
        arm_rate_mm_s: (pins.arm_rate * ARM_FULL_RATE_MM_S) as f32,
        ..Outputs::default()
    }
}

impl Wiring for Surroundings {
    fn step(&mut self, pins: &Pins, ticked: bool) {
        if !self.started {
            return;
        }
        let mut bench = self.bench.borrow_mut();
        if ticked {
            bench.next_sample();
        }
        bench.advance(&outputs(pins), pins.coil as f32);
        self.fresh = true;
    }

    fn first_scan(&mut self, pins: &Pins, ticked: bool) {
        if !std::mem::replace(&mut self.started, true) {
            self.bench.borrow_mut().next_sample();
            return self.step(pins, false);
        }
        self.step(pins, ticked);
    }

    fn voltages(&mut self, scan: u32) -> [f64; INPUTS] {
        if std::mem::take(&mut self.fresh) {
            self.voltages = self.bench.borrow_mut().voltages();
        }
        let mut inputs = [0.0; INPUTS];
        for (channel, readings) in CHANNELS.into_iter().zip(&self.voltages) {
            inputs[channel] = readings[scan as usize % OVERSAMPLED];
        }
        inputs
    }
}
