//! Step (d): a simplex from each candidate, on what was solved, with a solve where it ends.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::identify::newton::problem::Problem;
use crate::identify::newton::search::Told;
use crate::identify::newton::valley::Solved;
use crate::identify::simplex::{self, Bounds, Descent, Stop};
use crate::identify::spec::Loss;

use super::{Start, objective_n};

/// First edge of a simplex as a share of the box.
const EDGE: f64 = 0.08;
/// Half the box of a restart and its first edge, in standard errors: there the valley is round.
const REACH: f64 = 20.0;
const ROUND_EDGE: f64 = 2.0;
/// Where the last solve showed that what stands between solves was wrong, the next edge is shorter by this.
const SHORTER: f64 = 0.35;
/// Relative gain that no further simplex is started for: of a thousand samples a twentieth of a standard error.
const WORTHWHILE: f64 = 5e-6;
/// Restarts of one search.
const MOST_ROUNDS: usize = 20;
/// An end as near as this to one at rest, in every coordinate as a share of the box, is that one.
const SAME: f64 = 0.01;
/// Iterations of a simplex, and more a parameter.
const ITERATIONS: (usize, usize) = (80, 50);
/// A simplex smaller than this share of its box is a point, if its values agree to the second.
const SIZE: f64 = 2e-4;
const SPREAD: f64 = 1e-7;
/// Standard errors of data without noise: this share of the largest force stands for it.
const LEAST_NOISE: f64 = 1e-5;

/// A search on its way.
struct Way {
    /// All of it so far; its end is solved.
    descent: Descent,
    edge: f64,
    rounds: usize,
    at_rest: bool,
}

/// Searches from all candidates at once, round by round; the best end first, and what failed.
pub(super) fn descents(
    problem: &mut Problem<'_>,
    bounds: &Bounds,
    candidates: &[Vec<f64>],
    budget: usize,
    told: &Told<'_>,
) -> (Vec<Start>, Vec<String>) {
    let begin = |point: &Vec<f64>| {
        let value = objective_n(problem, point);
        let descent =
            Descent { point: point.clone(), value, path: vec![point.clone()], counts: vec![1], evaluations: 1 };
        Way { descent, edge: ROUND_EDGE, rounds: 0, at_rest: false }
    };
    let mut ways: Vec<Way> = candidates.iter().map(begin).collect();
    let mut failures = Vec::new();
    for _ in 0..MOST_ROUNDS {
        let active: Vec<usize> = (0..ways.len()).filter(|at| ways[*at].goes_on()).collect();
        if active.is_empty() {
            break;
        }
        let round = Round::of(problem, bounds);
        let ends: Vec<Descent> = active.par_iter().map(|at| round.descended(&ways[*at])).collect();
        let promising: Vec<(usize, Descent)> =
            active.into_iter().zip(ends).filter(|(at, end)| ways[*at].is_promised(end)).collect();
        let resting: Vec<(Vec<f64>, f64)> =
            ways.iter().filter(|way| way.at_rest).map(|way| (way.descent.point.clone(), way.descent.value)).collect();
        let same = |a: &[f64], b: &[f64]| (0..a.len()).all(|i| (a[i] - b[i]).abs() <= SAME * bounds.side(i));
        let promising: Vec<(usize, Descent)> = promising
            .into_iter()
            .filter_map(|(at, end)| match resting.iter().find(|(point, _)| same(point, &end.point)) {
                Some((point, value)) if *value < ways[at].descent.value => {
                    ways[at].take(Descent { point: point.clone(), ..end }, *value);
                    ways[at].at_rest = true;
                    None
                }
                _ => Some((at, end)),
            })
            .collect();
        if promising.is_empty() {
            continue;
        }
        let unsolved = |end: &Descent| problem.conditions.iter().filter(|c| !c.knows(&end.point)).count();
        let mut left = budget.saturating_sub(problem.solves());
        let affordable: Vec<(usize, Descent)> = promising
            .into_iter()
            .filter(|(_, end)| {
                let cost = unsolved(end);
                let pays = cost <= left;
                left -= if pays { cost } else { 0 };
                pays
            })
            .collect();
        if affordable.is_empty() {
            break;
        }
        let points: Vec<Vec<f64>> = affordable.iter().map(|(_, end)| end.point.clone()).collect();
        failures.extend(problem.solve_at(&points).err().map(|cause| format!("a solve on the way failed: {cause}")));
        told(problem.solves());
        for (at, end) in affordable {
            let value = if problem.is_known(&end.point) { objective_n(problem, &end.point) } else { f64::INFINITY };
            ways[at].take(end, value);
        }
    }
    failures.dedup();
    ways.sort_by(|a, b| a.descent.value.total_cmp(&b.descent.value));
    (ways.into_iter().map(|way| Start { descent: way.descent, at_rest: way.at_rest }).collect(), failures)
}

