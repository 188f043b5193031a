//! Chebyshev polynomials on an axis of a parameter.

use faer::Mat;
use faer::linalg::solvers::{Solve, SolveLstsq};
use serde::{Deserialize, Serialize};

/// The coordinate in which a parameter is resolved evenly.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Scale {
    /// The value itself.
    Linear,
    /// Its logarithm.
    Log,
    /// Its reciprocal.
    Reciprocal,
    /// The logarithm of 1 and five times it, for Poisson's ratios from 0 on: the logarithm of a foam's force bends most at small ones, the more so the larger its exponent. With five nodes up to 0.38
    /// what such a ratio changes is met to 0.01 to 0.1 % (exponents to 15; 0.3 % at 22), as with six that are even in the ratio itself.
    Poisson,
}

/// See [`Scale::Poisson`].
const BENT: f64 = 5.0;

impl Scale {
    fn to(self, v: f64) -> f64 {
        match self {
            Self::Linear => v,
            Self::Log => v.ln(),
            Self::Reciprocal => 1.0 / v,
            Self::Poisson => (BENT * v).ln_1p(),
        }
    }

    fn from(self, t: f64) -> f64 {
        match self {
            Self::Linear => t,
            Self::Log => t.exp(),
            Self::Reciprocal => 1.0 / t,
            Self::Poisson => t.exp_m1() / BENT,
        }
    }

    fn slope(self, v: f64) -> f64 {
        match self {
            Self::Linear => 1.0,
            Self::Log => 1.0 / v,
            Self::Reciprocal => -1.0 / (v * v),
            Self::Poisson => BENT / (1.0 + BENT * v),
        }
    }
}

/// A parameter axis with `n` Chebyshev nodes (of the first kind) between two ends.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Axis {
    /// Lower end of the range.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// Number of nodes, at least 1; with one node the axis is constant.
    pub nodes: usize,
    /// Coordinate in which the nodes are spread.
    pub scale: Scale,
}

impl Axis {
    /// The parameter's value at node `k`; for one node the lower end.
    #[must_use]
    pub fn node(&self, k: usize) -> f64 {
        if self.nodes == 1 {
            return self.low;
        }
        self.value((std::f64::consts::PI * (k as f64 + 0.5) / self.nodes as f64).cos())
    }

    /// The parameter's value at `x` in [-1, 1].
    #[must_use]
    pub fn value(&self, x: f64) -> f64 {
        let (a, b) = (self.scale.to(self.low), self.scale.to(self.high));
        self.scale.from(0.5 * (a + b) + 0.5 * (b - a) * x)
    }

    /// `x` in [-1, 1] of a value and `dx/dvalue`. Outside the range the end is
    /// taken with slope 0, so the interpolant is continued as a constant.
    #[must_use]
    pub fn local(&self, v: f64) -> (f64, f64) {
        if self.nodes == 1 {
            return (0.0, 0.0);
        }
        let (a, b) = (self.scale.to(self.low), self.scale.to(self.high));
        let x = (2.0 * self.scale.to(v) - a - b) / (b - a);
        if (-1.0..=1.0).contains(&x) { (x, 2.0 * self.scale.slope(v) / (b - a)) } else { (x.clamp(-1.0, 1.0), 0.0) }
    }

    /// The interpolant of the given coefficients at a value of the parameter.
    #[must_use]
    pub fn evaluate(&self, coefficients: &[f64], v: f64) -> f64 {
        clenshaw(coefficients, self.local(v).0)
    }

    /// Coefficients of the polynomial with these values and derivatives by the parameter at the nodes: twice as many.
    #[must_use]
    pub fn osculating(&self, values: &[f64], slopes: &[f64]) -> Vec<f64> {
        let n = self.nodes;
        let mut matrix = Mat::<f64>::zeros(2 * n, 2 * n);
        let mut right = Mat::<f64>::zeros(2 * n, 1);
        let (mut value, mut slope) = (vec![0.0; 2 * n], vec![0.0; 2 * n]);
        for k in 0..n {
            let (x, dx) = self.local(self.node(k));
            polynomials(x, &mut value, &mut slope);
            for j in 0..2 * n {
                matrix[(2 * k, j)] = value[j];
                matrix[(2 * k + 1, j)] = slope[j] * dx;
            }
            right[(2 * k, 0)] = values[k];
            right[(2 * k + 1, 0)] = slopes[k];
        }
        let solution = matrix.partial_piv_lu().solve(&right);
        (0..2 * n).map(|j| solution[(j, 0)]).collect()
    }

    /// Derivatives at the nodes of the interpolant of the values there.
    #[must_use]
    pub fn derivatives(&self, values: &[f64]) -> Vec<f64> {
        let coefficients = self.coefficients(values);
        (0..self.nodes)
            .map(|k| {
                let (x, dx) = self.local(self.node(k));
                clenshaw_and_slope(&coefficients, x).1 * dx
            })
            .collect()
    }

