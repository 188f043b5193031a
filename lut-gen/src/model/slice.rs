//! The force of a unit shear modulus over depth, at one place of a force model.

use super::chebyshev::polynomials;
use super::profile::MAX_TERMS;

/// `F / mu = H d^(3/2) exp(s q(s))` with `s = sqrt(d / d_max)`: 0 for `d <= 0`, continued linearly beyond `d_max`.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceSlice {
    /// Largest depth (mm) that was solved.
    pub depth_max_mm: f64,
    /// Hertz's factor of a unit modulus (mm^0.5).
    pub hertz: f64,
    /// Coefficients of `q`, at most [`MAX_TERMS`].
    pub coefficients: Vec<f64>,
}

impl ForceSlice {
    /// Force over shear modulus (mm^2) and its slope (mm) at a depth (mm).
    #[must_use]
    pub fn force_and_slope(&self, depth_mm: f64) -> (f64, f64) {
        if depth_mm <= 0.0 {
            return (0.0, 0.0);
        }
        let d = depth_mm.min(self.depth_max_mm);
        let s = (d / self.depth_max_mm).sqrt();
        let n = self.coefficients.len();
        let (mut value, mut slope) = ([0.0; MAX_TERMS], [0.0; MAX_TERMS]);
        polynomials(2.0 * s - 1.0, &mut value[..n], &mut slope[..n]);
        let (mut q, mut dq) = (0.0, 0.0);
        for ((c, t), dt) in self.coefficients.iter().zip(&value).zip(&slope) {
            q += c * t;
            dq += 2.0 * c * dt;
        }
        let force = self.hertz * d * d.sqrt() * (s * q).exp();
        let by_depth = force * (1.5 + 0.5 * s * (q + s * dq)) / d;
        (force + by_depth * (depth_mm - d), by_depth)
    }

    /// Adds `by` times the difference of two other slices of the same depth: what a parameter changes there.
    #[must_use]
    pub fn moved(mut self, from: &Self, to: &Self) -> Self {
        self.hertz *= to.hertz / from.hertz;
        for (own, (a, b)) in self.coefficients.iter_mut().zip(from.coefficients.iter().zip(&to.coefficients)) {
            *own += b - a;
        }
        self
    }
}
