//! Levenberg-Marquardt inside a box (Marquardt 1963, doi:10.1137/0111030), on anything that gives a weighted
//! sum of squares with its Gauss-Newton approximation.

use nalgebra::{DMatrix, DVector};

/// Objective with half its gradient and half its Gauss-Newton Hessian.
#[derive(Debug, Clone, PartialEq)]
pub struct Quadratic {
    /// Weighted sum of squares.
    pub value: f64,
    /// Half the gradient.
    pub gradient: DVector<f64>,
    /// Half the Hessian, without second derivatives of the model.
    pub hessian: DMatrix<f64>,
}

/// A box, and coordinates that may not move.
#[derive(Debug, Clone, PartialEq)]
pub struct Region {
    /// Lower corner.
    pub low: Vec<f64>,
    /// Upper corner.
    pub high: Vec<f64>,
    /// A coordinate that is held.
    pub held: Option<usize>,
}

impl Region {
    /// The nearest point inside.
    #[must_use]
    pub fn inside(&self, x: &[f64]) -> Vec<f64> {
        x.iter().zip(self.low.iter().zip(&self.high)).map(|(x, (low, high))| x.clamp(*low, *high)).collect()
    }
}

/// Where a search ended.
#[derive(Debug, Clone, PartialEq)]
pub struct Minimum {
    /// The point.
    pub x: Vec<f64>,
    /// Objective and its model there.
    pub at: Quadratic,
    /// Steps taken.
    pub steps: usize,
}

const MOST_STEPS: usize = 60;
const FIRST_DAMPING: f64 = 1e-3;
const LEAST_DAMPING: f64 = 1e-12;
const MOST_DAMPING: f64 = 1e8;
/// Relative gain, and step in units of the range, below which the search ends.
const WORTHWHILE: f64 = 1e-10;
const STILL: f64 = 1e-9;

/// Minimises from `start`, which is moved into the region.
pub fn minimise(objective: &dyn Fn(&[f64]) -> Quadratic, region: &Region, start: &[f64]) -> Minimum {
    let mut x = region.inside(start);
    let mut at = objective(&x);
    let mut damping = FIRST_DAMPING;
    let mut steps = 0;
    while steps < MOST_STEPS && damping < MOST_DAMPING {
        steps += 1;
        let Some(next) = step(&x, &at, region, damping) else {
            damping *= 10.0;
            continue;
        };
        let moved = next
            .iter()
            .zip(&x)
            .zip(region.low.iter().zip(&region.high))
            .map(|((a, b), (low, high))| (a - b).abs() / (high - low).max(f64::MIN_POSITIVE))
            .fold(0.0, f64::max);
        if moved < STILL {
            break;
        }
        let there = objective(&next);
        if there.value.is_finite() && there.value <= at.value {
            let gain = at.value - there.value;
            (x, at) = (next, there);
            damping = (damping * 0.2).max(LEAST_DAMPING);
            if gain <= WORTHWHILE * at.value {
                break;
            }
        } else {
            damping *= 6.0;
        }
    }
    Minimum { x, at, steps }
}

/// A damped step; coordinates that would leave the region through a wall they stand at are held.
fn step(x: &[f64], at: &Quadratic, region: &Region, damping: f64) -> Option<Vec<f64>> {
    let count = x.len();
    let mut free: Vec<usize> = (0..count)
        .filter(|&i| {
            let out_low = x[i] <= region.low[i] && at.gradient[i] > 0.0;
            let out_high = x[i] >= region.high[i] && at.gradient[i] < 0.0;
            Some(i) != region.held && !out_low && !out_high && region.high[i] > region.low[i]
        })
        .collect();
    // Holding a coordinate at the wall that the step runs into changes the step of the others.
    for _ in 0..count {
        if free.is_empty() {
            return None;
        }
        let n = free.len();
        let hessian = DMatrix::from_fn(n, n, |i, j| {
            let h = at.hessian[(free[i], free[j])];
            if i == j { h * (1.0 + damping) + f64::MIN_POSITIVE } else { h }
        });
        let gradient = DVector::from_fn(n, |i, _| at.gradient[free[i]]);
        let move_by = hessian.cholesky()?.solve(&(-gradient));
        let mut next = x.to_vec();
        let mut leaving = Vec::new();
        for (i, &axis) in free.iter().enumerate() {
            next[axis] += move_by[i];
            if next[axis] < region.low[axis] || next[axis] > region.high[axis] {
                next[axis] = next[axis].clamp(region.low[axis], region.high[axis]);
                leaving.push(axis);
            }
        }
        let stands = |axis: &usize| x[*axis] <= region.low[*axis] || x[*axis] >= region.high[*axis];
        if leaving.iter().any(stands) {
            free.retain(|axis| !(leaving.contains(axis) && stands(axis)));
            continue;
        }
        return Some(next);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rosenbrock's valley as residuals 10 (y - x^2) and 1 - x.
    fn valley(p: &[f64]) -> Quadratic {
        let r = DVector::from_vec(vec![10.0 * (p[1] - p[0] * p[0]), 1.0 - p[0]]);
        let j = DMatrix::from_row_slice(2, 2, &[-20.0 * p[0], 10.0, -1.0, 0.0]);
        Quadratic { value: r.norm_squared(), gradient: j.transpose() * &r, hessian: j.transpose() * j }
    }

    fn region(low: f64, high: f64) -> Region {
        Region { low: vec![low; 2], high: vec![high; 2], held: None }
    }

    #[test]
    fn the_valley_is_followed_to_its_end() {
        let end = minimise(&valley, &region(-3.0, 3.0), &[-1.2, 1.0]);
        assert!(end.at.value < 1e-16 && (end.x[0] - 1.0).abs() < 1e-8, "{end:?}");
    }

    #[test]
    fn a_wall_and_a_held_coordinate_are_kept() {
        // Inside x <= 0.5 the best is at the wall, y = x^2.
        let end = minimise(&valley, &region(-3.0, 0.5), &[-1.2, 0.4]);
        assert!((end.x[0] - 0.5).abs() < 1e-9 && (end.x[1] - 0.25).abs() < 1e-6, "{end:?}");
        let held = Region { held: Some(0), ..region(-3.0, 3.0) };
        let end = minimise(&valley, &held, &[0.7, 2.0]);
        assert!(end.x[0] == 0.7 && (end.x[1] - 0.49).abs() < 1e-6, "{end:?}");
    }
}
