//! The force of a unit shear modulus over depth, at one place of a force model.

use super::chebyshev::{clenshaw, clenshaw_and_slope, clenshaw_and_slope_each, clenshaw_each};

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
        let (force, by_depth) = self.both(d, s, clenshaw_and_slope(&self.coefficients, 2.0 * s - 1.0));
        (force + by_depth * (depth_mm - d), by_depth)
    }

    /// The same within what was solved, from `q` and its slope by `2 s`.
    fn both(&self, depth_mm: f64, s: f64, (q, half): (f64, f64)) -> (f64, f64) {
        let force = self.within(depth_mm, s * q);
        (force, force * (1.5 + 0.5 * s * (q + s * 2.0 * half)) / depth_mm)
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
        some_at_once(depth_mm, |some, count| {
            let (s, places) = self.roots(&some);
            let q = clenshaw_each(&self.coefficients, places);
            for (d, (s, q)) in some.into_iter().zip(s.into_iter().zip(q)).take(count) {
                take(if self.is_solved(d) { self.within(d, s * q) } else { self.force(d) });
            }
        });
    }

    /// [`Self::force_and_slope`] at some depths (mm), handed over one after the other.
    pub fn forces_and_slopes(&self, depth_mm: impl Iterator<Item = f64>, mut take: impl FnMut((f64, f64))) {
        some_at_once(depth_mm, |some, count| {
            let (s, places) = self.roots(&some);
            let (q, half) = clenshaw_and_slope_each(&self.coefficients, places);
            for (i, d) in some.into_iter().enumerate().take(count) {
                let solved = self.is_solved(d);
                take(if solved { self.both(d, s[i], (q[i], half[i])) } else { self.force_and_slope(d) });
            }
        });
    }

    /// `s` and `2 s - 1`, within what was solved.
    fn roots(&self, depth_mm: &[f64; AT_ONCE]) -> ([f64; AT_ONCE], [f64; AT_ONCE]) {
        let (mut roots, mut places) = ([0.0; AT_ONCE], [0.0; AT_ONCE]);
        for (i, d) in depth_mm.iter().enumerate() {
            roots[i] = (d.clamp(0.0, self.depth_max_mm) / self.depth_max_mm).sqrt();
            places[i] = 2.0 * roots[i] - 1.0;
        }
        (roots, places)
    }

    fn is_solved(&self, depth_mm: f64) -> bool {
        depth_mm > 0.0 && depth_mm <= self.depth_max_mm
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

/// Depths that are computed at once.
const AT_ONCE: usize = 8;

/// Hands over some numbers at a time, and how many of them there are.
fn some_at_once(numbers: impl Iterator<Item = f64>, mut take: impl FnMut([f64; AT_ONCE], usize)) {
    let mut numbers = numbers.peekable();
    while numbers.peek().is_some() {
        let mut some = [0.0; AT_ONCE];
        let count = some.iter_mut().zip(numbers.by_ref()).map(|(place, d)| *place = d).count();
        take(some, count);
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
        let mut each = Vec::new();
        slice.forces_and_slopes(depth_mm(), |both| each.push(both));
        assert_eq!(each, depth_mm().map(|d| slice.force_and_slope(d)).collect::<Vec<_>>());
    }
}
