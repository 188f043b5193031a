//! Material laws in principal stretches, and their turn into stress and tangent
//! for an axisymmetric deformation gradient.
//!
//! A law is an energy per unit reference volume `U(l1, l2, l3)` (MPa = N/mm^2)
//! that is symmetric in the principal stretches. Everything an element needs
//! follows from its first and second derivatives: see [`Law`] and [`respond`].

mod gradient;
mod hyperfoam;

pub use gradient::{Gradient, Response, first_piola, respond};
pub use hyperfoam::{Hyperfoam, Term};

/// Energy and its derivatives by the principal stretches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Principal {
    /// Energy per unit reference volume `U` (MPa).
    pub energy: f64,
    /// Nominal principal stresses `dU/dl_i` (MPa).
    pub stress: [f64; 3],
    /// `d2U/dl_i dl_j` (MPa), symmetric.
    pub tangent: [[f64; 3]; 3],
}

/// An isotropic hyperelastic law in principal stretches.
///
/// Implementations must be symmetric in the stretches and stress-free at
/// `l = [1, 1, 1]`. Stretches are positive; the caller never passes others.
pub trait Law: Sync {
    /// Energy, stresses and tangent at the principal stretches `l`.
    fn principal(&self, l: [f64; 3]) -> Principal;

    /// Energy and stresses only; cheaper where no tangent is needed.
    fn stress(&self, l: [f64; 3]) -> (f64, [f64; 3]) {
        let p = self.principal(l);
        (p.energy, p.stress)
    }

    /// Small-strain shear modulus `mu_0` (MPa); scales the contact penalty.
    fn shear_modulus_mpa(&self) -> f64;

    /// Small-strain Poisson's ratio; with `mu_0` it gives the Hertz limit.
    fn poisson_ratio(&self) -> f64;
}

/// A material parameter outside the range in which the law is defined.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("hyperfoam term {term}: {parameter} = {value} {expected}")]
pub struct LawError {
    /// Index of the term, counted from 1.
    pub term: usize,
    /// Name of the parameter.
    pub parameter: &'static str,
    /// The value that was given.
    pub value: f64,
    /// What was expected of it.
    pub expected: &'static str,
}
