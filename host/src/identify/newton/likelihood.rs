//! Profile-likelihood intervals (Venzon and Moolgavkar 1988, doi:10.2307/2347496): a value belongs to the interval as long as
//! some choice of all other parameters, contact points included, explains the data as well as chance allows.

use nalgebra::DVector;
use rayon::prelude::*;

use super::problem::Problem;
use crate::identify::spec::Loss;
use crate::infer::covariance::covariance;
use crate::infer::descent::{Minimum, Region};

/// Rise of the objective at the end of a 95 % interval: the quantile of chi-squared with one degree of freedom.
pub const RISE: f64 = 3.841_458_820_694_124;
/// The same for two parameters together: chi-squared with two degrees of freedom.
pub const RISE_OF_TWO: f64 = 5.991_464_547_107_979;
/// Rise of the sum of absolute differences (twice, in standard deviations) over that of squares at the same probability, for normal
/// noise: the variance of the estimate is pi/2 times larger, the curvature sqrt(2/pi) times (Koenker and Bassett 1978, doi:10.2307/1913643).
const ABSOLUTE_OVER_SQUARES: f64 = 1.253_314_137_315_500_3;
/// A point that rises above this many times what is allowed is not worth a search for the best of its other coordinates.
const PROMISING: f64 = 10.0;
/// Relative accuracy of an end, in its own half-width.
const CLOSE: f64 = 0.01;
const MOST_STEPS: usize = 12;

/// One end of an interval.
#[derive(Debug, Clone, PartialEq)]
pub struct End {
    /// Coordinate of the end.
    pub x: f64,
    /// The best point with that coordinate: where the data are explained just well enough.
    pub support: Vec<f64>,
    /// The bound of the search came first.
    pub at_bound: bool,
}

impl Problem<'_> {
    /// Rise of the objective that ends an interval under this loss.
    #[must_use]
    pub fn rise(&self) -> f64 {
        RISE * self.per_square()
    }

    /// Rise of the objective on the edge of the 95 % region of two parameters under this loss.
    #[must_use]
    pub fn rise_of_two(&self) -> f64 {
        RISE_OF_TWO * self.per_square()
    }

    fn per_square(&self) -> f64 {
        if self.loss == Loss::Absolute { ABSOLUTE_OVER_SQUARES } else { 1.0 }
    }

    /// One end of the interval of a coordinate; `sign` is -1 for the lower one.
    #[must_use]
    pub fn end(&self, minimum: &Minimum, axis: usize, error: f64, sign: f64) -> End {
        let region = self.region();
        let bound = if sign < 0.0 { region.low[axis] } else { region.high[axis] };
        let from = minimum.x[axis];
        let reach = (bound - from).abs();
        let rise = self.rise().sqrt();
        if reach <= 0.0 {
            return End { x: bound, support: minimum.x.clone(), at_bound: true };
        }
        let mut distance = (rise * error).min(reach);
        if !(distance.is_finite() && distance > 0.0) {
            distance = reach;
        }
        let mut support = minimum.x.clone();
        let (mut inside, mut outside) = (0.0, f64::INFINITY);
        for _ in 0..MOST_STEPS {
            let held = self.held(&region, axis, from + sign * distance, &support);
            let rose = (held.at.value - minimum.at.value).max(0.0).sqrt();
            support = held.x;
            if rose < rise {
                inside = distance;
                if distance >= reach {
                    return End { x: bound, support, at_bound: true };
                }
            } else {
                outside = distance;
            }
            if (rose / rise - 1.0).abs() < CLOSE {
                break;
            }
            // The root of the rise is nearly proportional to the distance.
            let next = (distance * (rise / rose.max(1e-3 * rise)).clamp(0.2, 4.0)).min(reach);
            let bracketed = next > inside && next < outside;
            distance = if bracketed { next } else { 0.5 * (inside + outside.min(reach)) };
        }
        End { x: from + sign * distance, support, at_bound: false }
    }

    /// More points that explain the data within `allowed` above the minimum: each of `known`, which do, with one coordinate at a bound or
    /// halfway there, the others at their best. A profile follows the branch of the valley it begins in; where one parameter takes away
    /// the effect of another (a bulk that hardly compresses, the relaxation of that bulk) the other slides on its own.
    #[must_use]
    pub fn slides(&self, minimum: &Minimum, known: &[Vec<f64>], allowed: f64) -> Vec<Vec<f64>> {
        let region = self.region();
        let mut jobs = Vec::new();
        for point in known {
            for axis in 0..point.len() {
                jobs.extend([region.low[axis], region.high[axis]].map(|bound| (point, axis, bound)));
            }
        }
        let slide = |&(point, axis, bound): &(&Vec<f64>, usize, f64)| {
            [1.0, 0.5].into_iter().find_map(|share| {
                let mut there = point.clone();
                there[axis] += share * (bound - point[axis]);
                let rise = |x: &[f64]| self.value(x) - minimum.at.value;
                if rise(&there) > PROMISING * allowed {
                    return None;
                }
                let held = self.held(&region, axis, there[axis], &there);
                (held.at.value - minimum.at.value <= allowed).then_some(held.x)
            })
        };
        jobs.par_iter().filter_map(slide).collect()
    }

    /// The best point with one coordinate held.
    fn held(&self, region: &Region, axis: usize, x: f64, start: &[f64]) -> Minimum {
        let mut start = start.to_vec();
        start[axis] = x.clamp(region.low[axis], region.high[axis]);
        let region = Region { held: Some(axis), ..region.clone() };
        self.minimised(&region, &start)
    }

    /// How far an error of the simulation itself may have moved each coordinate (one standard deviation): a relative force
    /// error within `bound`, uniform, in each condition as three smooth shapes over depth.
    #[must_use]
    pub fn moved_by_model(&self, minimum: &Minimum, bound: f64) -> Vec<f64> {
        let count = minimum.x.len();
        let Some(inverse) = covariance(&minimum.at.hessian) else { return vec![0.0; count] };
        let mut squares = vec![0.0; count];
        let one_sigma = bound / 3.0_f64.sqrt();
        for condition in 0..self.conditions.len() {
            for shape in 0..3 {
                let shifted = self.quadratic_with_error(&minimum.x, condition, one_sigma, f64::from(shape));
                let moved: DVector<f64> = &inverse * (&minimum.at.gradient - shifted.gradient);
                squares.iter_mut().zip(moved.iter()).for_each(|(s, m)| *s += m * m);
            }
        }
        squares.into_iter().map(f64::sqrt).collect()
    }
}
