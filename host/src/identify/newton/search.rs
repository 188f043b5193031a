//! Solve, minimise on what is known, solve there: until nothing moves.

use rayon::prelude::*;

use lut_gen::solve::SolveError;

use crate::infer::descent::{Minimum, Region};

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
    /// The search came to rest before its solves were spent.
    pub converged: bool,
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

/// A step this small in standard errors is no step: it adds 2 % of the noise's own scatter.
const AT_REST: f64 = 0.02;
/// And so is one below this share of every range, where the data have no noise to speak of.
const NO_STEP: f64 = 1e-6;
/// First half-width of the trust region as a share of the ranges, and the least.
const FIRST_TRUST: f64 = 0.35;
const LEAST_TRUST: f64 = 1e-4;
/// Share of the promised gain that makes a step good.
const GOOD: f64 = 0.1;

/// What is told after every solve: solves so far.
pub type Told<'a> = dyn Fn(usize) + Sync + 'a;

impl Problem<'_> {
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
        first
    }

    /// Finite-element solves so far.
    #[must_use]
    pub fn solves(&self) -> usize {
        self.conditions.iter().filter(|c| !c.is_homogeneous()).map(|c| c.solves).sum()
    }

    /// Solves so far, homogeneous ones included.
    #[must_use]
    pub fn evaluations(&self) -> usize {
        self.conditions.iter().map(|c| c.solves).sum()
    }

    /// The best moduli at fixed other coordinates.
    fn with_best_moduli(&self, point: &[f64]) -> Minimum {
        let mut region = self.region();
        for (axis, unknown) in self.unknowns.iter().enumerate() {
            if unknown.kind != super::coordinate::Kind::Modulus {
                (region.low[axis], region.high[axis]) = (point[axis], point[axis]);
            }
        }
        self.minimised(&region, point)
    }

    /// Searches from the given points, which are solved first. At most `budget` solves.
    ///
    /// # Errors
    /// When none of the first points can be solved.
    pub fn search(&mut self, starts: &[Vec<f64>], budget: usize, told: &Told<'_>) -> Result<Found, SolveError> {
        let mut failures = Vec::new();
        let first = self.solve_at(starts);
        told(self.solves());
        let full = self.region();
        let known = |problem: &Self, point: &[f64]| problem.conditions.iter().all(|c| c.knows(point));
        let mut path: Vec<Visit> = Vec::new();
        for start in starts {
            if known(self, start) {
                let end = self.with_best_moduli(start);
                path.push(Visit { point: end.x, value: end.at.value });
            }
        }
        let Some(mut best) = path.iter().min_by(|a, b| a.value.total_cmp(&b.value)).cloned() else {
            return Err(first.err().unwrap_or(SolveError::Parameter {
                parameter: "starts",
                value: 0.0,
                expected: "but at least one is needed".to_owned(),
            }));
        };
        failures.extend(first.err().map(|cause| cause.to_string()));
        let mut trust = FIRST_TRUST;
        let mut expected_within = f64::INFINITY;
        loop {
            let aim = self.minimised(&around(&full, &best.point, trust), &best.point);
            if self.rests(&best.point, &aim) {
                // The minimum between solves, so near to one that the solve there would add nothing.
                return Ok(Found { minimum: aim, path, converged: true, expected_within, failures });
            }
            if self.evaluations() >= budget || trust < LEAST_TRUST {
                let minimum = self.with_best_moduli(&best.point);
                return Ok(Found { minimum, path, converged: false, expected_within, failures });
            }
            let expected = self.tracks(&aim.x);
            match self.solve_at(std::slice::from_ref(&aim.x)) {
                Ok(()) => {}
                Err(cause) => {
                    failures.push(cause.to_string());
                    trust *= 0.3;
                    continue;
                }
            }
            told(self.solves());
            expected_within = self.differ(&aim.x, &expected);
            let there = self.with_best_moduli(&aim.x);
            path.push(Visit { point: there.x.clone(), value: there.at.value });
            let promised = best.value - aim.at.value;
            if there.at.value <= best.value - GOOD * promised {
                best = Visit { point: there.x, value: there.at.value };
                trust = (2.0 * trust).min(1.0);
            } else {
                if there.at.value < best.value {
                    best = Visit { point: there.x, value: there.at.value };
                }
                trust *= 0.4;
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
fn around(full: &Region, point: &[f64], trust: f64) -> Region {
    let side = |i: usize| trust * (full.high[i] - full.low[i]);
    Region {
        low: (0..point.len()).map(|i| (point[i] - side(i)).max(full.low[i])).collect(),
        high: (0..point.len()).map(|i| (point[i] + side(i)).min(full.high[i])).collect(),
        held: full.held,
    }
}
