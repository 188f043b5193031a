//! MultiStart of thesis sections 2.5 to 2.8, for any law and number of parameters: a map of Eq. 14, a threshold, and a simplex from every candidate under it.
//!
//! ```text
//! map        step (a), the objective at the points of a grid or of a space-filling sample; (b) the threshold; (c) the candidates
//! descents   step (d), a simplex from each candidate, with a solve where it ends, until it comes back
//! errors     standard errors of a least sum of absolute differences
//! slice      the objective over two of the parameters, for pictures
//! objective  Eq. 14 itself
//! trace      what was looked at
//! ```
//!
//! Eq. 14 is the sum of absolute differences of all samples in newtons, contact points at their best. Its forces are those of
//! [`Problem`], as for Gauss-Newton: force is proportional to the modulus, so that only the other parameters cost solves; between what was solved
//! stand the solves' own values and slopes, and every end that is told was solved.

mod descents;
mod errors;
mod map;
mod objective;
mod slice;
mod trace;

use lut_gen::solid::solve::SolveError;

use super::newton::coordinate::{Kind, Unknown};
use super::newton::problem::Problem;
use super::newton::search::Told;
use super::simplex::Bounds;

pub use errors::StandardErrors;
pub use objective::{as_eq_14, objective_n};
pub use slice::Slice;
pub use trace::{Sampled, Start};

/// All that MultiStart found.
#[derive(Debug, Clone)]
pub struct Search {
    /// What the coordinates are.
    pub unknowns: Vec<Unknown>,
    /// The box searched.
    pub bounds: Bounds,
    /// Step (a), the best point first.
    pub sample: Vec<Sampled>,
    /// E_th of step (b), N.
    pub threshold_n: f64,
    /// Step (d), the best end first.
    pub starts: Vec<Start>,
    /// The objective through the best end, over the first exponent and the modulus.
    pub slice: Slice,
    /// What could not be solved.
    pub failures: Vec<String>,
}

/// How much is tried.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// Most finite-element solves.
    pub most_solves: usize,
    /// Most candidates that a simplex begins from.
    pub starts: usize,
}

/// Most simplex searches of an identification.
pub const STARTS: usize = 8;

impl Effort {
    /// The usual number of starts.
    #[must_use]
    pub fn of(most_solves: usize) -> Self {
        Self { most_solves, starts: STARTS }
    }
}

/// Runs steps (a) to (d) from a problem of which nothing needs to be solved yet; it is left with Eq. 14 as its objective, which counts every newton twice.
///
/// # Errors
/// When no point of the map can be solved.
pub fn search(problem: &mut Problem<'_>, effort: Effort, told: &Told<'_>) -> Result<Search, SolveError> {
    as_eq_14(problem);
    let (bounds, mut failures) = map::solved(problem, effort.most_solves, told)?;
    let sample = map::sampled(problem, &bounds);
    let (threshold_n, candidates) = map::candidates(&sample, &bounds, effort.starts);
    let (starts, failed) = descents::descents(problem, &bounds, &candidates, effort.most_solves, told);
    failures.extend(failed);
    let centre = starts.first().map(|start| start.descent.point.clone()).unwrap_or_default();
    let slice = Slice::of(problem, &bounds, &centre, axes(&problem.unknowns));
    Ok(Search { unknowns: problem.unknowns.clone(), bounds, sample, threshold_n, starts, slice, failures })
}

/// The first exponent and the first modulus; the first two unknowns where there is none.
fn axes(unknowns: &[Unknown]) -> [usize; 2] {
    let find = |wanted: &dyn Fn(Kind) -> bool| unknowns.iter().position(|u| wanted(u.kind));
    let modulus = find(&|kind| kind == Kind::Modulus).unwrap_or(0);
    let other = find(&|kind| matches!(kind, Kind::Alpha(_))).unwrap_or(usize::from(modulus == 0));
    [other.min(unknowns.len().saturating_sub(1)), modulus]
}

impl Search {
    /// The best start came to rest.
    #[must_use]
    pub fn converged(&self) -> bool {
        self.starts.first().is_some_and(|start| start.at_rest)
    }

    /// A point in the user's units, by name.
    pub fn named<'a>(&'a self, point: &'a [f64]) -> impl Iterator<Item = (&'a str, f64)> {
        self.unknowns.iter().zip(point).map(|(unknown, x)| (unknown.name.as_str(), unknown.value(*x)))
    }

    /// Evaluations of the objective, those of the map included.
    #[must_use]
    pub fn evaluations(&self) -> usize {
        self.sample.len() + self.starts.iter().map(|start| start.descent.evaluations).sum::<usize>()
    }

    /// What the reader should know of the search.
    #[must_use]
    pub fn messages(&self) -> Vec<String> {
        let mut messages = Vec::new();
        let best = self.starts.first().map_or(f64::INFINITY, |start| start.descent.value);
        let agreeing = self.starts.iter().filter(|start| start.descent.value <= SAME_VALUE * best).count();
        if agreeing < self.starts.len() {
            messages.push(format!(
                "{agreeing} of {} starts end within 1 % of the best objective; see the map",
                self.starts.len()
            ));
        }
        if !self.converged() {
            messages.push(
                "the best simplex did not come to rest: it would go on from its end, or its solves were spent"
                    .to_owned(),
            );
        }
        messages.extend(self.failures.iter().cloned());
        messages
    }
}

/// Ends within a hundredth of the best objective are one.
const SAME_VALUE: f64 = 1.01;

#[cfg(test)]
mod tests;
