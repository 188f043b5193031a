//! What is to be simulated of a display, as plain data.

use super::{DisplayEffect, DisplayRun};

/// What chance adds beyond the converter's own noise, as standard deviations; the part that is told is correlated over `correlation_s`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DisplayNoise {
    /// Of the measured position, mm.
    pub position_mm: f64,
    /// Of the force, fraction of the force.
    pub force_share: f64,
    /// Of the current, A.
    pub current_a: f64,
    /// Of the flux density, T.
    pub flux_t: f64,
    /// Of the finger's force, N.
    pub finger_n: f64,
    /// Of the place of its bone, mm; white.
    pub finger_mm: f64,
    /// Correlation time, s.
    pub correlation_s: f64,
    /// Of the gain from run to run: force; position, current and flux scatter by a tenth of it.
    pub gain_jitter: f64,
    /// Student's t with three degrees of freedom instead of a normal distribution.
    pub heavy_tails: bool,
}

impl Default for DisplayNoise {
    fn default() -> Self {
        Self {
            position_mm: 0.02,
            force_share: 0.005,
            current_a: 0.004,
            flux_t: 1e-4,
            finger_n: 0.004,
            finger_mm: 0.004,
            correlation_s: 0.1,
            gain_jitter: 0.015,
            heavy_tails: false,
        }
    }
}

/// What is done to a display, and by what it differs from what its simulation takes for granted.
#[derive(Debug, Clone, PartialEq)]
pub struct DisplaySpec {
    /// Title.
    pub name: String,
    /// Seed of everything random.
    pub seed: u64,
    /// Commands.
    pub runs: Vec<DisplayRun>,
    /// Chance.
    pub noise: DisplayNoise,
    /// Flaws.
    pub effects: Vec<DisplayEffect>,
}

impl DisplaySpec {
    /// Nothing done yet, no flaw.
    #[must_use]
    pub fn new(name: &str, seed: u64) -> Self {
        Self { name: name.to_owned(), seed, runs: Vec::new(), noise: DisplayNoise::default(), effects: Vec::new() }
    }
}
