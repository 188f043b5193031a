//! A whole fit: weights, search, intervals, verdicts.

use std::time::Instant;

use nalgebra::DMatrix;
use rayon::prelude::*;

use lut_gen::solid::solve::SolveError;

use crate::identify::noise::Noise;
use crate::identify::spec::Loss;
use crate::infer::covariance::{Z95, covariance, standard_errors};
use crate::infer::descent::Minimum;

use super::absolute::ROUNDED;
use super::condition::Source;
use super::coordinate::{Kind, Unknown, Values};
use super::likelihood::End;
use super::problem::{MOST_RELAXING, Problem, Weight};
use super::search::{Budget, Found, Told, Visit};
use super::setup::FIRST_ALPHA;
use super::valley::Solved;
use super::verdict::{Judged, Verdict, judge};

/// Relative error bound of a solve on the standard mesh, worst of the twelve reference curves (docs/verification.md).
pub const MESH_ERROR: f64 = 1.5e-3;
/// Exponents at which a search begins where solves cost nothing.
const MANY_ALPHA: [f64; 6] = [1.0, 2.0, 4.0, 8.0, 14.0, 20.0];
/// Support points nearer than this to a solved one, in standard errors, need no solve of their own.
const NEAR: f64 = 0.25;
/// A coordinate whose interval spans more than this share of its range is loose; and most corners that are solved for.
const LOOSE: f64 = 0.3;
const MOST_CORNERS: usize = 8;
/// The end of an interval is found to a hundredth of its half-width, the rise there to twice that.
const EDGE: f64 = 1.02;
/// Most rounds of weighing and searching; one that changes no noise by more than this factor is the last.
const WEIGHINGS: usize = 3;
const REWEIGHED: f64 = 1.1;
/// A ramp whose depth the fit moved by more than this share is solved anew to where it ends.
const MOVED: f64 = 0.01;

/// What is asked of the fit besides the problem itself.
pub struct Demand<'a> {
    /// Runs that repeat each other, indices into the experiment's.
    pub groups: &'a [Vec<usize>],
    /// Noise stated by the user, N.
    pub stated_n: Option<f64>,
    /// Most solves.
    pub most_solves: usize,
    /// When to end with the best so far; `None` for no such time.
    pub until: Option<Instant>,
    /// Told of every solve.
    pub told: &'a Told<'a>,
}

/// Interval of a coordinate.
#[derive(Debug, Clone, PartialEq)]
pub struct Span {
    /// Lower end, with the simulation's own error in it.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// The data alone would go on beyond the lower bound of the search.
    pub open_low: bool,
    /// The same above.
    pub open_high: bool,
}

/// What a fit found.
#[derive(Debug, Clone)]
pub struct Newton {
    /// The minimum.
    pub minimum: Minimum,
    /// Interval of each coordinate.
    pub spans: Vec<Span>,
    /// Points on the edge of the 95 % region, the ends of the profiles.
    pub supports: Vec<Vec<f64>>,
    /// Standard errors by linearisation.
    pub errors: Vec<f64>,
    /// Correlation of the estimates; `None` if some parameters are exactly tied.
    pub correlation: Option<DMatrix<f64>>,
    /// What can be said of each parameter.
    pub verdicts: Vec<Verdict>,
    /// Points that were solved, in order.
    pub path: Vec<Visit>,
    /// The end is a minimum: its projected gradient vanishes, and searches from around it and from elsewhere end no lower.
    pub converged: bool,
    /// Searches from points around the end, and those of them that came back to its objective.
    pub came_back: (usize, usize),
    /// The budget of solves or time was spent before the search came to rest.
    pub spent: bool,
    /// How far the last solve lay from what was expected of it, of the peak force.
    pub expected_within: f64,
    /// Solves that failed on the way.
    pub failures: Vec<String>,
    /// Bounds that several parameters lie on together.
    pub walls: Vec<String>,
    /// Noise of each curve.
    pub noises: Vec<Noise>,
    /// Relative error bound of the simulation.
    pub model_error: f64,
    /// What was solved.
    pub solved: Solved,
}

impl Newton {
    /// What the reader should know of the search.
    #[must_use]
    pub fn messages(&self) -> Vec<String> {
        let mut messages: Vec<String> = self.verdicts.iter().map(|v| v.sentence.clone()).collect();
        if !self.converged && self.spent {
            messages.push(format!(
                "the budget ended the search after {} points: this is the best so far; --budget-s gives it more time",
                self.path.len()
            ));
        } else if !self.converged {
            let (back, tried) = self.came_back;
            messages.push(format!(
                "the search may not have reached the minimum: a further step promises {:.2} of {:.1} in chi-squared, and {back} of {tried} searches from around came back",
                self.minimum.promised, self.minimum.at.value
            ));
        }
        messages.extend(self.walls.iter().cloned());
        messages.extend(self.failures.iter().map(|cause| format!("a solve on the way failed: {cause}")));
        messages
    }
}

