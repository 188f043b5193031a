//! The objective over two parameters.

use rayon::prelude::*;

use crate::identify::newton::problem::Problem;
use crate::identify::simplex::Bounds;

use super::objective_n;

/// Columns and rows.
const NODES: usize = 24;

/// Eq. 14 over two parameters, the others where they are at a point, contact points at their best. Nothing is solved for it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Slice {
    /// Numbers of the two coordinates, the one along x first.
    pub axes: [usize; 2],
    /// Coordinates of the columns.
    pub x: Vec<f64>,
    /// Coordinates of the rows.
    pub y: Vec<f64>,
    /// Objective in N, row by row.
    pub objective_n: Vec<Vec<f64>>,
}

impl Slice {
    /// Through a point, over the whole box; empty without a point, or with fewer than two parameters.
    #[must_use]
    pub fn of(problem: &Problem<'_>, bounds: &Bounds, centre: &[f64], axes: [usize; 2]) -> Self {
        if centre.len() < 2 || axes[0] == axes[1] {
            return Self::default();
        }
        let side = |axis: usize| -> Vec<f64> {
            (0..NODES).map(|i| bounds.low[axis] + bounds.side(axis) * i as f64 / (NODES - 1) as f64).collect()
        };
        let (x, y) = (side(axes[0]), side(axes[1]));
        let row = |y: &f64| -> Vec<f64> {
            let at = |x: &f64| {
                let mut point = centre.to_vec();
                (point[axes[0]], point[axes[1]]) = (*x, *y);
                objective_n(problem, &point)
            };
            x.iter().map(at).collect()
        };
        let objective_n = y.par_iter().map(row).collect();
        Self { axes, x, y, objective_n }
    }
}
