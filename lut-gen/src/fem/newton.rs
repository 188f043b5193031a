//! The least of an energy: Newton's method with a line search, and corrections by the last factor in between.

use super::krylov::dot;
use super::secant::Secants;
use super::sparse::{Factor, Pattern};

/// An energy over free unknowns, with its slope and curvature.
pub trait Energy {
    /// Energy at `x`, its slope into `slope`; `None` where `x` is impossible.
    fn slope(&self, x: &[f64], slope: &mut [f64]) -> Option<f64>;

    /// The same with the curvature into the values of the lower triangle of a pattern.
    fn curvature(&self, x: &[f64], slope: &mut [f64], values: &mut [f64]) -> Option<f64>;
}

/// Settings of the method.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Newton {
    /// Norm of the slope that is no more than rounding and may stay.
    pub close: f64,
    /// Factorisations before it is given up.
    pub steps: usize,
    /// A correction by an old factor is made as long as the norm falls to this part of itself.
    pub chord: f64,
    /// Part by which the diagonal of a curvature that is not positive definite grows at first; with 0 the method stops
    /// there.
    pub growth: f64,
}

/// A least energy, or where the method stopped.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Found {
    /// Factorisations.
    pub steps: usize,
    /// Norm of the slope there.
    pub left: f64,
    /// It is below [`Newton::close`].
    pub closed: bool,
}

/// Part of the fall that the slope promises which a step must bring (Armijo's rule).
const ARMIJO: f64 = 1e-4;
/// What rounding may leave of an energy, as a part of it: sums over many elements of either sign.
const ROUNDING: f64 = 1e-10;
/// Largest growth of a diagonal: ten times itself and more is steepest descent.
const MOST_GROWN: f64 = 10.0;
/// Shortest part of a correction that is tried.
const SHORTEST: f64 = 1e-4;

impl Newton {
    /// Moves `x` to the least of the energy. The curvature there must be positive definite, and on the way as well unless
    /// [`Newton::growth`] helps: a convex energy, or a start near enough.
    pub fn minimise(&self, energy: &impl Energy, pattern: &Pattern, factor: &mut Factor, x: &mut Vec<f64>) -> Found {
        let mut values = vec![0.0; pattern.entries()];
        let mut walk = Walk::new(std::mem::take(x));
        let mut found = Found { steps: 0, left: f64::INFINITY, closed: false };
        if let Some(first) = energy.slope(&walk.at.x, &mut walk.at.slope) {
            walk.at.energy = first;
            found.left = norm(&walk.at.slope);
        }
        while found.left.is_finite() && found.left > self.close && found.steps < self.steps {
            let curved = energy.curvature(&walk.at.x, &mut walk.at.slope, &mut values).is_some();
            if !curved || !self.factorise(pattern, factor, &mut values) {
                break;
            }
            found.steps += 1;
            walk.secants.clear();
            if !walk.descend(energy, factor) {
                break;
            }
            let mut before = found.left;
            found.left = norm(&walk.at.slope);
            while found.left > self.close && found.left <= self.chord * before && walk.correct(energy, factor) {
                before = found.left;
                found.left = norm(&walk.at.slope);
            }
        }
        found.closed = found.left <= self.close;
        *x = walk.at.x;
        found
    }

    /// Factorises a curvature; of one that is not positive definite the diagonal grows until it is, so that the way is
    /// still down. False where nothing helps.
    fn factorise(&self, pattern: &Pattern, factor: &mut Factor, values: &mut [f64]) -> bool {
        let mut grown = self.growth;
        let own: Vec<f64> = pattern.diagonal().iter().map(|d| values[*d]).collect();
        while !factor.factorise(pattern, values) {
            if !(grown > 0.0 && grown <= MOST_GROWN) {
                return false;
            }
            pattern.diagonal().iter().zip(&own).for_each(|(d, own)| values[*d] = own + grown * own.abs());
            grown *= 10.0;
        }
        true
    }
}

/// A point with its energy and slope.
struct Place {
    x: Vec<f64>,
    energy: f64,
    slope: Vec<f64>,
}

/// The way down.
struct Walk {
    at: Place,
    /// The next place, and what leads there.
    next: Place,
    change: Vec<f64>,
    secants: Secants,
}

impl Walk {
    fn new(x: Vec<f64>) -> Self {
        let zero = vec![0.0; x.len()];
        let place = |x| Place { x, energy: f64::NAN, slope: zero.clone() };
        Self { next: place(zero.clone()), at: place(x), change: zero.clone(), secants: Secants::default() }
    }

    /// Fills the correction.
    fn direct(&mut self, factor: &mut Factor) {
        self.change.copy_from_slice(&self.at.slope);
        self.secants.correct(factor, &mut self.change);
    }

    /// Looks at the place that a part of the correction leads to. False where it is impossible.
    fn look(&mut self, energy: &impl Energy, part: f64) -> bool {
        for ((next, x), change) in self.next.x.iter_mut().zip(&self.at.x).zip(&self.change) {
            *next = x - part * change;
        }
        let reached = energy.slope(&self.next.x, &mut self.next.slope);
        self.next.energy = reached.unwrap_or(f64::INFINITY);
        reached.is_some()
    }

    fn go(&mut self) {
        self.secants.learn((&self.at.x, &self.at.slope), (&self.next.x, &self.next.slope));
        std::mem::swap(&mut self.at, &mut self.next);
    }

