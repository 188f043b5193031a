//! The foam under the probe.

use super::{Curve, Noise, Source};

/// A foam of the bench.
#[derive(Debug, Clone, PartialEq)]
pub struct Foam {
    /// Name.
    pub name: String,
    /// Shear modulus of the one-term Hyperfoam, MPa.
    pub mu_mpa: f64,
    /// Its exponent.
    pub alpha: f64,
    /// Height, mm.
    pub height_mm: f64,
    /// Force of the bench's ball, by finite elements at exactly this height.
    pub curve: Curve,
}

/// How one palpation differs from the next, and the noise of the force; standard deviations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jitter {
    /// White force noise, fraction of the foam's peak force, new for every 50 Hz sample.
    pub force: f64,
    /// Gain, fraction, new for every palpation.
    pub gain: f64,
    /// Height of the surface, mm, new for every palpation.
    pub surface_mm: f64,
}

impl Jitter {
    /// No randomness.
    pub const NONE: Jitter = Jitter { force: 0.0, gain: 0.0, surface_mm: 0.0 };
}

impl Default for Jitter {
    /// The bench of the demo: 1 % force noise, 1 % gain, 0.02 mm contact.
    fn default() -> Self {
        Jitter { force: 0.01, gain: 0.01, surface_mm: 0.02 }
    }
}

/// A foam laid under the probe, with the randomness of this palpation.
#[derive(Debug, Clone)]
pub struct Placed {
    foam: Foam,
    gain: f64,
    /// Height of the surface above the base plate, mm.
    surface_mm: f64,
    noise_n: f64,
    noise: Noise,
    /// Noise of the present sample, N.
    sample_n: f64,
}

impl Placed {
    /// Lays `foam` under the probe; `gain` and `surface` are the streams that palpations draw from.
    pub fn new(foam: Foam, jitter: Jitter, gain: &mut Noise, surface: &mut Noise, seed: u64) -> Self {
        Placed {
            gain: 1.0 + jitter.gain * gain.normal(),
            surface_mm: foam.height_mm + jitter.surface_mm * surface.normal(),
            noise_n: jitter.force * foam.curve.peak_n(),
            noise: Noise::new(seed, Source::Force),
            sample_n: 0.0,
            foam,
        }
    }

    /// The foam.
    pub fn foam(&self) -> &Foam {
        &self.foam
    }

    /// Depth of the ball's lowest point below the surface, mm; negative above it.
    pub fn depth_mm(&self, probe_mm: f64) -> f64 {
        self.surface_mm - probe_mm
    }

    /// True force on the ball, N.
    pub fn force_n(&self, probe_mm: f64) -> f64 {
        self.gain * self.foam.curve.force_n(self.depth_mm(probe_mm))
    }

    /// Draws the noise of the next 50 Hz sample.
    pub fn next_sample(&mut self) {
        self.sample_n = self.noise_n * self.noise.normal();
    }

    /// Force the load cell feels, N: the true force and the noise of this sample.
    pub fn felt_n(&self, probe_mm: f64) -> f64 {
        self.force_n(probe_mm) + self.sample_n
    }
}
