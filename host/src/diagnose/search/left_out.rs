//! How well a fit predicts conditions that it has not seen, from one fit of all.

use nalgebra::{DMatrix, DVector};

use super::super::coordinate::Coordinate;
use super::super::design::Design;
use super::super::fit::{Fit, Problem};
use crate::infer::covariance::{Factor, log_determinant};
use crate::infer::product::inner;

/// Minus twice the logarithm of the density that the other groups of conditions predict every group with, to first order about the fit, less what all fits have in common.
/// What the others do not tell of the parameters is in it: a prediction that is uncertain is no wrong one. Errors that groups share are known from the others as well.
///
/// Infinite where a number is none.
pub(super) fn left_out(design: &Design, fit: &Fit, problem: &Problem<'_>) -> f64 {
    let whole = inner(&fit.jacobian, &fit.jacobian) + known_before(&fit.coordinates);
    let (Some(factor), Some(groups)) = (Factor::of(&whole), problem.whitening.groups(design)) else {
        return f64::INFINITY;
    };
    let log_whole = factor.log_determinant();
    // what was fitted with errors of its effects allowed for is not where these residuals are least: a slope that is left would pass for a parameter that one group alone moves
    let least = &fit.residual - &fit.jacobian * factor.solve(&fit.jacobian.tr_mul(&fit.residual));
    let count = fit.jacobian.ncols();
    let mut all = fit.jacobian.clone().insert_column(count, 0.0);
    all.set_column(count, &least);
    let weighed = problem.whitening.weighed(&all);
    let mut sum = 0.0;
    for group in groups {
        let left = group.left(&weighed);
        let (own, residual) = (left.columns(0, count).into_owned(), left.column(count).into_owned());
        let rest = &whole - inner(&own, &own);
        let right: DVector<f64> = own.tr_mul(&residual);
        // without the group the residual is (I + J A J')r with a covariance of I + J A J', where A is what the rest leaves open
        let moved = Factor::of(&rest).map_or(f64::INFINITY, |factor| right.dot(&factor.solve(&right)));
        sum += residual.norm_squared() + moved + log_whole - log_determinant(&rest);
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