    /// Coefficients of the interpolant of the values at the nodes.
    #[must_use]
    pub fn coefficients(&self, values: &[f64]) -> Vec<f64> {
        let n = self.nodes;
        (0..n)
            .map(|j| {
                let sum: f64 = (0..n)
                    .map(|k| {
                        let angle = std::f64::consts::PI * j as f64 * (k as f64 + 0.5) / n as f64;
                        values[k] * angle.cos()
                    })
                    .sum();
                sum * if j == 0 { 1.0 } else { 2.0 } / n as f64
            })
            .collect()
    }
}

/// The sum of `c_k T_k(x)`, by Clenshaw's recurrence.
#[must_use]
pub fn clenshaw(coefficients: &[f64], x: f64) -> f64 {
    let [value] = clenshaw_each(coefficients, [x]);
    value
}

/// The same at some places, to the bit: a step of the recurrence waits for the one before, those of other places do not.
#[must_use]
pub fn clenshaw_each<const N: usize>(coefficients: &[f64], x: [f64; N]) -> [f64; N] {
    let (mut one, mut two) = ([0.0; N], [0.0; N]);
    let Some((first, others)) = coefficients.split_first() else { return one };
    // loops and no closures, which are not inlined in every profile
    for c in others.iter().rev() {
        for i in 0..N {
            (one[i], two[i]) = (2.0 * x[i] * one[i] - two[i] + c, one[i]);
        }
    }
    for i in 0..N {
        one[i] = x[i] * one[i] - two[i] + first;
    }
    one
}

/// The same with its derivative by `x`: the recurrence is differentiated.
#[must_use]
pub fn clenshaw_and_slope(coefficients: &[f64], x: f64) -> (f64, f64) {
    let ([value], [slope]) = clenshaw_and_slope_each(coefficients, [x]);
    (value, slope)
}

/// The same at some places at once.
#[must_use]
pub fn clenshaw_and_slope_each<const N: usize>(coefficients: &[f64], x: [f64; N]) -> ([f64; N], [f64; N]) {
    let (mut one, mut two) = ([0.0; N], [0.0; N]);
    let (mut by_one, mut by_two) = ([0.0; N], [0.0; N]);
    let Some((first, others)) = coefficients.split_first() else { return (one, by_one) };
    for c in others.iter().rev() {
        for i in 0..N {
            (by_one[i], by_two[i]) = (2.0 * (one[i] + x[i] * by_one[i]) - by_two[i], by_one[i]);
            (one[i], two[i]) = (2.0 * x[i] * one[i] - two[i] + c, one[i]);
        }
    }
    for i in 0..N {
        by_one[i] = one[i] + x[i] * by_one[i] - by_two[i];
        one[i] = x[i] * one[i] - two[i] + first;
    }
    (one, by_one)
}

/// Coefficients of the sum of so many polynomials that comes closest to points `(x, y)` with weights, `x` in -1..1: fewer where there are fewer points.
#[must_use]
pub fn least_squares(points: &[(f64, f64, f64)], terms: usize) -> Vec<f64> {
    let terms = terms.min(points.len());
    let mut matrix = Mat::<f64>::zeros(points.len(), terms);
    let mut right = Mat::<f64>::zeros(points.len(), 1);
    let (mut value, mut slope) = (vec![0.0; terms], vec![0.0; terms]);
    for (i, (x, y, weight)) in points.iter().enumerate() {
        polynomials(*x, &mut value, &mut slope);
        for (k, t) in value.iter().enumerate() {
            matrix[(i, k)] = weight * t;
        }
        right[(i, 0)] = weight * y;
    }
    let solution = matrix.qr().solve_lstsq(&right);
    (0..terms).map(|k| solution[(k, 0)]).collect()
}

