//! The force of a unit shear modulus over depth, at one place of a force model.

use super::chebyshev::{clenshaw, clenshaw_and_slope, clenshaw_each};

/// `F / mu = H d^(3/2) exp(s q(s))` with `s = sqrt(d / d_max)`: 0 for `d <= 0`, continued linearly beyond `d_max`.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceSlice {
    /// Largest depth (mm) that was solved.
    pub depth_max_mm: f64,
    /// Hertz's factor of a unit modulus (mm^0.5).
    pub hertz: f64,
    /// Coefficients of `q`.
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
        let (q, half) = clenshaw_and_slope(&self.coefficients, 2.0 * s - 1.0);
        let dq = 2.0 * half;
        let force = self.hertz * d * d.sqrt() * (s * q).exp();
        let by_depth = force * (1.5 + 0.5 * s * (q + s * dq)) / d;
        (force + by_depth * (depth_mm - d), by_depth)
    }

    /// Force over shear modulus (mm^2) at a depth (mm) alone: a third of the work of force and slope.
    #[must_use]
    pub fn force(&self, depth_mm: f64) -> f64 {
        if depth_mm > self.depth_max_mm {
            return self.force_and_slope(depth_mm).0;
        }
        if depth_mm <= 0.0 {
            return 0.0;
        }
        let s = (depth_mm / self.depth_max_mm).sqrt();
        self.within(depth_mm, s * clenshaw(&self.coefficients, 2.0 * s - 1.0))
    }

    /// The same within what was solved, from the exponent `s q(s)` there.
    fn within(&self, depth_mm: f64, exponent: f64) -> f64 {
        self.hertz * depth_mm * depth_mm.sqrt() * exponent.exp()
    }

    /// The same at some depths (mm), handed over one after the other.
    pub fn forces(&self, depth_mm: impl Iterator<Item = f64>, mut take: impl FnMut(f64)) {
        const AT_ONCE: usize = 8;
        let mut depth_mm = depth_mm.peekable();
        while depth_mm.peek().is_some() {
            let mut some = [0.0; AT_ONCE];
            let count = some.iter_mut().zip(depth_mm.by_ref()).map(|(place, d)| *place = d).count();
            let s = some.map(|d| (d.clamp(0.0, self.depth_max_mm) / self.depth_max_mm).sqrt());
            let q = clenshaw_each(&self.coefficients, s.map(|s| 2.0 * s - 1.0));
            for (d, (s, q)) in some.into_iter().zip(s.into_iter().zip(q)).take(count) {
                let solved = d > 0.0 && d <= self.depth_max_mm;
                take(if solved { self.within(d, s * q) } else { self.force(d) });
            }
        }
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

#[cfg(test)]
mod tests {
    use super::*;

    /// To rounding: coefficients below 2, an exponent below 5.
    #[test]
    fn the_force_alone_is_that_beside_the_slope() {
        let coefficients = vec![1.3, -0.7, 0.4, 0.21, -0.05, 0.011];
        let slice = ForceSlice { depth_max_mm: 3.0, hertz: 2.1, coefficients };
        for k in -2..50 {
            let depth_mm = 0.07 * f64::from(k);
            let (both, alone) = (slice.force_and_slope(depth_mm).0, slice.force(depth_mm));
            assert!((both - alone).abs() <= 1e-13 * both.abs(), "{depth_mm}: {both} {alone}");
        }
        // some at once, to the bit: before contact, within and beyond what was solved
        let depth_mm = || (-2..50).map(|k| 0.07 * f64::from(k));
        let mut each = Vec::new();
        slice.forces(depth_mm(), |force| each.push(force));
        assert_eq!(each, depth_mm().map(|d| slice.force(d)).collect::<Vec<f64>>());
    }
}
