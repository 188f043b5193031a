//! Stretches and stress at one material point.

use crate::solid::law::Gradient;

/// Strain and stress of one point. Components are those of the cylindrical directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointState {
    /// Principal stretches (-): larger and smaller one of the r-z plane, then the hoop stretch.
    pub stretch: [f64; 3],
    /// Cauchy stress `[rr, zz, tt, rz]` (MPa), positive in tension.
    pub cauchy_mpa: [f64; 4],
}

impl PointState {
    /// The state at a deformation gradient that preserves orientation, with its first Piola-Kirchhoff
    /// stress `p` in the same order (MPa).
    ///
    /// Cauchy stress is `P F^T / J`; the in-plane stretches are the singular values of the
    /// r-z part, from their half sum and half difference.
    #[must_use]
    pub fn new(f: &Gradient, p: &[f64; 5]) -> Self {
        let area = f[0] * f[3] - f[1] * f[2];
        let j = area * f[4];
        let half_sum = (0.5 * (f[0] + f[3])).hypot(0.5 * (f[2] - f[1]));
        let half_difference = (0.5 * (f[0] - f[3])).hypot(0.5 * (f[2] + f[1]));
        let larger = half_sum + half_difference;
        Self {
            stretch: [larger, area / larger, f[4]],
            cauchy_mpa: [
                (p[0] * f[0] + p[1] * f[1]) / j,
                (p[2] * f[2] + p[3] * f[3]) / j,
                p[4] * f[4] / j,
                (p[0] * f[2] + p[1] * f[3]) / j,
            ],
        }
    }

    /// Ratio of current to reference volume `J` (-).
    #[must_use]
    pub fn volume_ratio(&self) -> f64 {
        self.stretch.iter().product()
    }

    /// Von Mises' equivalent stress (MPa), `sqrt(3/2 s:s)` of the Cauchy stress' deviator `s`.
    #[must_use]
    pub fn mises_mpa(&self) -> f64 {
        let [rr, zz, tt, rz] = self.cauchy_mpa;
        let normal = (rr - zz).powi(2) + (zz - tt).powi(2) + (tt - rr).powi(2);
        (0.5 * normal + 3.0 * rz * rz).sqrt()
    }
}
