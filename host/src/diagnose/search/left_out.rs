//! How well a fit predicts conditions that it has not seen, from one fit of all.

use nalgebra::{DMatrix, DVector};

use super::super::coordinate::Coordinate;
use super::super::design::Design;
use super::super::fit::{Fit, Problem};
use crate::infer::product::inner;

/// Minus twice the logarithm of the density that the other groups of conditions predict every group with, to first order about the fit, less what all fits have in common.
/// What the others do not tell of the parameters is in it: a prediction that is uncertain is no wrong one.
pub(super) fn left_out(design: &Design, fit: &Fit, problem: &Problem<'_>) -> f64 {
    let whole = inner(&fit.jacobian, &fit.jacobian) + known_before(&fit.coordinates);
    let log_whole = log_determinant(&whole);
    // what was fitted with errors of its effects allowed for is not where these residuals are least: a slope that is left would pass for a parameter that one group alone moves
    let step = whole.clone().cholesky().map(|c| c.solve(&fit.jacobian.tr_mul(&fit.residual)));
    let least = step.map_or_else(|| fit.residual.clone(), |step| &fit.residual - &fit.jacobian * step);
    let mut sum = 0.0;
    for group in 0..design.groups {
        let rows: Vec<usize> = design
            .series
            .iter()
            .enumerate()
            .filter(|(_, s)| s.group == group)
            .flat_map(|(s, series)| problem.whitening.first(s)..problem.whitening.first(s) + series.nodes.len())
            .collect();
        let own = DMatrix::from_fn(rows.len(), fit.jacobian.ncols(), |i, j| fit.jacobian[(rows[i], j)]);
        let residual = DVector::from_fn(rows.len(), |i, _| least[rows[i]]);
        let rest = &whole - inner(&own, &own);
        let right = own.tr_mul(&residual);
        // without the group the residual is (I + J A J')r with a covariance of I + J A J', where A is what the rest leaves open
        let moved = rest.clone().cholesky().map(|c| right.dot(&c.solve(&right)));
        sum += residual.norm_squared() + moved.unwrap_or(f64::INFINITY) + log_whole - log_determinant(&rest);
    }
    sum
}

/// What is known of parameters before any data: a normal distribution that has their bounds at two standard deviations.
pub(in super::super) fn known_before(coordinates: &[Coordinate]) -> DMatrix<f64> {
    let width = |c: &Coordinate| c.bounds().1 - c.bounds().0;
    DMatrix::from_diagonal(&DVector::from_iterator(
        coordinates.len(),
        coordinates.iter().map(|c| 16.0 / width(c).powi(2)),
    ))
}

/// Logarithm of the determinant of a positive definite matrix; minus infinity where it is none.
pub(in super::super) fn log_determinant(of: &DMatrix<f64>) -> f64 {
    of.clone().cholesky().map_or(f64::NEG_INFINITY, |c| 2.0 * c.l_dirty().diagonal().map(f64::ln).sum())
}
