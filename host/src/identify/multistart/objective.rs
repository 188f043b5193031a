//! Eq. 14 as the objective of a problem.

use crate::identify::newton::problem::{Problem, Weight};
use crate::identify::spec::Loss;

/// Differences below this (N) count as squares: far below what any sensor resolves.
const SHARP_N: f64 = 1e-9;

/// Makes Eq. 14 the objective of a problem: all samples count alike.
pub fn as_eq_14(problem: &mut Problem<'_>) {
    problem.weights = vec![Weight { sigma_n: 1.0, correlated: 1.0 }; problem.selection.curves.len()];
    problem.loss = Loss::Absolute;
    problem.smooth = SHARP_N;
}

/// Eq. 14 in N at a point of such a problem.
#[must_use]
pub fn objective_n(problem: &Problem<'_>, point: &[f64]) -> f64 {
    0.5 * problem.value(point)
}
