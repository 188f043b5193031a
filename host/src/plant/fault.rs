//! Broken wires of the sensors.

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
    /// Ground: the wire from the supply is open, or the input is shorted to ground.
    Low,
    /// The reference: the wire to ground is open, or the input is shorted to the supply.
    High,
    /// One voltage for ever, as fraction of the reference.
    Stuck(f64),
}

impl Broken {
    /// What the input sees, as fraction of the reference.
    pub fn ratio(self) -> f64 {
        match self {
            Broken::Low => 0.0,
            Broken::High => 1.0,
            Broken::Stuck(ratio) => ratio,
        }
    }
}
