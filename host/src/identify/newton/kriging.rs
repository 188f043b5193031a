//! Gradient-enhanced universal kriging (Morris, Mitchell and Ylvisaker 1993, doi:10.1080/00401706.1993.10485320): the smoothest function
//! with given values and slopes, of a linear trend and a Matern correlation of smoothness 7/2.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// Added to the diagonal of the correlation of values, so that nearly equal points can stand beside each other: the first a ten-thousandth of the
/// scatter about the trend, the others where rounding asks for more.
const NUGGETS: [f64; 3] = [1e-8, 1e-7, 1e-6];
/// The same of slopes, the likeliest of which is taken: where elements come into contact one by one a slope is off by up to a hundredth of its scatter.
const SLOPES: [f64; 4] = [1e-8, 1e-6, 1e-5, 1e-4];
/// Correlation lengths, in ranges, between which the likeliest is sought, its first guess and the factor of a step.
const LENGTHS: (f64, f64) = (0.08, 8.0);
const FIRST_LENGTH: f64 = 1.0;
const STEP: f64 = 1.6;
const ROUNDS: usize = 1;

/// A solved point: coordinates, values, and the values' derivatives by each coordinate.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// Where.
    pub x: Vec<f64>,
    /// Values.
    pub value: Vec<f64>,
    /// Derivatives, `by[coordinate][value]`.
    pub by: Vec<Vec<f64>>,
}

/// How far one point tells of another.
#[derive(Debug, Clone, PartialEq)]
pub struct Reach {
    /// Correlation length of every coordinate.
    pub lengths: Vec<f64>,
    /// Variance of a slope's error, as a part of its scatter's.
    pub slope: f64,
}

/// The interpolating function.
#[derive(Debug, Clone, PartialEq)]
pub struct Kriging {
    /// How far one point tells of another.
    pub reach: Reach,
    /// Scaled points.
    points: Vec<Vec<f64>>,
    /// Of value and slopes of every point, a row each, a column a value.
    weights: DMatrix<f64>,
    /// Constant and slopes of the trend in scaled coordinates.
    trend: DMatrix<f64>,
}

impl Kriging {
    /// Through all points; correlations as given, or the likeliest, sought from `reach` (in the coordinates' units).
    ///
    /// `None` where the points are not finite.
    #[must_use]
    pub fn through(known: &[Node], widths: &[f64], reach: Option<&Reach>, seek: bool) -> Option<Self> {
        let mut reach = match reach {
            Some(own) if own.lengths.len() == widths.len() => own.clone(),
            _ => Reach { lengths: widths.iter().map(|w| FIRST_LENGTH * w).collect(), slope: SLOPES[0] },
        };
        if seek {
            reach = sought(known, widths, reach);
        }
        let solved = Solved::of(known, &reach)?;
        Some(Self { points: scaled(known, &reach.lengths), reach, weights: solved.weights, trend: solved.trend })
    }

    /// Values at a point.
    #[must_use]
    pub fn at(&self, x: &[f64]) -> Vec<f64> {
        let count = x.len();
        let at: Vec<f64> = x.iter().zip(&self.reach.lengths).map(|(x, length)| ROOT * x / length).collect();
        let mut value: Vec<f64> = self.trend.row(0).iter().copied().collect();
        for (axis, at) in at.iter().enumerate() {
            value.iter_mut().zip(self.trend.row(1 + axis).iter()).for_each(|(v, t)| *v += at * t);
        }
        let mut share = DVector::zeros(self.weights.nrows());
        for (j, point) in self.points.iter().enumerate() {
            let u: Vec<f64> = at.iter().zip(point).map(|(a, b)| a - b).collect();
            let (own, slope, _) = correlation(u.iter().map(|u| u * u).sum::<f64>().sqrt());
            share[j * (count + 1)] = own;
            for (k, u) in u.iter().enumerate() {
                share[j * (count + 1) + 1 + k] = slope * u;
            }
        }
        let sum = self.weights.tr_mul(&share);
        value.iter_mut().zip(sum.iter()).for_each(|(v, s)| *v += s);
        value
    }
}

/// The likeliest correlations near given ones, one coordinate after the other; the error of slopes before and after.
fn sought(known: &[Node], widths: &[f64], reach: Reach) -> Reach {
    let unlikely = |reach: &Reach| Solved::of(known, reach).map_or(f64::INFINITY, |solved| solved.unlikely);
    let mut best = (unlikely(&reach), reach);
    let better = |best: &mut (f64, Reach), next: Reach| {
        let there = unlikely(&next);
        let is_better = there < best.0;
        if is_better {
            *best = (there, next);
        }
        is_better
    };
    let with_slopes = |best: &mut (f64, Reach)| {
        for slope in SLOPES {
            let next = Reach { slope, ..best.1.clone() };
            better(best, next);
        }
    };
    with_slopes(&mut best);
    for _ in 0..ROUNDS {
        for (axis, width) in widths.iter().enumerate() {
            for factor in [STEP, 1.0 / STEP] {
                loop {
                    let mut next = best.1.clone();
                    next.lengths[axis] *= factor;
                    let is_allowed = (LENGTHS.0 * width..=LENGTHS.1 * width).contains(&next.lengths[axis]);
                    if !is_allowed || !better(&mut best, next) {
                        break;
                    }
                }
            }
        }
    }
    with_slopes(&mut best);
    best.1
}

