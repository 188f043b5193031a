//! Force over depth as one smooth function with the exact Hertz limit.

use super::chebyshev::{clenshaw_and_slope, least_squares};
use super::relaxed::RampRelaxation;

/// Largest number of terms a profile can have.
pub const MAX_TERMS: usize = 24;

/// One computed force with the relative error it is trusted to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Depth (mm), positive.
    pub depth_mm: f64,
    /// Force (N).
    pub force_n: f64,
    /// Relative standard error for the weight, positive.
    pub error: f64,
}

/// `F(d) = r(d) d^(3/2) [ H + s sum_k c_k T_k(2 s - 1) ]` with `s = sqrt(d / d_max)`.
///
/// `H` is Hertz's factor `4/3 E* sqrt(R)`, exact for `d -> 0` whatever the
/// height and the law (the contact is then small and the strain infinitesimal).
/// What remains is smooth in `s`, the ratio of contact size to its largest. `r` is what
/// relaxation leaves of a Hertz contact under a ramp, 1 for an elastic material.
/// Between 0 and `d_max` the function and its derivative are continuous.
#[derive(Debug, Clone, PartialEq)]
pub struct DepthProfile {
    /// Largest depth (mm).
    pub depth_max_mm: f64,
    /// Hertz factor `H` (N/mm^1.5).
    pub hertz: f64,
    /// Coefficients `c_k` (N/mm^1.5), at most [`MAX_TERMS`].
    pub coefficients: Vec<f64>,
    /// Relaxation during the ramp, none for an elastic material.
    pub relaxation: RampRelaxation,
}

impl DepthProfile {
    /// Least-squares fit with weights `1 / error`; also returns the root mean
    /// square of the relative residuals of the samples at or beyond `from_mm`.
    #[must_use]
    pub fn fit(
        samples: &[Sample],
        depth_max_mm: f64,
        hertz: f64,
        relaxation: RampRelaxation,
        terms: usize,
        from_mm: f64,
    ) -> (Self, f64) {
        let point = |p: &Sample| {
            let s = (p.depth_mm / depth_max_mm).sqrt();
            let g = p.force_n / (relaxation.factor(p.depth_mm).0 * p.depth_mm.powf(1.5));
            (2.0 * s - 1.0, (g - hertz) / s, s / (p.error * g))
        };
        let points: Vec<(f64, f64, f64)> = samples.iter().map(point).collect();
        let coefficients = least_squares(&points, terms.min(MAX_TERMS));
        let profile = Self { depth_max_mm, hertz, coefficients, relaxation };
        let misses: Vec<f64> = samples
            .iter()
            .filter(|p| p.depth_mm >= from_mm)
            .map(|p| profile.force_n(p.depth_mm) / p.force_n - 1.0)
            .collect();
        let square = misses.iter().map(|x| x * x).sum::<f64>() / misses.len().max(1) as f64;
        (profile, square.sqrt())
    }

    /// Force (N) at a depth; 0 for `depth <= 0`, the linear continuation beyond the range.
    #[must_use]
    pub fn force_n(&self, depth_mm: f64) -> f64 {
        self.force_and_slope(depth_mm).0
    }

    /// Force (N) and `dF/dd` (N/mm).
    #[must_use]
    pub fn force_and_slope(&self, depth_mm: f64) -> (f64, f64) {
        if depth_mm <= 0.0 {
            return (0.0, 0.0);
        }
        let d = depth_mm.min(self.depth_max_mm);
        let s = (d / self.depth_max_mm).sqrt();
        let (q, half) = clenshaw_and_slope(&self.coefficients, 2.0 * s - 1.0);
        let dq = 2.0 * half;
        let (f, df) = assemble(d, s, self.hertz, q, dq);
        let (r, dr) = self.relaxation.factor(d);
        let (f, df) = (r * f, r * df + dr * f);
        (f + df * (depth_mm - d), df)
    }
}

/// `F` and `dF/dd` from `q(s)` and `dq/ds`; `ds/dd = s / (2 d)`.
pub fn assemble(d: f64, s: f64, hertz: f64, q: f64, dq: f64) -> (f64, f64) {
    let root = d.sqrt();
    let g = hertz + s * q;
    let dg = (q + s * dq) * s / (2.0 * d);
    (d * root * g, root * (1.5 * g + d * dg))
}
