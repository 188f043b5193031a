//! Material laws: an elastic energy in principal stretches, and what time and cycles do to it.
//!
//! An elastic law is an energy per unit reference volume `U(l1, l2, l3)` (MPa = N/mm^2) that is
//! symmetric in the principal stretches: [`Hyperfoam`], [`Ogden`], [`Hencky`]. A [`Material`]
//! is one of them, relaxing by a [`PronyTerm`] series, softening by [`OgdenRoxburgh`] and expanded by heat or not.
//! Everything is written over [`Real`], so that the same code carries derivatives by parameters.

mod elastic;
mod error;
mod gradient;
mod hencky;
mod hyperfoam;
mod material;
mod ogden;
mod parameter;
mod prony;
mod second;
mod softening;

pub use elastic::Elastic;
pub use error::LawError;
pub use gradient::{Gradient, Response, first_piola, first_piola_dual, respond};
pub use hencky::Hencky;
pub use hyperfoam::{Hyperfoam, Term};
pub use material::Material;
pub use ogden::{Ogden, OgdenTerm};
pub use parameter::Parameter;
pub use prony::{PronyTerm, Relaxation, relaxed};
pub use softening::OgdenRoxburgh;

use crate::scalar::Real;

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
pub trait Law<T: Real = f64>: Sync {
    /// Energy (MPa) and nominal principal stresses (MPa) at the principal stretches `l`.
    fn stress(&self, l: [T; 3]) -> (T, [T; 3]);

    /// Small-strain shear modulus `mu_0` (MPa); scales the contact penalty.
    fn shear_modulus_mpa(&self) -> T;

    /// Small-strain Poisson's ratio; with `mu_0` it gives the Hertz limit.
    fn poisson_ratio(&self) -> T;
}

/// A law with its second derivatives, as Newton's method needs it.
pub trait Tangent: Law {
    /// Energy, stresses and tangent at the principal stretches `l`.
    fn principal(&self, l: [f64; 3]) -> Principal;
}