impl Way {
    fn goes_on(&self) -> bool {
        !self.at_rest && self.descent.value.is_finite()
    }

    /// Counts a simplex that began at the way's end; false where it came back. That end is solved, so that its true value and slopes stand around
    /// it; only a simplex of the full edge in coordinates in which the valley is round tells that it rests.
    fn is_promised(&mut self, end: &Descent) -> bool {
        self.rounds += 1;
        self.descent.evaluations += end.evaluations;
        let promised = self.descent.value - end.value > WORTHWHILE * self.descent.value;
        if !promised {
            self.at_rest = self.rounds > 1 && self.edge >= ROUND_EDGE;
            self.edge = ROUND_EDGE;
        }
        promised
    }

    /// Goes to the end of a simplex if its true value is better.
    fn take(&mut self, end: Descent, value: f64) {
        let promised = self.descent.value - end.value;
        let gained = self.descent.value - value;
        if gained > 0.0 {
            let before = self.descent.evaluations - end.evaluations;
            self.descent.path.extend(end.path);
            self.descent.counts.extend(end.counts.iter().map(|count| before + count));
            self.descent.point = end.point;
            self.descent.value = value;
        }
        // NaN gains nothing.
        if gained >= 0.25 * promised {
            self.edge = ROUND_EDGE;
        } else {
            self.edge *= SHORTER;
        }
    }
}

/// What one round's simplices see.
struct Round<'a> {
    problem: &'a Problem<'a>,
    bounds: &'a Bounds,
    /// The same with squares as its loss: their Hessian says how long the valley is in every direction.
    squares: Problem<'a>,
    samples: f64,
    peak_n: f64,
}

impl<'a> Round<'a> {
    fn of(problem: &'a Problem<'a>, bounds: &'a Bounds) -> Self {
        let mut squares = Solved::of(problem).on(problem.selection);
        squares.loss = Loss::Squares;
        let peak_n = problem
            .fitted()
            .flat_map(|at| problem.selection.curves[at].force_n.iter().copied())
            .fold(f64::MIN_POSITIVE, f64::max);
        Self { problem, bounds, squares, samples: problem.samples().max(1) as f64, peak_n }
    }

    fn descended(&self, way: &Way) -> Descent {
        let count = way.descent.point.len();
        let stop = Stop { size: SIZE, spread: SPREAD, iterations: ITERATIONS.0 + ITERATIONS.1 * count };
        let start = &way.descent.point;
        if way.rounds == 0 {
            return simplex::descend(&|x: &[f64]| objective_n(self.problem, x), self.bounds, start, EDGE, stop);
        }
        let Some(round) = self.round(start) else {
            let edge = 0.1 * EDGE * way.edge;
            return simplex::descend(&|x: &[f64]| objective_n(self.problem, x), self.bounds, start, edge, stop);
        };
        let place = |z: &[f64]| -> Vec<f64> {
            let step = round.solve_upper_triangular(&DVector::from_column_slice(z));
            let moved = |i: usize| start[i] + step.as_ref().map_or(0.0, |step| step[i]);
            self.bounds.inside(&(0..count).map(moved).collect::<Vec<_>>())
        };
        // A shorter edge has a smaller box, so that the surrogate is left less far behind.
        let reach = REACH * (way.edge / ROUND_EDGE);
        let own = Bounds { low: vec![-reach; count], high: vec![reach; count] };
        let objective = |z: &[f64]| objective_n(self.problem, &place(z));
        let end = simplex::descend(&objective, &own, &vec![0.0; count], way.edge / (2.0 * reach), stop);
        let path = end.path.iter().map(|z| place(z)).collect();
        Descent { point: place(&end.point), path, ..end }
    }

    /// The factor `R` of `R'R`, the information of the samples about the coordinates around a point; a coordinate that they know nothing of
    /// is known to lie in its box.
    fn round(&self, point: &[f64]) -> Option<DMatrix<f64>> {
        let at = self.squares.quadratic(point);
        let variance = (at.value / self.samples).max((LEAST_NOISE * self.peak_n).powi(2));
        let mut information = at.hessian / variance;
        for axis in 0..point.len() {
            information[(axis, axis)] += self.bounds.side(axis).max(f64::MIN_POSITIVE).powi(-2);
        }
        Some(information.cholesky()?.l().transpose())
    }
}
