//! Broken wires of the sensors.

use super::STEP_S;

/// An analog input of the board, in the order of [`firmware::sensor::RawSamples::channels`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Input {
    /// Load cell of the probe.
    LoadCell,
    /// FSR under the cap.
    Fsr,
    /// Potentiometer of the shaft.
    Potentiometer,
    /// Transducer of the probe's position.
    ProbePosition,
    /// Shunt amplifier of the coil.
    CoilCurrent,
}

/// What an input reads when something is wrong with its sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Broken {
    /// Ground: the input is shorted to ground.
    Low,
    /// The reference: the input is shorted to the supply.
    High,
    /// One voltage for ever, as fraction of the reference.
    Stuck(f64),
    /// The wire is off, and the pin is left to what is on the board.
    Floating(Pin),
}

/// What is at a pin when its wire is off.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pin {
    /// Resistor to ground, kOhm; infinite without one.
    pub pull_kohm: f64,
    /// Capacitor to ground, nF.
    pub nano_farad: f64,
    /// Current into the pin's capacitor out of the chip, nA, either way. STM32F429 data sheet: 1,000 at most,
    /// over all temperatures; a few at room temperature.
    pub leak_na: f64,
}

/// Reference of the converter, V.
const REFERENCE_V: f64 = 3.3;

/// Conversions of a channel a second.
const SCANS_HZ: f64 = 16_000.0;

/// Sampling capacitor of the converter, pF: 4 typical, 7 at most (STM32F429 data sheet).
const SAMPLING_PF: f64 = 5.0;

impl Pin {
    /// A capacitor and nothing else.
    pub const BARE: Pin = Pin { pull_kohm: f64::INFINITY, nano_farad: 100.0, leak_na: 0.0 };

    /// As the wiring of `docs/bring-up.md` has it.
    pub const fn drawn(input: Input) -> Pin {
        let (pull_kohm, nano_farad) = match input {
            Input::LoadCell | Input::ProbePosition => (10.0, 100.0),
            // The fixed resistors of the two dividers.
            Input::Fsr => (10.0, 100.0),
            Input::Potentiometer => (1.6, 100.0),
            Input::CoilCurrent => (10.0, 10.0),
        };
        Pin { pull_kohm, nano_farad, leak_na: 0.0 }
    }

    /// The same with a leakage.
    #[must_use]
    pub const fn leaking(self, leak_na: f64) -> Pin {
        Pin { leak_na, ..self }
    }

    /// Voltage after [`STEP_S`], from `ratio`, both as fraction of the reference. Every conversion begins with the charge that the
    /// channel before it, at `before`, has left in the sampling capacitor: a resistor of `1 / (f C)` to that
    /// voltage, 12.5 MOhm.
    pub(super) fn drift(&self, ratio: f64, before: f64) -> f64 {
        let (sampling, pull) = (SCANS_HZ * SAMPLING_PF * 1e-12, 1e-3 / self.pull_kohm);
        let siemens = sampling + pull;
        let rest = (sampling * before + self.leak_na * 1e-9 / REFERENCE_V) / siemens;
        // Protection diodes at both rails.
        (rest + (ratio - rest) * (-STEP_S * siemens / (self.nano_farad * 1e-9)).exp()).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(pin: Pin, from: f64, before: f64, seconds: f64) -> f64 {
        (0..(seconds / STEP_S) as u32).fold(from, |ratio, _| pin.drift(ratio, before))
    }

    /// 100 nF times 12.5 MOhm is 1.25 s.
    #[test]
    fn a_bare_pin_follows_its_neighbour_in_a_second_and_a_leakage_carries_it_off() {
        let expected = 0.05 + 0.05 * (-1.0f64 / 1.25).exp();
        // Rounding of a thousand steps.
        assert!((after(Pin::BARE, 0.1, 0.05, 1.0) - expected).abs() < 1e-9);
        // 13.2 nA through 12.5 MOhm are 0.165 V: the zero of the load cell above that of the coil.
        assert!((after(Pin::BARE.leaking(13.2), 0.3, 0.05, 20.0) - 0.1).abs() < 1e-4);
    }

    /// With the data sheet's largest leakage and any neighbour, in the time that a fault may take.
    #[test]
    fn a_drawn_pin_is_at_the_rail_whatever_leaks() {
        use Input::{CoilCurrent, Fsr, LoadCell, Potentiometer, ProbePosition};
        for input in [LoadCell, Fsr, Potentiometer, ProbePosition, CoilCurrent] {
            for leak_na in [-1000.0, 0.0, 1000.0] {
                let ratio = after(Pin::drawn(input).leaking(leak_na), 0.95, 1.0, 0.02);
                assert!(firmware::sensor::at_rail(ratio as f32), "{input:?}, {leak_na} nA: {ratio}");
            }
        }
        // The coil's amplifier in the time of the fast loop.
        assert!(firmware::sensor::at_rail(after(Pin::drawn(CoilCurrent), 0.95, 1.0, 0.001) as f32));
    }
}
