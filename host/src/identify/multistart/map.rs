//! Steps (a) to (c): the objective over the whole box, the threshold, the candidates.

use rayon::prelude::*;

use lut_gen::solid::solve::SolveError;

use crate::identify::newton::coordinate::{Kind, Unknown};
use crate::identify::newton::problem::{MOST_RELAXING, Problem};
use crate::identify::newton::search::Told;
use crate::identify::newton::setup::FIRST_ALPHA;
use crate::identify::simplex::Bounds;
use crate::infer::descent::Region;
use crate::infer::starts::filling;

use super::{Sampled, objective_n};

/// Points over each parameter that costs solves: the thesis' 12 for one, 6 for two; with more, so many points of a
/// space-filling sample a parameter.
const ONE: usize = 12;
const TWO: usize = 6;
const MANY: usize = 16;
/// Points over the modulus, which costs none.
const MODULI: usize = 12;
/// Moduli reach this factor beyond what the points of the map ask for.
const BEYOND: f64 = 3.0;
/// Share of the solves that the map may take.
const SHARE: f64 = 0.5;
/// Share of the map's points that lie under the threshold.
const UNDER: f64 = 0.15;
/// Candidates nearer than this in every coordinate, as a share of the box, are one.
const NEIGHBOURS: f64 = 0.13;
/// Exponents of the map; the simplex may leave them.
const ALPHA: (f64, f64) = (1.0, 24.0);
/// Moduli that are looked through for the best one, and halvings after that.
const SCAN: usize = 24;
const SECTIONS: usize = 14;

/// Solves the map's points; returns the box, and what failed.
///
/// # Errors
/// When no point can be solved.
pub(super) fn solved(
    problem: &mut Problem<'_>,
    budget: usize,
    told: &Told<'_>,
) -> Result<(Bounds, Vec<String>), SolveError> {
    let costly = problem.conditions.iter().filter(|c| !c.is_homogeneous()).count();
    let most = ((SHARE * budget as f64) as usize).checked_div(costly).unwrap_or(usize::MAX);
    let points = design(problem, most.max(2));
    let first = problem.solve_at(&points);
    told(problem.solves());
    let known: Vec<&Vec<f64>> = points.iter().filter(|point| problem.is_known(point)).collect();
    let mut failures = Vec::new();
    match first {
        Err(cause) if known.is_empty() => return Err(cause),
        Err(cause) => {
            let missing = points.len() - known.len();
            failures.push(format!("{missing} of {} points of the map have no solve: {cause}", points.len()));
        }
        Ok(()) => {}
    }
    Ok((bounds(problem, &known), failures))
}

/// The points at which the map is solved, moduli at their guess.
fn design(problem: &Problem<'_>, most: usize) -> Vec<Vec<f64>> {
    let costs: Vec<usize> =
        (0..problem.unknowns.len()).filter(|at| problem.unknowns[*at].kind != Kind::Modulus).collect();
    let side = |unknown: &Unknown| match unknown.kind {
        Kind::Alpha(_) => (unknown.coordinate(unknown.low.max(ALPHA.0)), unknown.coordinate(unknown.high.min(ALPHA.1))),
        _ => unknown.bounds(),
    };
    let region = Region::of(costs.iter().map(|at| side(&problem.unknowns[*at])));
    let shares: Vec<Vec<f64>> = match costs.len() {
        0 => vec![Vec::new()],
        // Middles of equal cells: at the very ends of the ranges solves are hardest and tell least.
        1 => (0..ONE).map(|i| vec![middle(i, ONE)]).collect(),
        2 => (0..TWO * TWO).map(|i| vec![middle(i / TWO, TWO), middle(i % TWO, TWO)]).collect(),
        n => filling(&Region::of(vec![(0.0, 1.0); n]), MANY * n),
    };
    let place = |share: Vec<f64>| -> Vec<f64> {
        let start = |u: &Unknown| u.coordinate(u.start.clamp(u.low, u.high));
        let mut point: Vec<f64> = problem.unknowns.iter().map(start).collect();
        for (i, at) in costs.iter().enumerate() {
            point[*at] = region.low[i] + share[i] * (region.high[i] - region.low[i]);
        }
        point
    };
    let holds = |point: &Vec<f64>| problem.relaxing(point).iter().all(|sum| *sum <= MOST_RELAXING);
    shares.into_iter().map(place).filter(holds).take(most).collect()
}