/// What is solved after the minimum.
#[derive(Debug, Clone, Copy)]
enum Stage {
    /// Ends of the profiles.
    Ends,
    /// Where a loose coordinate goes when another one stands at its end.
    Corners,
}

/// Fits a problem.
///
/// # Errors
/// When no start can be solved.
pub fn fit(problem: &mut Problem<'_>, demand: &Demand<'_>) -> Result<Newton, SolveError> {
    problem.weigh_by_samples(demand.stated_n);
    let budget = &Budget { most_solves: demand.most_solves, until: demand.until };
    let mut found = problem.search_from_simpler(&starts(problem), budget, demand.told)?;
    if problem.anchor(&found.minimum.x) {
        // The minimum lay between solves, and the ramp has become another: what could be solved before is tried next.
        let mut known: Vec<&Visit> = found.path.iter().collect();
        known.sort_by(|a, b| a.value.total_cmp(&b.value));
        let others: Vec<Vec<f64>> = known.iter().take(2).map(|v| v.point.clone()).chain(starts(problem)).collect();
        let again = problem.search(&[found.minimum.x.clone()], budget, demand.told);
        found = again.or_else(|_| problem.search(&others, budget, demand.told))?.after(&found);
    }
    let points = |found: &Found| found.path.iter().map(|v| v.point.clone()).collect::<Vec<_>>();
    if problem.sharpen() {
        found = problem.search_again(&points(&found), budget, demand.told)?.after(&found);
    }
    let mut path = found.path.clone();
    let mut failures = found.failures.clone();
    let mut noises = Vec::new();
    for round in 0..WEIGHINGS {
        let before = problem.weights.clone();
        let told = problem.weigh_by_fit(&found.minimum.x, demand.groups, demand.stated_n);
        let factor = |(new, old): (&Weight, &Weight)| (new.sigma_n / old.sigma_n).ln().abs();
        let changed = problem.weights.iter().zip(&before).map(factor).any(|change| change > REWEIGHED.ln());
        if round > 0 && !changed {
            // The minimum that was found is one in the weights that it was found with.
            problem.weights = before;
            break;
        }
        noises = told;
        let visited = points(&found);
        found = problem.search_again(&visited, budget, demand.told)?.after(&found);
        path.extend_from_slice(found.path.get(visited.len()..).unwrap_or_default());
    }
    if problem.loss == Loss::Absolute {
        problem.smooth = ROUNDED * problem.spread(&found.minimum);
        let visited = points(&found);
        let rounded = problem.search_again(&visited, budget, demand.told)?.after(&found);
        found = problem.settle(rounded, budget, demand.told);
        path.extend_from_slice(found.path.get(visited.len()..).unwrap_or_default());
    }
    let errors = standard_errors(&found.minimum.at.hessian);
    let mut ends = problem.ends(&found.minimum, &errors);
    for stage in [Stage::Ends, Stage::Corners] {
        // Late, nothing more is solved.
        let left = |problem: &Problem<'_>| if budget.is_late() { problem.solves() } else { budget.most_solves };
        let wanted = match stage {
            Stage::Ends => problem.worth_solving(&ends, &errors, left(problem)),
            Stage::Corners => problem.corners(&ends, left(problem)),
        };
        if wanted.is_empty() {
            continue;
        }
        // A failing solve leaves the end where the neighbours put it.
        failures.extend(problem.solve_at(&wanted).err().map(|cause| cause.to_string()));
        (demand.told)(problem.solves());
        let visited: Vec<Vec<f64>> = points(&found);
        found = problem.search_again(&visited, budget, demand.told)?.after(&found);
        if problem.loss == Loss::Absolute {
            found = problem.settle(found, budget, demand.told);
        }
        path.extend_from_slice(found.path.get(visited.len()..).unwrap_or_default());
        ends = problem.ends(&found.minimum, &standard_errors(&found.minimum.at.hessian));
    }
    failures.extend(found.failures.clone());
    failures.dedup();
    let errors = standard_errors(&found.minimum.at.hessian);
    let mut walls = Vec::new();
    let [shear, bulk] = problem.relaxing(&found.minimum.x);
    for (name, sum) in [("g", shear), ("k", bulk)] {
        if sum > MOST_RELAXING - 0.005 {
            walls.push(format!(
                "the parts {name} add up to {sum:.3}, which lies on a bound of their search ({MOST_RELAXING}): the material flows more than the law can"
            ));
        }
    }
    let model_error = problem.conditions.iter().map(|c| c.error()).fold(0.0, f64::max);
    let moved = problem.moved_by_model(&found.minimum, model_error);
    let supports = supported(problem, &found.minimum, &ends);
    let spans = spans(problem, &found.minimum, &ends, &supports, &moved);
    let verdicts = judge(&found.minimum.at.hessian, &judged(&problem.unknowns, &spans, &found.minimum.x));
    let correlation = covariance(&found.minimum.at.hessian)
        .map(|c| DMatrix::from_fn(c.nrows(), c.ncols(), |i, j| c[(i, j)] / (c[(i, i)] * c[(j, j)]).sqrt()));
    Ok(Newton {
        supports,
        minimum: found.minimum,
        spans,
        errors,
        correlation,
        verdicts,
        path,
        converged: found.converged,
        came_back: found.came_back,
        spent: budget.is_spent(problem.solves()),
        expected_within: found.expected_within,
        failures,
        walls,
        noises,
        model_error,
        solved: Solved::of(problem),
    })
}