    /// A step by a factor of here, as short as the energy wants it. False where none is short enough.
    fn descend(&mut self, energy: &impl Energy, factor: &mut Factor) -> bool {
        self.direct(factor);
        let fall = dot(&self.change, &self.at.slope);
        let mut part = 1.0;
        while part > SHORTEST {
            self.look(energy, part);
            if self.is_lower(part, fall) {
                self.go();
                return true;
            }
            part *= 0.5;
        }
        false
    }

    /// True when a part of the correction brings what it promises: by the energy, or where rounding hides that, by the slope
    /// along the way (Hager and Zhang 2005, doi:10.1137/030601880, eq. 2.3).
    fn is_lower(&self, part: f64, fall: f64) -> bool {
        let risen = self.next.energy - self.at.energy;
        let turned = -dot(&self.change, &self.next.slope);
        let hidden = risen <= ROUNDING * self.at.energy.abs() && turned <= (1.0 - 2.0 * ARMIJO) * fall;
        risen <= -ARMIJO * part * fall || hidden
    }

    /// A correction by the last factor and the steps since; false where the slope does not fall.
    fn correct(&mut self, energy: &impl Energy, factor: &mut Factor) -> bool {
        self.direct(factor);
        let better = self.look(energy, 1.0) && norm(&self.next.slope) < norm(&self.at.slope);
        if better {
            self.go();
        }
        better
    }
}

fn norm(x: &[f64]) -> f64 {
    dot(x, x).sqrt()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::sparse::Stored;
    use super::*;

    /// A chain of springs whose force grows with the cube of their length, pulled at its end.
    struct Chain {
        pull: f64,
    }

    impl Energy for Chain {
        fn slope(&self, x: &[f64], slope: &mut [f64]) -> Option<f64> {
            slope.fill(0.0);
            let mut energy = -self.pull * x[x.len() - 1];
            for i in 0..x.len() {
                let l = x[i] - if i > 0 { x[i - 1] } else { 0.0 };
                energy += 0.5 * l * l + 0.25 * l.powi(4);
                slope[i] += l + l.powi(3);
                if i > 0 {
                    slope[i - 1] -= l + l.powi(3);
                }
            }
            slope[x.len() - 1] -= self.pull;
            Some(energy)
        }

        fn curvature(&self, x: &[f64], slope: &mut [f64], values: &mut [f64]) -> Option<f64> {
            // columns of a tridiagonal lower triangle: diagonal, then the one below
            values.fill(0.0);
            for i in 0..x.len() {
                let l = x[i] - if i > 0 { x[i - 1] } else { 0.0 };
                let k = 1.0 + 3.0 * l * l;
                values[2 * i] += k;
                if i > 0 {
                    values[2 * i - 2] += k;
                    values[2 * i - 1] -= k;
                }
            }
            self.slope(x, slope)
        }
    }

    /// Every spring carries the pull `l + l^3`: 10 at the length 2.
    #[test]
    fn a_chain_of_hardening_springs_is_stretched_alike() {
        let groups: Vec<Vec<usize>> = (1..6).map(|i| vec![i - 1, i]).collect();
        let (pattern, _) = Pattern::new(6, groups.iter().map(Vec::as_slice), Stored::Lower);
        let mut factor = Factor::new(&pattern).unwrap();
        for chord in [0.0, 0.3] {
            let newton = Newton { close: 1e-12, steps: 30, chord, growth: 0.0 };
            let mut x = vec![0.0; 6];
            let found = newton.minimise(&Chain { pull: 10.0 }, &pattern, &mut factor, &mut x);
            assert!(found.closed, "{found:?}");
            for (i, x) in x.iter().enumerate() {
                assert!((x - 2.0 * (i + 1) as f64).abs() < 1e-12, "{i}: {x}");
            }
        }
        let few = Newton { close: 1e-12, steps: 2, chord: 0.0, growth: 0.0 };
        assert!(!few.minimise(&Chain { pull: 10.0 }, &pattern, &mut factor, &mut vec![0.0; 6]).closed);
    }

    /// Two wells `(x^2 - 1)^2 / 4`, from between them, where the curvature is negative.
    struct Wells;

    impl Energy for Wells {
        fn slope(&self, x: &[f64], slope: &mut [f64]) -> Option<f64> {
            slope.iter_mut().zip(x).for_each(|(s, x)| *s = x * (x * x - 1.0));
            Some(x.iter().map(|x| 0.25 * (x * x - 1.0).powi(2)).sum())
        }

        fn curvature(&self, x: &[f64], slope: &mut [f64], values: &mut [f64]) -> Option<f64> {
            values.iter_mut().zip(x).for_each(|(v, x)| *v = 3.0 * x * x - 1.0);
            self.slope(x, slope)
        }
    }

    #[test]
    fn a_negative_curvature_is_left_downhill() {
        let groups = [vec![0], vec![1]];
        let (pattern, _) = Pattern::new(2, groups.iter().map(Vec::as_slice), Stored::Lower);
        let mut factor = Factor::new(&pattern).unwrap();
        let mut from = |growth: f64| {
            let mut x = vec![0.1, -0.2];
            let newton = Newton { close: 1e-12, steps: 30, chord: 0.0, growth };
            (newton.minimise(&Wells, &pattern, &mut factor, &mut x).closed, x)
        };
        assert!(!from(0.0).0);
        let (closed, x) = from(1e-3);
        assert!(closed && (x[0] - 1.0).abs() < 1e-12 && (x[1] + 1.0).abs() < 1e-12, "{x:?}");
    }
}