/// `T_0 .. T_{n-1}` and their derivatives at `x`, into the given slices.
pub fn polynomials(x: f64, value: &mut [f64], slope: &mut [f64]) {
    for k in 0..value.len() {
        (value[k], slope[k]) = match k {
            0 => (1.0, 0.0),
            1 => (x, 1.0),
            _ => (2.0 * x * value[k - 1] - value[k - 2], 2.0 * (value[k - 1] + x * slope[k - 1]) - slope[k - 2]),
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `T_k(cos t) = cos(k t)`, whose derivative by the cosine is `k sin(k t) / sin(t)`; to rounding of seven terms below 2, each of slope below 36.
    #[test]
    fn sums_and_slopes_are_those_of_the_polynomials() {
        let coefficients = [0.3, -1.2, 0.7, 0.0, 0.11, -0.05, 1.9];
        for step in 1..40 {
            let t = 0.078 * f64::from(step);
            let (value, slope) = clenshaw_and_slope(&coefficients, t.cos());
            let own = |k: usize, c: &f64| {
                let angle = k as f64 * t;
                (c * angle.cos(), c * k as f64 * angle.sin() / t.sin())
            };
            let each = coefficients.iter().enumerate().map(|(k, c)| own(k, c));
            let (sum, by_x) = each.fold((0.0, 0.0), |(a, b), (v, s)| (a + v, b + s));
            assert!((value - sum).abs() < 1e-13 && (slope - by_x).abs() < 1e-11, "{t}: {value} {sum}, {slope} {by_x}");
            assert!((clenshaw(&coefficients, t.cos()) - value).abs() < 1e-15);
            let each = [t.cos(), t.sin(), 0.0];
            assert_eq!(clenshaw_each(&coefficients, each), each.map(|x| clenshaw(&coefficients, x)));
            let (values, slopes) = clenshaw_and_slope_each(&coefficients, each);
            let both: [(f64, f64); 3] = std::array::from_fn(|i| (values[i], slopes[i]));
            assert_eq!(both, each.map(|x| clenshaw_and_slope(&coefficients, x)));
        }
        assert_eq!(clenshaw_and_slope(&[], 0.5), (0.0, 0.0));
        assert_eq!(clenshaw_and_slope(&[2.0], 0.5), (2.0, 0.0));
        assert_eq!(clenshaw_and_slope(&[2.0, 3.0], 0.5), (3.5, 3.0));
    }

    /// Values and slopes at three nodes give a polynomial of six terms, over a logarithm as well; values alone give the slopes of one of three. To rounding.
    #[test]
    fn a_polynomial_is_known_from_its_values_and_slopes() {
        let axis = Axis { low: 1.8, high: 26.0, nodes: 3, scale: Scale::Log };
        let coefficients = [0.3, -1.2, 0.7, 0.2, 0.11, -0.05];
        let at = |c: &[f64], v: f64| {
            let (x, dx) = axis.local(v);
            let (value, slope) = clenshaw_and_slope(c, x);
            (value, slope * dx)
        };
        let sampled = |c: &[f64]| -> (Vec<f64>, Vec<f64>) { (0..3).map(|k| at(c, axis.node(k))).unzip() };
        let (values, slopes) = sampled(&coefficients);
        let found = axis.osculating(&values, &slopes);
        assert!(found.len() == 6 && found.iter().zip(coefficients).all(|(f, c)| (f - c).abs() < 1e-12), "{found:?}");
        let (values, slopes) = sampled(&coefficients[..3]);
        assert!(axis.derivatives(&values).iter().zip(&slopes).all(|(a, b)| (a - b).abs() < 1e-12));
    }

    /// A polynomial is met exactly, to rounding; a wave beside it, one point on each of its crests, is left out as far as the points lie evenly about it.
    #[test]
    fn what_is_smooth_is_kept_and_waves_are_not() {
        let smooth = |x: f64| 1.3 + 0.4 * x - 0.2 * x * x + 0.1 * x.powi(3);
        let x = |k: i32| f64::from(k) / 20.0 - 1.0;
        let exact: Vec<(f64, f64, f64)> = (0..=40).map(|k| (x(k), smooth(x(k)), 1.0 + 0.5 * x(k))).collect();
        let found = least_squares(&exact, 6);
        assert!(exact.iter().all(|(x, y, _)| (clenshaw(&found, *x) - y).abs() < 1e-12));
        let waved: Vec<(f64, f64, f64)> =
            exact.iter().enumerate().map(|(k, p)| (p.0, p.1 + if k % 2 == 0 { 1e-3 } else { -1e-3 }, p.2)).collect();
        let found = least_squares(&waved, 6);
        // inside: of 41 points of alternating sign six terms keep a sixth at most
        let inside = exact.iter().filter(|(x, ..)| x.abs() < 0.9);
        assert!(inside.into_iter().all(|(x, y, _)| (clenshaw(&found, *x) - y).abs() < 1.7e-4));
        assert_eq!(least_squares(&exact[..2], 6).len(), 2);
    }

    /// Every scale is undone by its inverse, and its slope is that of a difference quotient.
    #[test]
    fn scales_are_undone_and_slope_as_they_say() {
        for scale in [Scale::Linear, Scale::Log, Scale::Reciprocal, Scale::Poisson] {
            for v in [0.01, 0.2, 0.38] {
                assert!((scale.from(scale.to(v)) - v).abs() < 1e-14, "{scale:?} {v}");
                let step = 1e-6 * v;
                let quotient = (scale.to(v + step) - scale.to(v - step)) / (2.0 * step);
                assert!((scale.slope(v) / quotient - 1.0).abs() < 1e-8, "{scale:?} {v}");
            }
        }
        assert_eq!(Scale::Poisson.to(0.0), 0.0);
    }
}
