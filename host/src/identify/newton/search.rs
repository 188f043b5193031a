//! Solve, minimise on what is known, solve there: until nothing moves, and nothing better is promised anywhere.

use std::time::Instant;

use rayon::prelude::*;

use lut_gen::solid::solve::SolveError;

use crate::infer::descent::{Minimum, Region};

use super::elsewhere::{Around, TRIES};
use super::problem::Problem;

/// One point that was solved, and the objective there.
#[derive(Debug, Clone, PartialEq)]
pub struct Visit {
    /// Coordinates, the modulus at its best.
    pub point: Vec<f64>,
    /// Objective.
    pub value: f64,
}

/// How a search ended.
#[derive(Debug, Clone)]
pub struct Found {
    /// The minimum, on finite elements solved at the minimum itself.
    pub minimum: Minimum,
    /// Points in the order of their solves.
    pub path: Vec<Visit>,
    /// The search came to rest, and what was tried against its end failed to better it.
    pub converged: bool,
    /// Searches from points around the end, and those of them that came back to its objective.
    pub came_back: (usize, usize),
    /// Largest relative difference of the force at the last point between what was expected and what was solved.
    pub expected_within: f64,
    /// Solves that failed on the way, in the solver's words.
    pub failures: Vec<String>,
}

impl Found {
    /// A search that goes on where another ended: where it solved nothing new, the last solve is still the other's.
    #[must_use]
    pub fn after(mut self, other: &Found) -> Self {
        if self.expected_within.is_infinite() {
            self.expected_within = other.expected_within;
        }
        self
    }
}

/// What a fit may spend.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Budget {
    /// Most solves.
    pub most_solves: usize,
    /// When to end with the best so far; `None` for no such time.
    pub until: Option<Instant>,
}

impl Budget {
    /// As much as it takes.
    #[must_use]
    pub fn endless() -> Self {
        Self { most_solves: usize::MAX, until: None }
    }

    /// True when no more is to be begun.
    #[must_use]
    pub fn is_spent(&self, solves: usize) -> bool {
        solves >= self.most_solves || self.is_late()
    }

    /// True when the time is over.
    #[must_use]
    pub fn is_late(&self) -> bool {
        self.until.is_some_and(|until| Instant::now() >= until)
    }
}

/// How thorough a search is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Effort {
    /// Its end is where another begins: it is not held against searches from elsewhere.
    Start,
    /// The whole box.
    Whole,
    /// It begins from the ends of one that looked at the whole box.
    Again,
}

/// A step this small in standard errors is no step: it adds 2 % of the noise's own scatter.
const AT_REST: f64 = 0.02;
/// And so is one below this share of every range, where the data have no noise to speak of.
const NO_STEP: f64 = 1e-6;
/// First half-width of the trust region as a share of the ranges, and the least.
const FIRST_TRUST: f64 = 0.35;
const LEAST_TRUST: f64 = 1e-4;
/// Share of the promised gain that makes a step good.
const GOOD: f64 = 0.1;
/// Where the end of a search promises less than this, in units of chi-squared, or than this share of the objective, it is a minimum.
const PROMISES: (f64, f64) = (0.01, 1e-5);

/// What is told after every solve: solves so far.
pub type Told<'a> = dyn Fn(usize) + Sync + 'a;

/// Where a search stands.
struct State {
    path: Vec<Visit>,
    best: Visit,
    expected_within: f64,
    failures: Vec<String>,
}

