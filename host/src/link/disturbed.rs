//! Seeded line noise between a link and its user.

use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;

use super::{Link, LinkError};
use crate::plant::Truth;

/// What the line does to bytes, each as a probability.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Disturbance {
    /// A byte has one bit flipped, 0 to 1.
    pub flip: f64,
    /// A byte is lost, 0 to 1.
    pub lose: f64,
    /// Link time after which the board's answers no longer arrive, s. `None`: never.
    pub dead_after_s: Option<f64>,
}

/// A link with a bad cable, in both directions.
#[derive(Debug)]
pub struct Disturbed<L> {
    inner: L,
    disturbance: Disturbance,
    random: Pcg64,
}

impl<L: Link> Disturbed<L> {
    /// Wraps `inner`; the same seed disturbs the same bytes.
    pub fn new(inner: L, disturbance: Disturbance, seed: u64) -> Self {
        Disturbed { inner, disturbance, random: Pcg64::seed_from_u64(seed) }
    }

    /// The link behind the noise.
    pub fn inner(&self) -> &L {
        &self.inner
    }

    /// The link behind the noise, to change it.
    pub fn inner_mut(&mut self) -> &mut L {
        &mut self.inner
    }

    /// Changes what the line does.
    pub fn set_disturbance(&mut self, disturbance: Disturbance) {
        self.disturbance = disturbance;
    }

    fn disturb(&mut self, bytes: &[u8]) -> Vec<u8> {
        let Disturbance { flip, lose, .. } = self.disturbance;
        let mut out = Vec::with_capacity(bytes.len());
        for &byte in bytes {
            if lose > 0.0 && self.random.random_bool(lose.min(1.0)) {
                continue;
            }
            let flipped = flip > 0.0 && self.random.random_bool(flip.min(1.0));
            let bit = if flipped { 1u8 << self.random.random_range(0..8) } else { 0 };
            out.push(byte ^ bit);
        }
        out
    }
}

impl<L: Link> Link for Disturbed<L> {
    fn name(&self) -> &str {
        self.inner.name()
    }

    fn now_s(&self) -> f64 {
        self.inner.now_s()
    }

    fn send(&mut self, bytes: &[u8]) -> Result<(), LinkError> {
        let bytes = self.disturb(bytes);
        self.inner.send(&bytes)
    }

    fn receive(&mut self, into: &mut Vec<u8>, deadline_s: f64) -> Result<(), LinkError> {
        let mut bytes = Vec::new();
        self.inner.receive(&mut bytes, deadline_s)?;
        if self.disturbance.dead_after_s.is_none_or(|dead| self.inner.now_s() < dead) {
            let bytes = self.disturb(&bytes);
            into.extend_from_slice(&bytes);
        }
        Ok(())
    }

    fn take_truth(&mut self) -> Vec<Truth> {
        self.inner.take_truth()
    }
}
