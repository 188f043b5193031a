//! What the load cell reads during an indentation, as a function of the parameters.

use super::{Model, Prediction};
use crate::surface::{Curve, Surface};
use nalgebra::{Vector2, Vector3};

/// Force over depth on a table's slice.
///
/// States (mu MPa, alpha), or (mu MPa, alpha, d0 mm) with the depth at which the first estimate of the contact point is off: the ball is
/// `d0` deeper than the input says. A press from a contact point that is 0.03 mm early shifts alpha by tens of percent; so d0 belongs to
/// the unknowns.
#[derive(Debug, Clone, Copy)]
pub struct Indentation<'a> {
    /// The continuous model.
    pub surface: Surface<'a>,
}

impl Model<2> for Indentation<'_> {
    /// Depth, mm.
    type Input = f32;

    fn predict(&self, state: &Vector2<f32>, depth_mm: f32) -> Option<Prediction<2>> {
        let force = self.surface.at(state[0], state[1], depth_mm)?;
        Some(Prediction { value: force.force_n, gradient: Vector2::new(force.by_mu, force.by_alpha) })
    }
}

impl Model<3> for Indentation<'_> {
    /// Depth by the first estimate of the contact point, mm.
    type Input = f32;

    fn predict(&self, state: &Vector3<f32>, depth_mm: f32) -> Option<Prediction<3>> {
        let force = self.surface.at(state[0], state[1], depth_mm + state[2])?;
        Some(Prediction { value: force.force_n, gradient: Vector3::new(force.by_mu, force.by_alpha, force.by_depth) })
    }
}

/// Force over depth at one exponent, as a load cell reads it whose zero is known but roughly.
///
/// States (mu MPa, d0 mm as in [`Indentation`], zero N): the model is linear in the first and the last.
#[derive(Debug, Clone, Copy)]
pub struct AtExponent<'a> {
    /// Force of unit modulus.
    pub curve: Curve<'a>,
}

impl Model<3> for AtExponent<'_> {
    /// Depth by the first estimate of the contact point, mm.
    type Input = f32;

    fn predict(&self, state: &Vector3<f32>, depth_mm: f32) -> Option<Prediction<3>> {
        let (force, slope) = self.curve.at(depth_mm + state[1]);
        Some(Prediction { value: state[0] * force + state[2], gradient: Vector3::new(force, state[0] * slope, 1.0) })
    }
}