/// Two exponents that enclose most materials, everything else where its guess is; more where solves cost nothing.
fn starts(problem: &Problem<'_>) -> Vec<Vec<f64>> {
    let firsts: &[f64] = if problem.is_free() { &MANY_ALPHA } else { &[FIRST_ALPHA.0, FIRST_ALPHA.1] };
    let at = |alpha: f64| -> Vec<f64> {
        let start = |u: &Unknown| match u.kind {
            Kind::Alpha(0) => u.coordinate(alpha.clamp(u.low, u.high)),
            _ => u.coordinate(u.start.clamp(u.low, u.high)),
        };
        problem.unknowns.iter().map(start).collect()
    };
    firsts.iter().map(|alpha| at(*alpha)).collect()
}

fn judged(unknowns: &[Unknown], spans: &[Span], x: &[f64]) -> Vec<Judged> {
    unknowns
        .iter()
        .zip(spans.iter().zip(x))
        .map(|(unknown, (span, &x))| {
            let (low, high) = unknown.bounds();
            Judged {
                name: unknown.name.clone(),
                range: high - low,
                interval: span.high - span.low,
                open_low: span.open_low,
                open_high: span.open_high,
                at_bound: unknown.stands_on_bound(x),
                logarithmic: unknown.is_logarithmic(),
            }
        })
        .collect()
}

/// Every interval holds the points that the profiles of the other parameters found to explain the data well enough:
/// a profile follows one branch of the valley, and there can be several.
fn spans(
    problem: &Problem<'_>,
    minimum: &Minimum,
    ends: &[(End, End)],
    supports: &[Vec<f64>],
    moved: &[f64],
) -> Vec<Span> {
    let region = problem.region();
    ends.iter()
        .enumerate()
        .map(|(axis, (low, high))| {
            let wider = |distance: f64| distance.hypot(Z95 * moved[axis]);
            let x = minimum.x[axis];
            let all = supports.iter().map(|point| point[axis]);
            let (from, to) = all.fold((low.x, high.x), |(from, to), v| (from.min(v), to.max(v)));
            Span {
                low: (x - wider(x - from)).max(region.low[axis]),
                high: (x + wider(to - x)).min(region.high[axis]),
                open_low: low.at_bound,
                open_high: high.at_bound,
            }
        })
        .collect()
}

/// Ends of profiles that explain the data as well as the edge of an interval may, and where one coordinate slides on from them.
fn supported(problem: &Problem<'_>, minimum: &Minimum, ends: &[(End, End)]) -> Vec<Vec<f64>> {
    let allowed = EDGE * problem.rise();
    let all = ends.iter().flat_map(|(low, high)| [low.support.clone(), high.support.clone()]);
    let mut points: Vec<Vec<f64>> = all.filter(|point| problem.value(point) - minimum.at.value <= allowed).collect();
    // Two coordinates have one valley between them, which their own profiles follow.
    if minimum.x.len() > 2 {
        points.extend(problem.slides(minimum, &points, allowed));
    }
    points
}

impl super::condition::Condition {
    /// Relative error bound of its force.
    #[must_use]
    pub fn error(&self) -> f64 {
        match &self.source {
            // No specimen is round, even and free of friction to better than a solve under a ball is exact.
            Source::Solves(_) if self.is_homogeneous() => MESH_ERROR,
            Source::Solves(_) => MESH_ERROR.max(self.scatter),
            Source::Model(model) => model.error().total(),
            Source::Table(table) => table.error,
        }
    }
}

