//! The elastic indentation of the thesis: a ball pressed into a foam, force over depth.

use super::{Curve, Resolution, Simulation, Specimen};
use crate::solid::contact::{Ball, Interface};
use crate::solid::law::Hyperfoam;
use crate::solid::solve::{Motion, SolveError, Station};

/// A ball pressed into a block, without friction.
#[derive(Debug, Clone, PartialEq)]
pub struct Indentation {
    /// Material of the block.
    pub law: Hyperfoam,
    /// The block.
    pub specimen: Specimen,
    /// The ball.
    pub ball: Ball,
    /// Largest depth (mm).
    pub depth_mm: f64,
    /// Mesh.
    pub resolution: Resolution,
}

/// Depths of [`Indentation::solve`], as in the thesis' storage matrices.
pub const DEPTHS: usize = 200;

impl Indentation {
    /// The same as a simulation; the rate of its ramp means nothing to an elastic material.
    #[must_use]
    pub fn simulation(&self) -> Simulation {
        Simulation {
            material: self.law.clone().into(),
            specimen: self.specimen,
            ball: self.ball,
            interface: Interface::default(),
            motion: Motion::ramp(self.depth_mm, 1.0),
            resolution: self.resolution,
        }
    }

    /// The curve at 200 equal steps up to the largest depth.
    ///
    /// # Errors
    /// See [`SolveError`].
    pub fn solve(&self) -> Result<Curve, SolveError> {
        let depths: Vec<f64> = (1..=DEPTHS).map(|i| self.depth_mm * i as f64 / DEPTHS as f64).collect();
        self.solve_at(&depths)
    }

    /// The curve at the given depths (mm), each at most the largest depth.
    ///
    /// # Errors
    /// See [`SolveError`].
    pub fn solve_at(&self, depths: &[f64]) -> Result<Curve, SolveError> {
        self.check()?;
        self.simulation().curve(depths)
    }

    /// The computed equilibria of the finest mesh, before any smoothing; forces
    /// as they are with the penalty.
    ///
    /// # Errors
    /// See [`SolveError`].
    pub fn stations(&self) -> Result<Vec<Station>, SolveError> {
        self.check()?;
        Ok(self.simulation().solve()?.stations)
    }

    /// Hertz's factor `F / d^(3/2)` (N/mm^1.5) of the limit `d -> 0`.
    #[must_use]
    pub fn hertz_factor(&self) -> f64 {
        self.simulation().hertz_factor()
    }

    fn check(&self) -> Result<(), SolveError> {
        if self.depth_mm.is_finite() && self.depth_mm > 0.0 {
            return Ok(());
        }
        Err(SolveError::parameter("depth_mm", self.depth_mm, "must be positive"))
    }
}
