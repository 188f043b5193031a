//! What an elastic law says: energy, stresses and tangent in principal stretches.

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
