//! Effects that mean nothing: smooth random functions of depth whose sign depends at random on one variable.

use nalgebra::{DMatrix, DVector};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;

use super::design::Series;
use super::evidence::{basis, rest_of};
use super::fit::{Allowed, Fit, Problem, predicted};

/// Placebo effects that a real one must beat.
const PLACEBOS: usize = 40;
const SEED: u64 = 0x706c_6163;

/// Largest improvement of the sum of squares that any of the placebo effects with that many parameters brings, errors of the effects before it
/// allowed for.
#[must_use]
pub fn largest_gain(problem: &Problem<'_>, before: &Fit, allowed: &Allowed, parameters: usize) -> f64 {
    let discounted = |columns: &DMatrix<f64>| {
        let each: Vec<DVector<f64>> = columns.column_iter().map(|c| allowed.discounted(&c.into_owned())).collect();
        if each.is_empty() { columns.clone() } else { DMatrix::from_columns(&each) }
    };
    let mut chance = Pcg64::seed_from_u64(SEED);
    let explained = basis(&discounted(&before.jacobian));
    let residual = allowed.discounted(&before.residual);
    let base = predicted(problem.design, problem.chain, &before.model, &problem.contacts_mm);
    let gains = (0..PLACEBOS).map(|_| {
        let columns: Vec<DVector<f64>> = (0..parameters.max(1)).map(|_| placebo(problem, &base, &mut chance)).collect();
        let rest = rest_of(&discounted(&DMatrix::from_columns(&columns)), &explained);
        basis(&rest).tr_mul(&residual).norm_squared()
    });
    gains.fold(0.0, f64::max)
}

/// Least sum of squares that a gain brings which is another one for every ball, rate, specimen or cycle, with the charge for its parameters: what
/// is no better than that shows in the variable and has no shape of its own.
#[must_use]
pub fn gains(problem: &Problem<'_>, before: &Fit, charge: f64) -> f64 {
    let explained = basis(&before.jacobian);
    let base = predicted(problem.design, problem.chain, &before.model, &problem.contacts_mm);
    let cycle = |s: &Series| usize::try_from(s.cycle).unwrap_or(0);
    let variables: [&dyn Fn(&Series) -> usize; 4] = [&|s| s.rate, &|s| s.indenter, &|s| s.specimen, &cycle];
    let each = variables.into_iter().map(|of| {
        let mut levels: Vec<usize> = problem.design.series.iter().map(of).collect();
        levels.sort_unstable();
        levels.dedup();
        // a gain of all is mu
        let columns: Vec<DVector<f64>> =
            levels.iter().skip(1).map(|level| gain(problem, &base, &|s| of(s) == *level)).collect();
        if columns.is_empty() {
            return f64::INFINITY;
        }
        let rest = rest_of(&DMatrix::from_columns(&columns), &explained);
        let taken = basis(&rest).tr_mul(&before.residual).norm_squared();
        before.square - taken + charge * (before.coordinates.len() + columns.len()) as f64
    });
    each.fold(f64::INFINITY, f64::min)
}

/// What some runs' prediction is, whitened.
fn gain(problem: &Problem<'_>, base: &[Vec<f64>], own: &dyn Fn(&Series) -> bool) -> DVector<f64> {
    let mut column = DVector::zeros(problem.whitening.residuals());
    for (s, _) in problem.design.series.iter().enumerate().filter(|(_, s)| own(s)) {
        for (k, force_n) in base[s].iter().enumerate() {
            let at = problem.whitening.first(s) + k;
            if problem.used[at] {
                column[at] = *force_n;
            }
        }
    }
    problem.whitening.apply(&mut column);
    column
}

fn placebo(problem: &Problem<'_>, base: &[Vec<f64>], chance: &mut Pcg64) -> DVector<f64> {
    let waves = chance.random_range(0.5..3.0) * std::f64::consts::PI;
    let phase = chance.random_range(0.0..std::f64::consts::TAU);
    let variable = chance.random_range(0..6_u32);
    let signs: Vec<f64> = (0..64).map(|_| if chance.random::<bool>() { 1.0 } else { -1.0 }).collect();
    let level = |s: &Series| match variable {
        0 => s.rate,
        1 => s.indenter,
        2 => s.specimen,
        3 => usize::try_from(s.cycle).unwrap_or(0),
        4 => s.run,
        _ => 0,
    };
    let mut column = DVector::zeros(problem.whitening.residuals());
    for (s, series) in problem.design.series.iter().enumerate() {
        let deepest = series.nodes.iter().map(|n| n.depth_mm).fold(f64::MIN_POSITIVE, f64::max);
        for (k, node) in series.nodes.iter().enumerate() {
            let at = problem.whitening.first(s) + k;
            if problem.used[at] {
                let wave = (waves * node.depth_mm / deepest + phase).cos();
                column[at] = base[s][k] * signs[level(series) % signs.len()] * wave;
            }
        }
    }
    problem.whitening.apply(&mut column);
    column
}
