//! What speaks against the end of a search: searches from points around it, and from a design that fills the box. They cost no finite elements;
//! where forces cost none at all, they are the search.

use rayon::prelude::*;

use crate::infer::covariance::standard_errors;
use crate::infer::descent::{Ending, Minimum, Region, Rule, Together, minimise};
use crate::infer::starts::filling;

use super::coordinate::Kind;
use super::problem::Problem;
use super::search::{Budget, Effort, Found, Visit};

/// Points elsewhere that promised more and did not keep it, before a search leaves it at that.
pub const TRIES: usize = 6;
/// Points of the design for each coordinate besides the moduli, where forces are interpolated and where they cost nothing.
const DESIGN: usize = 4;
const FREE_DESIGN: usize = 8;
/// The best of the design that are followed.
const FOLLOWED: usize = 4;
const FREE_FOLLOWED: usize = 6;
/// Ends that are followed to the last digit, where forces cost nothing.
const POLISHED: usize = 2;
/// Points around an end lie this many standard errors off, and no farther than this share of the range.
const ERRORS_OFF: f64 = 2.5;
const SHARE_OFF: f64 = 0.2;
/// Most of them.
const MOST_AROUND: usize = 8;
/// Another end is lower or higher when it differs by more than this in chi-squared and this share of the objective; a tenth of what a
/// minimum is asked to be within.
const DIFFERS: (f64, f64) = (0.02, 1e-4);
/// A point that was tried in vain speaks for those within this share of the ranges.
const VAIN: f64 = 0.03;
/// Rounds in which moduli and contact points follow each other.
const SCALINGS: usize = 4;

/// Searches from around an end and from elsewhere.
#[derive(Debug, Clone, PartialEq)]
pub struct Around {
    /// Ends that lie lower, the lowest first.
    pub lower: Vec<Minimum>,
    /// Searches from points around that came back to the objective, and all of them.
    pub back: (usize, usize),
}

/// A search that is to be compared, not reported.
fn rough(rival: f64) -> Rule {
    Rule { most_steps: 60, settled: 0.1 * DIFFERS.0, settled_share: 0.1 * DIFFERS.1, rival: Some(rival) }
}