/// `sqrt(2 nu)` of the Matern correlation of smoothness `nu = 7/2`.
const ROOT: f64 = 2.645_751_311_064_590_6;

/// Correlation at a scaled distance, minus its slope over the distance, and minus the slope of that over the distance.
fn correlation(a: f64) -> (f64, f64, f64) {
    let decay = (-a).exp();
    let square = a * a;
    (
        (1.0 + a + 0.4 * square + a * square / 15.0) * decay,
        (3.0 + 3.0 * a + square) * decay / 15.0,
        (1.0 + a) * decay / 15.0,
    )
}

fn scaled(known: &[Node], lengths: &[f64]) -> Vec<Vec<f64>> {
    known.iter().map(|one| one.x.iter().zip(lengths).map(|(x, length)| ROOT * x / length).collect()).collect()
}

struct Solved {
    weights: DMatrix<f64>,
    trend: DMatrix<f64>,
    /// Minus twice the logarithm of the likelihood, each value with a scatter of its own.
    unlikely: f64,
}

impl Solved {
    fn of(known: &[Node], reach: &Reach) -> Option<Self> {
        let lengths = &reach.lengths;
        let points = scaled(known, lengths);
        let (factor, rows) = (factor(&points, reach.slope)?, points.len() * (lengths.len() + 1));
        let count = lengths.len();
        let values = known.first()?.value.len();
        let mut data = DMatrix::zeros(rows, values);
        let mut basis = DMatrix::zeros(rows, count + 1);
        for (j, one) in known.iter().enumerate() {
            let row = j * (count + 1);
            data.row_mut(row).copy_from_slice(&one.value);
            basis[(row, 0)] = 1.0;
            for axis in 0..count {
                let unit = lengths[axis] / ROOT;
                data.row_mut(row + 1 + axis).iter_mut().zip(&one.by[axis]).for_each(|(d, by)| *d = by * unit);
                basis[(row, 1 + axis)] = points[j][axis];
                basis[(row + 1 + axis, 1 + axis)] = 1.0;
            }
        }
        let whitened = factor.solve(&basis);
        let normal = basis.tr_mul(&whitened).cholesky()?;
        let trend = normal.solve(&whitened.tr_mul(&data));
        let rest = data - &basis * &trend;
        let weights = factor.solve(&rest);
        if weights.iter().any(|w| !w.is_finite()) {
            return None;
        }
        let log_determinant: f64 = 2.0 * factor.l_dirty().diagonal().iter().map(|d| d.ln()).sum::<f64>();
        let scatter =
            (0..values).map(|i| (rest.column(i).dot(&weights.column(i)) / rows as f64).max(f64::MIN_POSITIVE).ln());
        let unlikely = values as f64 * log_determinant + rows as f64 * scatter.sum::<f64>();
        Some(Self { weights, trend, unlikely })
    }
}

/// Factor of the correlation between values and slopes of all points.
fn factor(points: &[Vec<f64>], slope_nugget: f64) -> Option<Cholesky<f64, Dyn>> {
    let count = points.first()?.len();
    let size = count + 1;
    let mut matrix = DMatrix::zeros(points.len() * size, points.len() * size);
    for (i, a) in points.iter().enumerate() {
        for (j, b) in points.iter().enumerate().take(i + 1) {
            let u: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
            let (own, slope, bend) = correlation(u.iter().map(|u| u * u).sum::<f64>().sqrt());
            let (row, column) = (i * size, j * size);
            matrix[(row, column)] = own;
            for k in 0..count {
                matrix[(row, column + 1 + k)] = slope * u[k];
                matrix[(row + 1 + k, column)] = -slope * u[k];
                for l in 0..count {
                    let same = if k == l { slope } else { 0.0 };
                    matrix[(row + 1 + k, column + 1 + l)] = same - bend * u[k] * u[l];
                }
            }
        }
    }
    NUGGETS.iter().find_map(|nugget| {
        let mut raised = matrix.clone();
        let of = |i: usize| if i.is_multiple_of(size) { *nugget } else { slope_nugget.max(*nugget) };
        (0..raised.nrows()).for_each(|i| raised[(i, i)] *= 1.0 + of(i));
        raised.cholesky()
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn bent(x: &[f64]) -> Node {
        let (a, b) = (x[0], x[1]);
        Node {
            x: x.to_vec(),
            value: vec![(a * b).sin() + a, a.exp()],
            by: vec![vec![b * (a * b).cos() + 1.0, a.exp()], vec![a * (a * b).cos(), 0.0]],
        }
    }

    /// Twelve points and their slopes tell a smooth function between them to a thousandth of its range, 2.7.
    #[test]
    fn a_smooth_function_is_found_between_its_points() {
        let places = (0..12).map(|i| [f64::from(i % 4) / 3.0, f64::from(i / 4) / 2.0]);
        let known: Vec<Node> = places.map(|x| bent(&x)).collect();
        let found = Kriging::through(&known, &[1.0, 1.0], None, true).unwrap();
        for i in 0..50 {
            let x = [(f64::from(i) * 0.618_034).fract(), (f64::from(i) * 0.754_878).fract()];
            for (found, exact) in found.at(&x).iter().zip(bent(&x).value) {
                assert!((found - exact).abs() < 2.7e-3, "{x:?} {found} {exact}");
            }
        }
    }
}
