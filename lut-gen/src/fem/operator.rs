//! What a physics tells the core: how nodes strain a point, and what a point answers.

/// How the values of one node enter the strain at a point: the node's columns of B in
/// `strain = rest + sum over the nodes of B_a u_a`.
///
/// `C` is the number of components of the field, `N` that of the strain. Strain stands for whatever the energy
/// depends on: a deformation gradient, the gradient of a potential.
pub trait Operator<T, const C: usize, const N: usize> {
    /// Adds `B_a u_a` to the strain.
    fn strain(&self, values: &[T; C], strain: &mut [T; N]);

    /// `B_a' flux`: what a flux puts on the node.
    fn force(&self, flux: &[T; N]) -> [T; C];
}

/// The energy of a physics at a point of integration, with what the point remembers.
///
/// Energies are per reference volume; the flux is their slope by the strain (a stress, a field strength).
pub trait PointLaw<T, const N: usize> {
    /// Strain where every value of the field is zero.
    fn rest(&self) -> [T; N];

    /// Numbers that a point remembers.
    fn states(&self) -> usize {
        0
    }

    /// Energy and flux at a strain, from what the point remembers (`old`, [`PointLaw::states`] numbers); `new` receives
    /// what it will remember. `None` where the strain is impossible.
    fn flux(&self, strain: &[T; N], old: &[T], new: Option<&mut [T]>) -> Option<(T, [T; N])>;
}

/// A law with the slope of its flux, as Newton's method needs it.
pub trait PointTangent<const N: usize>: PointLaw<f64, N> {
    /// Energy, flux and tangent at a strain. `None` where the strain is impossible.
    fn response(&self, strain: &[f64; N], old: &[f64]) -> Option<Response<N>>;
}

/// Answer of a law at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Response<const N: usize> {
    /// Energy per reference volume.
    pub energy: f64,
    /// Its slope by the strain.
    pub flux: [f64; N],
    /// `tangent[i][j] = d flux_i / d strain_j`.
    pub tangent: [[f64; N]; N],
}