impl Problem<'_> {
    /// The point with moduli that suit it: forces are proportional to them, so that with the contact points held the best is a ratio.
    #[must_use]
    pub(super) fn scaled(&self, point: &[f64]) -> Vec<f64> {
        let mut point = point.to_vec();
        let region = self.region();
        for _ in 0..SCALINGS {
            let tracks = self.tracks(&point);
            if tracks.len() < self.conditions.len() {
                return point;
            }
            let mut sums = vec![(0.0, 0.0); point.len()];
            for at in self.fitted() {
                let condition = self.condition_of[at];
                let axis = self.conditions[condition].modulus;
                let (of_data, of_model) = self.overlap(at, &tracks[condition]);
                sums[axis].0 += of_data;
                sums[axis].1 += of_model;
            }
            for (axis, (of_data, of_model)) in sums.into_iter().enumerate() {
                if of_data > 0.0 && of_model > 0.0 {
                    point[axis] += (of_data / of_model).ln();
                }
            }
            point = region.inside(&point);
        }
        point
    }

    /// Searches from around an end and from a design over the region, on what is known. Ends near `refused` do not count.
    pub(super) fn around(&self, region: &Region, end: &Minimum, refused: &[Vec<f64>], budget: &Budget) -> Around {
        let differs = DIFFERS.0.max(DIFFERS.1 * end.at.value.abs());
        let near = self.beside(region, end);
        let first = near.len();
        let mut starts = near;
        starts.extend(self.best_of_design(region, DESIGN, FOLLOWED));
        let rule = rough(end.at.value);
        let followed = |start: &Vec<f64>| {
            let late = budget.is_late();
            (!late).then(|| Minimum::from(minimise(&Together(|x: &[f64]| self.quadratic(x)), region, start, &rule)))
        };
        let ends: Vec<Option<Minimum>> = starts.par_iter().map(followed).collect();
        let back = ends[..first].iter().flatten().filter(|m| m.at.value <= end.at.value + differs).count();
        let was_tried = |x: &[f64]| refused.iter().any(|other| self.apart(region, x, other) < VAIN);
        let lower = |m: &Minimum| m.at.value < end.at.value - differs && !was_tried(&m.x);
        let mut lower: Vec<Minimum> = ends.into_iter().flatten().filter(lower).collect();
        lower.sort_by(|a, b| a.at.value.total_cmp(&b.at.value));
        Around { lower, back: (back, first) }
    }

    /// Largest distance between two points over the coordinates that may move, in shares of their ranges. Moduli follow the others.
    fn apart(&self, region: &Region, a: &[f64], b: &[f64]) -> f64 {
        let axes = (0..a.len()).filter(|&i| self.unknowns[i].kind != Kind::Modulus && region.high[i] > region.low[i]);
        axes.map(|i| (a[i] - b[i]).abs() / (region.high[i] - region.low[i])).fold(0.0, f64::max)
    }

    /// Points around an end, a few standard errors off along each coordinate that may move.
    fn beside(&self, region: &Region, end: &Minimum) -> Vec<Vec<f64>> {
        let errors = standard_errors(&end.at.hessian);
        let mut points = Vec::new();
        for (axis, error) in errors.iter().enumerate() {
            let range = region.high[axis] - region.low[axis];
            let off = if error.is_finite() { (ERRORS_OFF * error).min(SHARE_OFF * range) } else { SHARE_OFF * range };
            for sign in [-1.0, 1.0] {
                let mut point = end.x.clone();
                point[axis] = (point[axis] + sign * off).clamp(region.low[axis], region.high[axis]);
                if point[axis] != end.x[axis] {
                    points.push(point);
                }
            }
        }
        let stride = points.len().div_ceil(MOST_AROUND).max(1);
        points.into_iter().step_by(stride).collect()
    }

    /// The best points of a design that fills the region, with moduli that suit them.
    fn best_of_design(&self, region: &Region, each: usize, count: usize) -> Vec<Vec<f64>> {
        let moving = |i: &usize| self.unknowns[*i].kind != Kind::Modulus && region.high[*i] > region.low[*i];
        let free = (0..region.low.len()).filter(moving).count();
        let design = filling(region, each * free);
        let seen = design.par_iter().map(|point| {
            let point = self.scaled(&self.holding(point));
            (self.value(&point), point)
        });
        let mut seen: Vec<(f64, Vec<f64>)> = seen.filter(|(value, _)| value.is_finite()).collect();
        seen.sort_by(|a, b| a.0.total_cmp(&b.0));
        seen.into_iter().take(count).map(|(_, point)| point).collect()
    }

    /// The point with relaxing parts that leave something.
    fn holding(&self, point: &[f64]) -> Vec<f64> {
        let sums = self.relaxing(point).map(|sum| (0.9 / sum.max(f64::MIN_POSITIVE)).min(1.0));
        let scaled = self.unknowns.iter().zip(point).map(|(unknown, x)| match unknown.kind {
            Kind::G(_) => x * sums[0],
            Kind::K(_) => x * sums[1],
            _ => *x,
        });
        scaled.collect()
    }

    /// The search where forces cost nothing: from the points given and from a design that fills the region; the best to the last digit.
    /// The ends of one search are the starts of the next with other weights.
    pub(super) fn descended(&self, region: &Region, path: Vec<Visit>, effort: Effort, budget: &Budget) -> Found {
        let best = path.iter().map(|v| v.value).fold(f64::INFINITY, f64::min);
        let mut starts: Vec<Vec<f64>> = path.iter().map(|v| v.point.clone()).collect();
        if effort != Effort::Again {
            starts.extend(self.best_of_design(region, FREE_DESIGN, FREE_FOLLOWED));
        }
        let to = |rule: Rule| {
            move |start: &Vec<f64>| -> Minimum {
                // Late, it stays where it is.
                let rule = if budget.is_late() { Rule { most_steps: 0, ..rule.clone() } } else { rule.clone() };
                minimise(&Together(|x: &[f64]| self.quadratic(x)), region, start, &rule).into()
            }
        };
        let mut ends: Vec<Minimum> = starts.par_iter().map(to(rough(best))).collect();
        ends.retain(|m| m.ending != Ending::Impossible);
        ends.sort_by(|a, b| a.at.value.total_cmp(&b.at.value));
        let mut distinct: Vec<Visit> = Vec::new();
        for end in &ends {
            if distinct.len() < FREE_FOLLOWED && distinct.iter().all(|v| self.apart(region, &v.point, &end.x) > VAIN) {
                distinct.push(Visit { point: end.x.clone(), value: end.at.value });
            }
        }
        let leading: Vec<Vec<f64>> = distinct.iter().take(POLISHED).map(|v| v.point.clone()).collect();
        if let (Effort::Start, Some(best)) = (effort, ends.first()) {
            let minimum = best.clone();
            return Found {
                minimum,
                path: distinct,
                converged: false,
                came_back: (0, 0),
                expected_within: 0.0,
                failures: Vec::new(),
            };
        }
        let polished = leading.par_iter().map(to(Rule::default())).min_by(|a, b| a.at.value.total_cmp(&b.at.value));
        let mut minimum = polished.unwrap_or_else(|| self.minimised(region, &starts[0]));
        let mut around = self.around(region, &minimum, &[], budget);
        for _ in 0..TRIES {
            let Some(lower) = around.lower.first() else { break };
            minimum = to(Rule::default())(&lower.x);
            around = self.around(region, &minimum, &[], budget);
        }
        distinct.push(Visit { point: minimum.x.clone(), value: minimum.at.value });
        let converged = self.is_minimum(&minimum, &around) && !budget.is_late();
        let came_back = around.back;
        Found { minimum, path: distinct, converged, came_back, expected_within: 0.0, failures: Vec::new() }
    }
}