impl Problem<'_> {
    /// Both ends of every coordinate's interval.
    fn ends(&self, minimum: &Minimum, errors: &[f64]) -> Vec<(End, End)> {
        let end = |axis: usize, sign: f64| self.end(minimum, axis, errors[axis], sign);
        (0..self.unknowns.len())
            .into_par_iter()
            .map(|axis| rayon::join(|| end(axis, -1.0), || end(axis, 1.0)))
            .collect()
    }

    /// Support points that lie far from every solve, as many as the budget allows.
    fn worth_solving(&self, ends: &[(End, End)], errors: &[f64], budget: usize) -> Vec<Vec<f64>> {
        let mut wanted: Vec<Vec<f64>> = Vec::new();
        let near = |a: &[f64], b: &[f64], condition: usize| {
            let locals = &self.conditions[condition].locals;
            locals.iter().all(|&at| (a[at] - b[at]).abs() < NEAR * errors[at])
        };
        let mut left = budget.saturating_sub(self.solves());
        for point in ends.iter().flat_map(|(low, high)| [&low.support, &high.support]) {
            let known = (0..self.conditions.len()).all(|c| {
                self.conditions[c].locals.is_empty()
                    || self.conditions[c].knows(point)
                    || wanted.iter().any(|other| near(point, other, c))
            });
            if !known && left >= self.conditions.len() {
                left -= self.conditions.len();
                wanted.push(point.clone());
            }
        }
        wanted
    }

    /// Ends of the profiles of loose coordinates with another loose one at a bound. Where one takes away the effect of the other, the valley
    /// turns a corner there that no interpolation between the solves of one branch sees.
    fn corners(&self, ends: &[(End, End)], budget: usize) -> Vec<Vec<f64>> {
        let region = self.region();
        let side = |axis: usize| region.high[axis] - region.low[axis];
        let loose: Vec<usize> = (0..ends.len()).filter(|&at| ends[at].1.x - ends[at].0.x > LOOSE * side(at)).collect();
        let left = budget.saturating_sub(self.solves()) / self.conditions.len().max(1);
        let mut wanted: Vec<Vec<f64>> = Vec::new();
        for &from in &loose {
            for &to in loose.iter().filter(|to| **to != from) {
                for (end, bound) in [&ends[from].0, &ends[from].1]
                    .into_iter()
                    .flat_map(|end| [region.low[to], region.high[to]].map(|bound| (end, bound)))
                {
                    let mut point = end.support.clone();
                    // What stands near the bound already says enough.
                    if (point[to] - bound).abs() < LOOSE * side(to) {
                        continue;
                    }
                    point[to] = bound;
                    if !self.is_known(&point) && wanted.len() < left.min(MOST_CORNERS) {
                        wanted.push(point);
                    }
                }
            }
        }
        wanted
    }

    /// Moves the ends of the ramps before holds to where the fitted contact points put them; true if one moved so far that it
    /// has to be solved anew.
    fn anchor(&mut self, point: &[f64]) -> bool {
        let tracks = self.tracks(point);
        let mut moved = false;
        for (at, track) in tracks.iter().enumerate() {
            // A table is that of its own depth.
            if self.conditions[at].hold_s <= 0.0 || matches!(self.conditions[at].source, Source::Table(_)) {
                continue;
            }
            let of_condition: Vec<usize> = self.fitted().filter(|curve| self.condition_of[*curve] == at).collect();
            let shift = |curve: &usize| self.selection.curves[*curve].contact.contact_mm - self.contact(*curve, track);
            let mean = of_condition.iter().map(shift).sum::<f64>() / of_condition.len().max(1) as f64;
            let condition = &mut self.conditions[at];
            if mean.abs() > MOVED * condition.depth_mm {
                condition.depth_mm += mean;
                condition.attach(&self.unknowns);
                moved = true;
            }
        }
        moved
    }

    /// Parameters of a condition at a point.
    #[must_use]
    pub fn values(&self, condition: usize, point: &[f64]) -> Values {
        let condition = &self.conditions[condition];
        let mut values =
            Values { height_mm: condition.block.height_mm, ball_mm: condition.grip.ball_mm(), ..self.base.clone() };
        for &at in condition.locals.iter().chain(std::iter::once(&condition.modulus)) {
            values.set(self.unknowns[at].kind, self.unknowns[at].value(point[at]));
        }
        values
    }
}
