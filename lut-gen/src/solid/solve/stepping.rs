//! How long the steps of a path are.

use super::{Motion, Segment, Target};
use crate::solid::law::Material;

/// Control of the steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stepping {
    /// First step of a depth ramp, in ball radii.
    pub first: f64,
    /// Growth of the step after one that took at most `easy` factorisations.
    pub growth: f64,
    /// Factorisations of an easy step.
    pub easy: usize,
    /// Largest step in depth, in ball radii.
    pub largest: f64,
    /// Least number of stations over the whole depth, evenly in its square root, that
    /// is in contact radius: each mesh line the contact edge crosses leaves its mark in the force.
    pub stations: usize,
    /// Smallest step before giving up, as part of its segment.
    pub smallest: f64,
    /// Factorisations of the whole path before giving up.
    pub factorisations: usize,
    /// Radius of the ball (mm).
    pub radius_mm: f64,
    /// Time in which the stress moves while the ball is held (s), the material's shortest
    /// relaxation time unless given: steps of a hold start at a tenth of it.
    pub settling_s: Option<f64>,
    /// Steps end where no effort moves them, also where nothing remembers: forces are compared with those of other
    /// parameters.
    pub planned: bool,
}

/// Steps of a hold grow by this factor: the stress moves like a sum of exponentials.
const HOLD_GROWTH: f64 = 1.4;
/// First step of a hold, in the time the stress takes to move.
const HOLD_FIRST: f64 = 0.1;

impl Stepping {
    /// The default for a ball of a radius (mm).
    #[must_use]
    pub fn of_ball(radius_mm: f64) -> Self {
        Self {
            first: 0.02,
            growth: 1.5,
            easy: 3,
            largest: 0.08,
            stations: 24,
            smallest: 2e-6,
            factorisations: 2000,
            radius_mm,
            settling_s: None,
            planned: false,
        }
    }

    /// First step of a segment from `from` to `end` (mm or N), as part of it.
    pub(super) fn first_of(&self, material: &Material, motion: &Motion, from: f64, end: f64, segment: &Segment) -> f64 {
        match segment.end {
            Target::DepthMm(_) if from != end && from == motion.start_mm => {
                self.first * self.radius_mm / (end - from).abs()
            }
            _ if from == end => self.hold_first(material, segment.duration_s),
            _ => self.longest(material, motion, from, end, segment, 0.0),
        }
    }

    /// Longest step of a segment of which the part `done` is behind, as part of the segment.
    pub(super) fn longest(
        &self,
        material: &Material,
        motion: &Motion,
        from: f64,
        end: f64,
        segment: &Segment,
        done: f64,
    ) -> f64 {
        let span = (end - from).abs();
        let held = (HOLD_GROWTH - 1.0) * done + self.hold_first(material, segment.duration_s);
        if span == 0.0 {
            return held;
        }
        let at = from + (end - from) * done;
        let (largest, power) = match segment.end {
            Target::DepthMm(_) => (motion.deepest_mm(), 2),
            Target::ForceN(_) => (motion.largest_force_n(), 3),
        };
        let even = 1.0 / self.stations as f64;
        if at < 0.0 && end > at {
            // down to touch, and no further at once
            return even.min(-at / span);
        }
        if at < 0.0 || largest <= 0.0 || (at == 0.0 && end < 0.0) {
            return even;
        }
        // evenly in the contact radius: in the square root of the depth, the cube root of the force
        let root = (at / largest).powf(1.0 / f64::from(power));
        let next = root + (1.0 / self.stations as f64).copysign(end - from);
        let length = (largest * next.max(0.0).powi(power) - at).abs().max(1e-3 * largest / self.stations as f64);
        let cap = if power == 2 { self.largest * self.radius_mm } else { f64::INFINITY };
        let length = length.min(cap) / span;
        // under a prescribed force the stress is no straight line in time: the material creeps
        if power == 3 && !material.prony.is_empty() { length.min(held) } else { length }
    }

    /// Factor on the step after one that took so many factorisations.
    pub(super) fn stretch(&self, used: usize) -> f64 {
        if used <= self.easy {
            self.growth
        } else if used > self.easy + 2 {
            0.8
        } else {
            1.0
        }
    }

    /// First step of a hold as part of its duration: all of it when nothing relaxes.
    fn hold_first(&self, material: &Material, duration_s: f64) -> f64 {
        let shortest = material.prony.iter().map(|t| t.tau_s).fold(f64::INFINITY, f64::min);
        (HOLD_FIRST * self.settling_s.unwrap_or(shortest) / duration_s).min(1.0)
    }
}
