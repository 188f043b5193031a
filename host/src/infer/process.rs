//! Shapes of a smooth random function: the leading eigenfunctions of a Gaussian process over an
//! interval.
//!
//! A squared-exponential covariance `exp(-(u - v)^2 / (2 l^2))` on [0, 1] is spanned to a hundredth
//! of its variance by a few functions (Karhunen-Loeve; Rasmussen and Williams 2006, section 4.3).
//! Unlike cosines they are not flat at the ends, where departures of a model are largest.

use nalgebra::DMatrix;

use super::eigen;

/// Points of the grid on which the covariance is solved; between them shapes are straight.
const POINTS: usize = 81;
/// Share of the variance that the shapes hold.
const HELD: f64 = 0.99;

/// Shapes of one process of unit variance.
#[derive(Debug, Clone, PartialEq)]
pub struct Shapes {
    /// A row for each point of the grid, a column for each shape, its standard deviation included.
    values: DMatrix<f64>,
}

impl Shapes {
    /// Of a correlation length, as a share of the interval. Valid above 0.02: below, the grid is
    /// too wide.
    #[must_use]
    pub fn new(length: f64) -> Self {
        let place = |i: usize| i as f64 / (POINTS - 1) as f64;
        let covariance =
            DMatrix::from_fn(POINTS, POINTS, |i, j| (-0.5 * ((place(i) - place(j)) / length).powi(2)).exp());
        let Some(eigen) = eigen::symmetric(covariance) else { return Self { values: DMatrix::zeros(POINTS, 0) } };
        let mut order: Vec<usize> = (0..POINTS).collect();
        order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
        let (mut held, mut count) = (0.0, 0);
        while count < POINTS && held < HELD * POINTS as f64 {
            held += eigen.eigenvalues[order[count]];
            count += 1;
        }
        let scaled =
            |i: usize, j: usize| eigen.eigenvectors[(i, order[j])] * eigen.eigenvalues[order[j]].max(0.0).sqrt();
        Self { values: DMatrix::from_fn(POINTS, count, scaled) }
    }

    /// Number of shapes.
    #[must_use]
    pub fn len(&self) -> usize {
        self.values.ncols()
    }

    /// True where the length was no number.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Value of a shape at a place, which is taken into [0, 1].
    #[must_use]
    pub fn at(&self, shape: usize, u: f64) -> f64 {
        let along = u.clamp(0.0, 1.0) * (POINTS - 1) as f64;
        let first = (along as usize).min(POINTS - 2);
        let part = along - first as f64;
        (1.0 - part) * self.values[(first, shape)] + part * self.values[(first + 1, shape)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is dropped is a hundredth of the variance on average; nowhere more than a few.
    #[test]
    fn shapes_have_the_covariance_of_the_process() {
        for length in [0.15, 0.25, 0.5, 1.0] {
            let shapes = Shapes::new(length);
            for (u, v) in [(0.0, 0.0), (0.3, 0.35), (0.1, 0.6), (1.0, 0.9), (0.505, 0.505)] {
                let found: f64 = (0..shapes.len()).map(|k| shapes.at(k, u) * shapes.at(k, v)).sum();
                let exact = (-0.5 * ((u - v) / length).powi(2_i32)).exp();
                assert!((found - exact).abs() < 0.06, "{length} {u} {v}: {found} {exact}");
            }
        }
        assert!(Shapes::new(f64::NAN).is_empty());
    }

    #[test]
    fn a_longer_process_has_fewer_shapes() {
        let counts: Vec<usize> = [0.15, 0.25, 0.5, 1.0].map(|length| Shapes::new(length).len()).to_vec();
        assert!(counts.windows(2).all(|pair| pair[1] < pair[0]), "{counts:?}");
    }
}
