//! The minimum of absolute differences (thesis Eq. 14), which has a kink at every sample.
//!
//! Gauss-Newton goes where the rounded loss is least. From there the thesis' simplex goes on, on what was solved, in coordinates in which
//! the valley is round; the finite elements are solved where it ends, until it ends where it began.

use nalgebra::{DMatrix, DVector};

use crate::identify::simplex::{self, Bounds, Stop};
use crate::identify::spec::Loss;

use super::problem::Problem;
use super::search::{Budget, Found, Told, Visit};

/// Absolute differences are rounded below this many standard deviations of what the fit leaves over, for gradients and intervals.
pub const ROUNDED: f64 = 0.3;
/// And below this many for the minimum itself.
const SHARP: f64 = 1e-3;
/// Half the box of the simplex, and its first edge, in standard errors of the rounded loss.
const REACH: f64 = 6.0;
const EDGE: f64 = 1.0;
/// The simplex is a point below this many standard errors.
const STOP: Stop = Stop { size: 0.002 / (2.0 * REACH), spread: 1e-9, iterations: 250 };
/// A simplex that moved less than this, in standard errors, is at rest: the error of the estimate grows by a thousandth.
const AT_REST: f64 = 0.05;
const MOST_ROUNDS: usize = 6;

impl Problem<'_> {
    /// Goes on from the minimum of the rounded loss. A singular Hessian leaves it there: no coordinates make the valley round. A solve
    /// that fails is told and ends the rounds.
    pub fn settle(&mut self, mut found: Found, budget: &Budget, told: &Told<'_>) -> Found {
        let spread = self.spread(&found.minimum);
        let region = self.region();
        let count = region.low.len();
        let free: Vec<usize> =
            (0..count).filter(|&i| found.minimum.x[i] > region.low[i] && found.minimum.x[i] < region.high[i]).collect();
        let hessian = &found.minimum.at.hessian;
        let inner = DMatrix::from_fn(free.len(), free.len(), |i, j| hessian[(free[i], free[j])]);
        let Some(factor) = inner.cholesky().filter(|_| !free.is_empty()) else { return found };
        let round = factor.l().transpose();
        let bounds = Bounds { low: vec![-REACH; free.len()], high: vec![REACH; free.len()] };
        let was_minimum = found.converged;
        self.smooth = SHARP * spread;
        for _ in 0..MOST_ROUNDS {
            let centre = found.minimum.x.clone();
            let place = |z: &[f64]| -> Vec<f64> {
                let step = round.solve_upper_triangular(&DVector::from_column_slice(z));
                let mut point = centre.clone();
                for (at, axis) in free.iter().enumerate() {
                    point[*axis] += step.as_ref().map_or(0.0, |step| step[at]);
                }
                region.inside(&point)
            };
            let end = simplex::descend(
                &|z: &[f64]| self.value(&place(z)),
                &bounds,
                &vec![0.0; free.len()],
                EDGE / (2.0 * REACH),
                STOP,
            );
            let moved = end.point.iter().map(|z| z * z).sum::<f64>().sqrt();
            found.minimum.x = place(&end.point);
            found.converged = was_minimum && moved < AT_REST;
            if moved < AT_REST || budget.is_spent(self.solves()) {
                break;
            }
            if let Err(cause) = self.solve_at(std::slice::from_ref(&found.minimum.x)) {
                // What was solved around it still says where the minimum is.
                found.failures.push(cause.to_string());
                break;
            }
            told(self.solves());
            found.path.push(Visit { point: found.minimum.x.clone(), value: self.value(&found.minimum.x) });
        }
        self.smooth = ROUNDED * spread;
        found.minimum.at = self.quadratic(&found.minimum.x);
        self.loss = Loss::Squares;
        let squares = self.quadratic(&found.minimum.x).hessian;
        self.loss = Loss::Absolute;
        // The estimate's variance is pi/2 times that of least squares.
        found.minimum.at.hessian = squares * std::f64::consts::FRAC_2_PI;
        found
    }
}