impl Problem<'_> {
    /// True where nothing has to be solved at a point in any condition.
    pub(in crate::identify) fn is_known(&self, point: &[f64]) -> bool {
        self.conditions.iter().all(|condition| condition.knows(point))
    }

    /// Solves at a point wherever that is not yet done, in parallel.
    ///
    /// # Errors
    /// The first condition that fails, in their order; the others keep what they learnt.
    pub fn solve_at(&mut self, points: &[Vec<f64>]) -> Result<(), SolveError> {
        let (base, unknowns) = (&self.base, &self.unknowns);
        let jobs: Vec<(usize, &Vec<f64>)> = (0..self.conditions.len())
            .flat_map(|at| points.iter().map(move |point| (at, point)))
            .filter(|(at, point)| !self.conditions[*at].knows(point))
            .collect();
        let solved: Vec<_> =
            jobs.par_iter().map(|(at, point)| (*at, self.conditions[*at].solve(base, unknowns, point))).collect();
        let mut first = Ok(());
        for (at, outcome) in solved {
            let condition = &mut self.conditions[at];
            condition.solves += usize::from(matches!(condition.source, super::condition::Source::Solves(_)));
            match outcome {
                Ok((node, scatter)) => {
                    condition.surrogate.learn(node);
                    condition.scatter = condition.scatter.max(scatter);
                }
                Err(cause) => first = first.and(Err(cause)),
            }
        }
        self.conditions.iter_mut().for_each(|condition| condition.surrogate.settle());
        first
    }

    /// Finite-element solves so far.
    #[must_use]
    pub fn solves(&self) -> usize {
        self.conditions.iter().map(|c| c.solves).sum()
    }

    /// True where no condition needs finite elements or interpolation.
    #[must_use]
    pub fn is_free(&self) -> bool {
        self.conditions.iter().all(|c| c.is_homogeneous())
    }

    /// The best moduli at fixed other coordinates.
    pub(super) fn with_best_moduli(&self, point: &[f64]) -> Minimum {
        let mut region = self.region();
        for (axis, unknown) in self.unknowns.iter().enumerate() {
            if unknown.kind != super::coordinate::Kind::Modulus {
                (region.low[axis], region.high[axis]) = (point[axis], point[axis]);
            }
        }
        self.minimised(&region, &self.scaled(point))
    }

    fn visit(&self, point: &[f64]) -> Visit {
        if self.is_free() {
            // Descents go on from there all the same.
            let point = self.scaled(point);
            return Visit { value: self.value(&point), point };
        }
        let end = self.with_best_moduli(point);
        Visit { point: end.x, value: end.at.value }
    }

    /// Searches from the given points, which are solved first, and from all over the box on what is known by then.
    ///
    /// # Errors
    /// When none of the first points can be solved.
    pub fn search(&mut self, starts: &[Vec<f64>], budget: &Budget, told: &Told<'_>) -> Result<Found, SolveError> {
        self.search_in(&self.region(), Effort::Whole, starts, budget, told)
    }

    /// The same from the points that a search with other weights visited: the box is not filled anew.
    ///
    /// # Errors
    /// As [`Problem::search`].
    pub fn search_again(
        &mut self,
        visited: &[Vec<f64>],
        budget: &Budget,
        told: &Told<'_>,
    ) -> Result<Found, SolveError> {
        self.search_in(&self.region(), Effort::Again, visited, budget, told)
    }

    /// The minimum whose valley the best of the given points lies in, which are solved first; there may be lower ones.
    ///
    /// # Errors
    /// As [`Problem::search`].
    pub fn search_near(&mut self, starts: &[Vec<f64>], budget: &Budget, told: &Told<'_>) -> Result<Found, SolveError> {
        let mut state = self.begun(starts, told)?;
        let region = self.region();
        let (minimum, converged) = self.refined_in(&region, &mut state, budget, told);
        let State { path, expected_within, failures, .. } = state;
        Ok(Found { minimum, path, converged, came_back: (0, 0), expected_within, failures })
    }

    /// Solves the starts; a search stands at the best of them.
    fn begun(&mut self, starts: &[Vec<f64>], told: &Told<'_>) -> Result<State, SolveError> {
        let first = self.solve_at(starts);
        told(self.solves());
        let known = |point: &&Vec<f64>| self.is_known(point);
        let path: Vec<Visit> =
            starts.iter().filter(known).map(|start| self.visit(start)).filter(|v| v.value.is_finite()).collect();
        let Some(best) = path.iter().min_by(|a, b| a.value.total_cmp(&b.value)).cloned() else {
            return Err(first.err().unwrap_or(SolveError::Parameter {
                parameter: "starts",
                value: 0.0,
                expected: "but at least one is needed".to_owned(),
            }));
        };
        let failures = first.err().map(|cause| cause.to_string()).into_iter().collect();
        Ok(State { path, best, expected_within: f64::INFINITY, failures })
    }

    /// As [`Problem::search`], inside a part of the box: a simpler law is one.
    ///
    /// # Errors
    /// As [`Problem::search`].
    pub fn search_in(
        &mut self,
        region: &Region,
        effort: Effort,
        starts: &[Vec<f64>],
        budget: &Budget,
        told: &Told<'_>,
    ) -> Result<Found, SolveError> {
        let mut state = self.begun(starts, told)?;
        if self.is_free() {
            return Ok(self.descended(region, state.path, effort, budget));
        }
        let mut refused: Vec<Vec<f64>> = Vec::new();
        loop {
            let (minimum, rested) = self.refined_in(region, &mut state, budget, told);
            if effort == Effort::Start {
                let State { path, expected_within, failures, .. } = state;
                return Ok(Found { minimum, path, converged: false, came_back: (0, 0), expected_within, failures });
            }
            let around = self.around(region, &minimum, &refused, budget);
            let lower = around.lower.first().cloned();
            let spent = budget.is_spent(self.solves()) || refused.len() >= TRIES;
            let Some(aim) = lower.filter(|_| rested && !spent) else {
                let converged = rested && self.is_minimum(&minimum, &around) && !budget.is_late();
                let State { path, expected_within, failures, .. } = state;
                return Ok(Found { minimum, path, converged, came_back: around.back, expected_within, failures });
            };
            if let Err(cause) = self.solve_at(std::slice::from_ref(&aim.x)) {
                state.failures.push(cause.to_string());
                refused.push(aim.x);
                continue;
            }
            told(self.solves());
            let there = self.visit(&aim.x);
            state.path.push(there.clone());
            if there.value < state.best.value {
                state.best = there;
            } else {
                refused.push(aim.x);
            }
        }
    }

    /// True when the projected gradient has vanished, no search from elsewhere ends lower, and most of those from around come back.
    pub(super) fn is_minimum(&self, minimum: &Minimum, around: &Around) -> bool {
        let (back, tried) = around.back;
        let promises = minimum.promised <= PROMISES.0.max(PROMISES.1 * minimum.at.value.abs());
        promises && around.lower.is_empty() && 2 * back >= tried
    }

    /// Goes on from the best point inside a trust region; the minimum, and whether it came to rest.
    fn refined_in(&mut self, region: &Region, state: &mut State, budget: &Budget, told: &Told<'_>) -> (Minimum, bool) {
        let mut trust = FIRST_TRUST;
        loop {
            let aim = self.minimised(&within(region, &state.best.point, trust), &state.best.point);
            if self.rests(&state.best.point, &aim) {
                // The minimum between solves, so near to one that the solve there would add nothing.
                return (aim, true);
            }
            if budget.is_spent(self.solves()) || trust < LEAST_TRUST {
                return (self.with_best_moduli(&state.best.point), false);
            }
            let expected = self.tracks(&aim.x);
            if let Err(cause) = self.solve_at(std::slice::from_ref(&aim.x)) {
                state.failures.push(cause.to_string());
                trust *= 0.3;
                continue;
            }
            told(self.solves());
            state.expected_within = self.differ(&aim.x, &expected);
            let there = self.visit(&aim.x);
            state.path.push(there.clone());
            let promised = state.best.value - aim.at.value;
            let is_good = there.value <= state.best.value - GOOD * promised;
            trust = if is_good { (2.0 * trust).min(1.0) } else { 0.4 * trust };
            if there.value < state.best.value {
                state.best = there;
            }
        }
    }

    /// True when a step is nothing beside the standard errors.
    fn rests(&self, from: &[f64], aim: &Minimum) -> bool {
        let region = self.region();
        let still = (0..from.len()).all(|i| (aim.x[i] - from[i]).abs() <= NO_STEP * (region.high[i] - region.low[i]));
        if still {
            return true;
        }
        // d' H d is the squared length of the step in standard errors.
        let step = nalgebra::DVector::from_fn(from.len(), |i, _| aim.x[i] - from[i]);
        (&aim.at.hessian * &step).dot(&step) < AT_REST * AT_REST
    }

    /// Largest difference between tracks that were expected and those solved, relative to the force of the peak.
    fn differ(&self, point: &[f64], expected: &[super::track::Track]) -> f64 {
        let solved = self.tracks(point);
        let conditions = self.conditions.iter().zip(solved.iter().zip(expected));
        conditions
            .map(|(condition, (solved, expected))| {
                let peak = solved.ramp(condition.depth_mm).0;
                (1..=16)
                    .map(|i| condition.depth_mm * f64::from(i) / 16.0)
                    .map(|d| (solved.ramp(d).0 - expected.ramp(d).0).abs() / peak)
                    .fold(0.0, f64::max)
            })
            .fold(0.0, f64::max)
    }
}

/// The part of the box within `trust` times its sides of a point.
fn within(full: &Region, point: &[f64], trust: f64) -> Region {
    let side = |i: usize| trust * (full.high[i] - full.low[i]);
    Region {
        low: (0..point.len()).map(|i| (point[i] - side(i)).max(full.low[i])).collect(),
        high: (0..point.len()).map(|i| (point[i] + side(i)).min(full.high[i])).collect(),
        held: full.held,
    }
}
