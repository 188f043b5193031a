//! Two terms fitted to a foam of one: the equivalent optima (thesis Table 2).
//!
//! With equal Poisson's ratios a two-term Hyperfoam is one of a single term when one modulus vanishes, whatever its exponent, or when
//! both exponents are equal, however the modulus is divided.

use std::sync::atomic::{AtomicUsize, Ordering};

use lut_gen::solid::model::Resolution;
use rayon::prelude::*;

use crate::identify::data::Selection;
use crate::identify::fe::{ModelError, Progress};
use crate::identify::newton::condition::{Condition, Source};
use crate::identify::newton::coordinate::{Kind, Unknown};
use crate::identify::newton::problem::Problem;
use crate::identify::newton::search::Budget;
use crate::identify::newton::setup;
use crate::identify::newton::surrogate::Node;
use crate::identify::spec::{FitSpec, FittedLaw};
use crate::infer::descent::{Rule, Together, minimise};

use super::{StudyError, Subject};

mod page;

pub use page::study;

/// Exponents and shares of the grid.
const ALPHAS: [f64; 4] = [3.0, 7.0, 13.0, 22.0];
const SHARES: [f64; 3] = [0.15, 0.5, 0.85];
/// A modulus below this share of the whole counts as zero: the largest of Table 2 is 1 % of it.
pub const VANISHED: f64 = 0.02;
/// Exponents within this ratio count as equal.
pub const EQUAL: f64 = 0.05;

/// Which kind of optimum an end is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Optimum {
    /// `mu_2 = 0`: the second exponent means nothing (type 1 of thesis section 2.8).
    SecondVanishes,
    /// `mu_1 = 0`: the first exponent means nothing (type 2).
    FirstVanishes,
    /// `alpha_1 = alpha_2`: only the sum of the moduli means anything (type 3).
    EqualExponents,
    /// Two different terms that together force back as one: exact for no foam, but within the noise of the data.
    Mixture,
}

impl Optimum {
    /// All, in the order of the thesis; the mixture is not among its three.
    pub const ALL: [Optimum; 4] = [Self::SecondVanishes, Self::FirstVanishes, Self::EqualExponents, Self::Mixture];

    /// Classifies a pair of exponents with the share of the second term in the modulus.
    #[must_use]
    pub fn of(alpha: [f64; 2], share_2: f64) -> Self {
        if share_2 < VANISHED {
            Self::SecondVanishes
        } else if share_2 > 1.0 - VANISHED {
            Self::FirstVanishes
        } else if (alpha[0] / alpha[1]).ln().abs() < EQUAL {
            Self::EqualExponents
        } else {
            Self::Mixture
        }
    }

    /// In words.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::SecondVanishes => "mu_2 = 0",
            Self::FirstVanishes => "mu_1 = 0",
            Self::EqualExponents => "alpha_1 = alpha_2",
            Self::Mixture => "mixture",
        }
    }
}

/// Where one start ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct End {
    /// Exponents it started from, and the share of the second term.
    pub start: Start,
    /// Modulus of both terms together, MPa.
    pub mu_mpa: f64,
    /// Exponents.
    pub alpha: [f64; 2],
    /// Share of the second term in the modulus.
    pub share_2: f64,
    /// Loss above that of the best end; below 3.84 one parameter's 95 % interval holds both.
    pub above_best: f64,
    /// Kind of optimum.
    pub optimum: Optimum,
}

/// Exponents, and the share of the second term.
type Start = ([f64; 2], f64);

/// What the study is made with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// Starts.
    pub starts: usize,
    /// Mesh of the fits.
    pub resolution: Resolution,
}

/// Places of the coordinates.
struct Places {
    mu: usize,
    alpha: [usize; 2],
    share: usize,
}

impl Places {
    fn of(unknowns: &[Unknown]) -> Self {
        let place = |kind: Kind| unknowns.iter().position(|u| u.kind == kind).unwrap_or(0);
        Self {
            mu: place(Kind::Modulus),
            alpha: [place(Kind::Alpha(0)), place(Kind::Alpha(1))],
            share: place(Kind::Share),
        }
    }

    fn point(&self, unknowns: &[Unknown], (alpha, share): Start) -> Vec<f64> {
        let mut point: Vec<f64> = unknowns.iter().map(|u| u.coordinate(u.start)).collect();
        for (place, alpha) in self.alpha.iter().zip(alpha) {
            point[*place] = unknowns[*place].coordinate(alpha);
        }
        point[self.share] = share;
        point
    }
}

fn two_terms() -> FitSpec {
    FitSpec { law: Some(FittedLaw::Hyperfoam), terms: Some(2), ..FitSpec::default() }
}

/// The grid without its mirror images: which term is called the first changes nothing.
fn grid() -> Vec<Start> {
    let mut all = Vec::new();
    for (i, &first) in ALPHAS.iter().enumerate() {
        for &second in &ALPHAS[i..] {
            let halves = if first == second { 2 } else { SHARES.len() };
            all.extend(SHARES.iter().take(halves).map(|&share| ([first, second], share)));
        }
    }
    all
}

/// The mirror image of what was solved: terms exchanged.
fn mirrored(node: &Node) -> Node {
    let exchanged = |x: &[f64]| vec![x[1], x[0], 1.0 - x[2]];
    let negative = node.by[2].iter().map(|by| -by).collect();
    Node {
        x: exchanged(&node.x),
        value: node.value.clone(),
        by: vec![node.by[1].clone(), node.by[0].clone(), negative],
    }
}

