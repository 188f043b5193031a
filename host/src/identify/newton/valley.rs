//! The valley around a minimum: the objective over the two parameters that make up for each other the most.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::identify::data::Selection;
use crate::identify::spec::Loss;
use crate::infer::covariance::Factor;

use super::condition::Condition;
use super::coordinate::{Unknown, Values};
use super::fit::Newton;
use super::problem::{Problem, Weight};

/// All of a solved problem but its data.
#[derive(Debug, Clone)]
pub struct Solved {
    /// Free parameters.
    pub unknowns: Vec<Unknown>,
    /// Parameters that are not free.
    pub base: Values,
    /// Forward problems with what was solved of them.
    pub conditions: Vec<Condition>,
    /// Condition of every curve.
    pub condition_of: Vec<usize>,
    /// Weight of every curve.
    pub weights: Vec<Weight>,
    /// Loss.
    pub loss: Loss,
    /// Where absolute differences turn linear, in standard deviations.
    pub smooth: f64,
}

impl Solved {
    /// Keeps what was solved.
    #[must_use]
    pub fn of(problem: &Problem<'_>) -> Self {
        Self {
            unknowns: problem.unknowns.clone(),
            base: problem.base.clone(),
            conditions: problem.conditions.clone(),
            condition_of: problem.condition_of.clone(),
            weights: problem.weights.clone(),
            loss: problem.loss,
            smooth: problem.smooth,
        }
    }

    /// The problem again, with the data it was solved for.
    #[must_use]
    pub fn on<'a>(&self, selection: &'a Selection) -> Problem<'a> {
        Problem {
            selection,
            unknowns: self.unknowns.clone(),
            base: self.base.clone(),
            conditions: self.conditions.clone(),
            condition_of: self.condition_of.clone(),
            weights: self.weights.clone(),
            loss: self.loss,
            smooth: self.smooth,
        }
    }
}

/// The objective on a grid of two parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Valley {
    /// Numbers of the two unknowns, the one drawn along x first.
    pub axes: [usize; 2],
    /// Coordinates of the columns.
    pub x: Vec<f64>,
    /// Coordinates of the rows.
    pub y: Vec<f64>,
    /// Rise of the objective above its minimum, row by row; no less than 0.
    pub rise: Vec<Vec<f64>>,
    /// Rise on the edge of the 95 % region of the two.
    pub edge: f64,
}

/// Columns and rows of the grid.
const NODES: usize = 33;
/// The grid reaches this many intervals to either side.
const REACH: f64 = 2.0;

impl Valley {
    /// The valley around what was found; `None` with fewer than two parameters.
    ///
    /// The other parameters follow to where the Gauss-Newton Hessian puts their best, the contact points to their exact best. Nothing is solved.
    #[must_use]
    pub fn around(newton: &Newton, selection: &Selection) -> Option<Self> {
        let problem = newton.solved.on(selection);
        let axes = axes(newton)?;
        let region = problem.region();
        let centre = &newton.minimum.x;
        let side = |axis: usize| -> Vec<f64> {
            let span = &newton.spans[axis];
            let low = (centre[axis] - REACH * (centre[axis] - span.low)).max(region.low[axis]);
            let high = (centre[axis] + REACH * (span.high - centre[axis])).min(region.high[axis]);
            (0..NODES).map(|i| low + (high - low) * i as f64 / (NODES - 1) as f64).collect()
        };
        let (x, y) = (side(axes[0]), side(axes[1]));
        let follow = follow(&newton.minimum.at.hessian, axes);
        let rise = y.par_iter().map(|y| {
            let at = |x: &f64| {
                let step = [x - centre[axes[0]], y - centre[axes[1]]];
                let point: Vec<f64> = (0..centre.len())
                    .map(|i| centre[i] + follow[(i, 0)] * step[0] + follow[(i, 1)] * step[1])
                    .collect();
                (problem.value(&region.inside(&point)) - newton.minimum.at.value).max(0.0)
            };
            x.iter().map(at).collect()
        });
        let rise = rise.collect();
        Some(Self { axes, x, y, rise, edge: problem.rise_of_two() })
    }
}

/// The pair with the largest correlation; the first two where the data tie some exactly.
fn axes(newton: &Newton) -> Option<[usize; 2]> {
    let count = newton.minimum.x.len();
    if count < 2 {
        return None;
    }
    let Some(correlation) = &newton.correlation else { return Some([1, 0]) };
    let pairs = (0..count).flat_map(|a| (0..a).map(move |b| [a, b]));
    pairs.max_by(|a, b| correlation[(a[0], a[1])].abs().total_cmp(&correlation[(b[0], b[1])].abs()))
}

/// How every coordinate moves with the two: themselves by one, the others by `-H_oo^-1 H_oi`; not at all where that is singular.
fn follow(hessian: &DMatrix<f64>, axes: [usize; 2]) -> DMatrix<f64> {
    let count = hessian.nrows();
    let others: Vec<usize> = (0..count).filter(|i| !axes.contains(i)).collect();
    let inner = DMatrix::from_fn(others.len(), others.len(), |i, j| hessian[(others[i], others[j])]);
    let solved = Factor::of(&inner);
    let mut follow = DMatrix::zeros(count, 2);
    for (column, axis) in axes.into_iter().enumerate() {
        follow[(axis, column)] = 1.0;
        let coupling = DVector::from_fn(others.len(), |i, _| -hessian[(others[i], axis)]);
        let Some(moved) = solved.as_ref().map(|inner| inner.solve(&coupling)) else { continue };
        for (at, other) in others.iter().enumerate() {
            follow[(*other, column)] = moved[at];
        }
    }
    follow
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn the_other_coordinate_follows_to_its_best() {
        // H = [[2, 0, 1], [0, 2, 0], [1, 0, 1]]: for a step of one along the first, the third's best is -1.
        let hessian = DMatrix::from_row_slice(3, 3, &[2.0, 0.0, 1.0, 0.0, 2.0, 0.0, 1.0, 0.0, 1.0]);
        let follow = follow(&hessian, [0, 1]);
        assert_eq!(follow.column(0).as_slice(), [1.0, 0.0, -1.0]);
        assert_eq!(follow.column(1).as_slice(), [0.0, 1.0, 0.0]);
    }
}
