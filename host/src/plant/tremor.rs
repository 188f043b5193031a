//! Physiological tremor.

use std::f64::consts::TAU;

use super::{Noise, Source};

/// White noise through a resonance: of standard deviation 1.
#[derive(Debug, Clone)]
pub struct Tremor {
    state: [f64; 2],
    noise: Noise,
}

/// 8 to 12 Hz, here their middle.
const TREMOR_HZ: f64 = 10.0;

/// Damping ratio as a narrow-band filter (assumed).
const TREMOR_DAMPING: f64 = 0.15;

impl Tremor {
    /// At rest, with the stream of a source.
    pub fn new(seed: u64, source: Source) -> Self {
        Tremor { state: [0.0; 2], noise: Noise::new(seed, source) }
    }

    /// Lets `dt_s` pass. The gain makes the output's deviation 1 (variance of x'' + 2 z w x' + w^2 x = a n is
    /// a^2 / (4 z w^3)).
    pub fn step(&mut self, dt_s: f64) {
        let w = TAU * TREMOR_HZ;
        let gain = (4.0 * TREMOR_DAMPING * w.powi(3) / dt_s).sqrt();
        let [x, v] = self.state;
        let v = v + dt_s * (gain * self.noise.normal() - 2.0 * TREMOR_DAMPING * w * v - w * w * x);
        self.state = [x + dt_s * v, v];
    }

    /// What it is now.
    pub fn now(&self) -> f64 {
        self.state[0]
    }
}