/// MultiStart: grid, the best grid points as starts, Gauss-Newton from each on finite elements. Also the number of solves.
///
/// # Errors
/// Data that cannot be used, or solves that fail.
pub fn ends(
    subject: &Subject,
    selection: &Selection,
    effort: &Effort,
    progress: &Progress<'_>,
) -> Result<(Vec<End>, usize), StudyError> {
    let failed = |cause| ModelError::Solve { what: subject.material.clone(), cause };
    let source = |_: &Condition| Source::Solves(effort.resolution);
    let mut problem = setup::problem(&subject.experiment, selection, &subject.material, &two_terms(), &source);
    problem.weigh_by_samples(subject.experiment.sensor.noise_n);
    let places = Places::of(&problem.unknowns);
    let half = grid();
    let done = AtomicUsize::new(0);
    let solved: Vec<Vec<_>> = half
        .par_iter()
        .map(|start| {
            let point = places.point(&problem.unknowns, *start);
            let solve = |c: &Condition| c.solve(&problem.base, &problem.unknowns, &point);
            let nodes = problem.conditions.iter().map(solve).collect();
            progress("grid of MultiStart", done.fetch_add(1, Ordering::Relaxed) + 1, half.len());
            nodes
        })
        .collect();
    for (at, condition) in problem.conditions.iter_mut().enumerate() {
        for (node, _) in solved.iter().filter_map(|of_point| of_point[at].as_ref().ok()) {
            condition.surrogate.learn(mirrored(node));
            condition.surrogate.learn(node.clone());
        }
        condition.solves += half.len();
    }
    // A corner that cannot be solved is no start.
    let solvable = half.iter().zip(&solved).filter(|(_, nodes)| nodes.iter().all(Result::is_ok));
    let mut starts: Vec<Start> = solvable.map(|(start, _)| *start).collect();
    let images: Vec<Start> = starts.iter().map(|([a, b], share)| ([*b, *a], 1.0 - share)).collect();
    // Two equal halves are their own image.
    starts.extend(images.into_iter().filter(|image| image.0[0] != image.0[1] || image.1 != 0.5));
    let starts = best_of(&problem, &places, starts, effort.starts);
    let mut found = Vec::new();
    for (at, start) in starts.iter().enumerate() {
        progress("starts", at, starts.len());
        let point = places.point(&problem.unknowns, *start);
        let end = problem.search_near(&[point], &Budget::endless(), &|_| {}).map_err(failed)?;
        found.push((*start, end.minimum));
    }
    progress("starts", starts.len(), starts.len());
    let best = found.iter().map(|(_, end)| end.at.value).fold(f64::INFINITY, f64::min);
    let unknowns = &problem.unknowns;
    let ends = found.iter().map(|(start, end)| {
        let value = |at: usize| unknowns[at].value(end.x[at]);
        let (alpha, share_2) = (places.alpha.map(value), value(places.share));
        End {
            start: *start,
            mu_mpa: value(places.mu),
            alpha,
            share_2,
            above_best: end.at.value - best,
            optimum: Optimum::of(alpha, share_2),
        }
    });
    Ok((ends.collect(), problem.solves()))
}

/// The grid points with the least loss, each at its best modulus: those below MultiStart's threshold.
fn best_of(problem: &Problem<'_>, places: &Places, starts: Vec<Start>, count: usize) -> Vec<Start> {
    let mut region = problem.region();
    let mut judged: Vec<(Start, f64)> = starts
        .into_iter()
        .map(|start| {
            let point = places.point(&problem.unknowns, start);
            for axis in (0..point.len()).filter(|axis| *axis != places.mu) {
                (region.low[axis], region.high[axis]) = (point[axis], point[axis]);
            }
            (start, minimise(&Together(|x: &[f64]| problem.quadratic(x)), &region, &point, &Rule::default()).value)
        })
        .collect();
    judged.sort_by(|a, b| a.1.total_cmp(&b.1));
    judged.truncate(count);
    judged.into_iter().map(|(start, _)| start).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_thesis_own_optima_are_of_its_three_kinds() {
        // Table 2: mu_1, alpha_1, mu_2, alpha_2, and the type that section 2.8 gives it.
        let rows = [
            (0.221, 10.65, 3.75e-4, 3.43, Optimum::SecondVanishes),
            (0.220, 10.52, 1.13e-4, 8.53, Optimum::SecondVanishes),
            (6.45e-4, 8.50, 0.219, 10.52, Optimum::FirstVanishes),
            (0.094, 10.52, 0.126, 10.52, Optimum::EqualExponents),
            (0.085, 10.52, 0.134, 10.52, Optimum::EqualExponents),
            (0.001, 12.69, 0.192, 12.72, Optimum::FirstVanishes),
            (0.191, 12.69, 0.001, 3.31, Optimum::SecondVanishes),
            (0.118, 12.74, 0.075, 12.73, Optimum::EqualExponents),
        ];
        for (mu_1, alpha_1, mu_2, alpha_2, kind) in rows {
            assert_eq!(Optimum::of([alpha_1, alpha_2], mu_2 / (mu_1 + mu_2)), kind, "{mu_1} {mu_2}");
        }
        assert_eq!(Optimum::of([8.0, 16.0], 0.5), Optimum::Mixture);
    }

    #[test]
    fn exchanging_the_terms_twice_changes_nothing() {
        let node = Node { x: vec![1.0, 2.0, 0.25], value: vec![5.0], by: vec![vec![1.0], vec![2.0], vec![3.0]] };
        let twice = mirrored(&mirrored(&node));
        assert_eq!(twice, node);
        assert_eq!(mirrored(&node).x, [2.0, 1.0, 0.75]);
        assert_eq!(mirrored(&node).by[2], [-3.0]);
    }
}
