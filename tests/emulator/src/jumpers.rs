//! A bare NUCLEO with the wires of the self test (`docs/selftest.md`): a driven pin, 10 kOhm, 100 nF, an analog input.

use crate::chip::{INPUTS, Pins, Wiring};

/// Codes of the converter.
const FULL: f64 = 4096.0;

/// Channel of the internal reference, and its codes: 1.21 V of 3.3 V (data sheet, embedded reference voltage).
const REFERENCE: usize = 17;
const REFERENCE_CODES: f64 = 1.21 / 3.3 * FULL;

/// The analog inputs' channels in the order in which the program converts them: PA3, PC0, PC3, PC2, PB1.
const ORDER: [usize; 5] = [3, 10, 13, 12, 9];

/// A pin that a wire begins at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum From {
    /// PC6.
    Coil,
    /// PE9.
    Forward,
    /// PD15.
    ArmRate,
}

/// A wire.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jumper {
    /// Where it begins.
    pub from: From,
    /// Channel of the converter that it ends at.
    pub to: usize,
    /// Product of resistor and capacitor, ms.
    pub tau_ms: f64,
}

/// The three wires as they should be.
pub const AS_DRAWN: [Jumper; 3] = [
    Jumper { from: From::Coil, to: 9, tau_ms: 1.0 },
    Jumper { from: From::Forward, to: 13, tau_ms: 1.0 },
    Jumper { from: From::ArmRate, to: 12, tau_ms: 1.0 },
];

/// Wires with what is at their ends.
#[derive(Debug, Clone)]
pub struct Jumpers {
    wires: Vec<(Jumper, f64)>,
    /// Noise of the readings, from a linear congruential generator.
    noise: u32,
}

impl Jumpers {
    /// These wires, all capacitors empty.
    pub fn new(wires: &[Jumper]) -> Self {
        Jumpers { wires: wires.iter().map(|wire| (*wire, 0.0)).collect(), noise: 1 }
    }

    fn noise(&mut self) -> f64 {
        self.noise = self.noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(self.noise >> 16) / 32_768.0 - 1.0
    }
}

impl Wiring for Jumpers {
    fn step(&mut self, pins: &Pins, _: bool) {
        for (wire, level) in &mut self.wires {
            let duty = match wire.from {
                From::Coil => pins.coil,
                From::Forward => pins.forward,
                From::ArmRate => pins.arm_rate,
            };
            // A pin that is not driven is pulled down by 40 kOhm, behind the 10 of the wire.
            let tau_ms = if duty == 0.0 { 5.0 * wire.tau_ms } else { wire.tau_ms };
            *level += (duty - *level) * (1.0 - (-1.0 / tau_ms).exp());
        }
    }

    /// The capacitor over 10 kOhm against the pin's pull-down of 40; high above 0.4 of the supply.
    fn holds_high(&self, port: usize, pin: u32) -> bool {
        let from = match (port, pin) {
            (2, 6) => From::Coil,
            (4, 9) => From::Forward,
            _ => return false,
        };
        self.wires.iter().any(|(wire, level)| wire.from == from && 0.8 * level > 0.4)
    }

    fn first_scan(&mut self, pins: &Pins, ticked: bool) {
        self.step(pins, ticked);
    }

    fn voltages(&mut self, _: u32) -> [f64; INPUTS] {
        let mut inputs = [0.0; INPUTS];
        // An open input shows what the one before it left in the sampling capacitor.
        let mut last = 0.3;
        for channel in ORDER {
            if let Some((_, level)) = self.wires.iter().find(|(wire, _)| wire.to == channel) {
                last = *level;
            }
            inputs[channel] = last * FULL + 1.5 * self.noise();
        }
        inputs[REFERENCE] = REFERENCE_CODES;
        inputs
    }
}