fn middle(i: usize, of: usize) -> f64 {
    (i as f64 + 0.5) / of as f64
}

/// The box: ranges of the parameters, the moduli [`BEYOND`] what the map's points ask for.
fn bounds(problem: &Problem<'_>, points: &[&Vec<f64>]) -> Bounds {
    let region = problem.region();
    let mut bounds = Bounds { low: region.low, high: region.high };
    let best: Vec<Vec<f64>> = points.par_iter().map(|point| with_best_moduli(problem, &bounds, point)).collect();
    for axis in moduli(&problem.unknowns) {
        let all = best.iter().map(|point| point[axis]);
        let (low, high) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
        bounds.low[axis] = bounds.low[axis].max(low - BEYOND.ln());
        bounds.high[axis] = bounds.high[axis].min(high + BEYOND.ln());
    }
    bounds
}

fn moduli(unknowns: &[Unknown]) -> Vec<usize> {
    (0..unknowns.len()).filter(|at| unknowns[*at].kind == Kind::Modulus).collect()
}

/// Each modulus in turn at its best: a scan, then golden sections.
fn with_best_moduli(problem: &Problem<'_>, bounds: &Bounds, point: &[f64]) -> Vec<f64> {
    let mut best = point.to_vec();
    for axis in moduli(&problem.unknowns) {
        let at = |x: f64| {
            let mut there = best.clone();
            there[axis] = x;
            objective_n(problem, &there)
        };
        let step = bounds.side(axis) / SCAN as f64;
        let places = (0..=SCAN).map(|i| bounds.low[axis] + i as f64 * step);
        let middle = places.map(|x| (x, at(x))).min_by(|a, b| a.1.total_cmp(&b.1)).map_or(best[axis], |(x, _)| x);
        let ratio = 0.5 * (5.0_f64.sqrt() - 1.0);
        let (mut a, mut b) = (middle - step, middle + step);
        for _ in 0..SECTIONS {
            let (left, right) = (b - ratio * (b - a), a + ratio * (b - a));
            if at(left) < at(right) { b = right } else { a = left }
        }
        let end = (0.5 * (a + b)).clamp(bounds.low[axis], bounds.high[axis]);
        best[axis] = end;
    }
    best
}

/// Step (a): the objective at every solved point of the map and [`MODULI`] moduli, the best first.
pub(super) fn sampled(problem: &Problem<'_>, bounds: &Bounds) -> Vec<Sampled> {
    let axes = moduli(&problem.unknowns);
    let points = design(problem, usize::MAX);
    let solved: Vec<&Vec<f64>> = points.iter().filter(|point| problem.is_known(point)).collect();
    let mut sample: Vec<Sampled> = solved
        .par_iter()
        .flat_map_iter(|point| {
            (0..MODULI).map(|i| {
                let mut there = (*point).clone();
                // Several moduli move together: the map is one over each specimen's own only at its candidates.
                for &axis in &axes {
                    there[axis] = bounds.low[axis] + middle(i, MODULI) * bounds.side(axis);
                }
                Sampled { objective_n: objective_n(problem, &there), point: there }
            })
        })
        .filter(|sampled| sampled.objective_n.is_finite())
        .collect();
    sample.sort_by(|a, b| a.objective_n.total_cmp(&b.objective_n));
    sample
}

/// Steps (b) and (c): the threshold, and the points under it of which no two are neighbours, the best first.
pub(super) fn candidates(sample: &[Sampled], bounds: &Bounds, most: usize) -> (f64, Vec<Vec<f64>>) {
    let under = ((sample.len() as f64 * UNDER) as usize).min(sample.len().saturating_sub(1));
    let threshold = sample.get(under).map_or(f64::INFINITY, |sampled| sampled.objective_n);
    let mut kept: Vec<&Vec<f64>> = Vec::new();
    for sampled in sample.iter().take_while(|sampled| sampled.objective_n <= threshold) {
        let apart = |other: &&Vec<f64>| {
            let far = |i: usize| (sampled.point[i] - other[i]).abs() > NEIGHBOURS * bounds.side(i);
            (0..other.len()).any(far)
        };
        if kept.len() < most && kept.iter().all(apart) {
            kept.push(&sampled.point);
        }
    }
    (threshold, kept.into_iter().map(|point| bounds.inside(point)).collect())
}

/// Exponents between which searches begin lie inside those of the map.
const _: () = assert!(ALPHA.0 < FIRST_ALPHA.0 && FIRST_ALPHA.1 < ALPHA.1);
