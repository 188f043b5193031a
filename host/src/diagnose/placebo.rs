//! Effects that mean nothing: smooth random functions of depth whose sign depends at random on one variable.

use nalgebra::{DMatrix, DVector};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;

use super::design::Series;
use super::evidence::{basis, rest_of};
use super::fit::{Fit, Problem, predicted};

/// Placebo effects that a real one must beat.
const PLACEBOS: usize = 40;
const SEED: u64 = 0x706c_6163;

/// Largest improvement of the sum of squares that any of the placebo effects with that many parameters brings.
#[must_use]
pub fn largest_gain(problem: &Problem<'_>, before: &Fit, parameters: usize) -> f64 {
    let mut chance = Pcg64::seed_from_u64(SEED);
    let explained = basis(&before.jacobian);
    let base = predicted(problem.design, problem.chain, &before.model, &problem.contacts_mm);
    let gains = (0..PLACEBOS).map(|_| {
        let columns: Vec<DVector<f64>> = (0..parameters.max(1)).map(|_| placebo(problem, &base, &mut chance)).collect();
        let rest = rest_of(&DMatrix::from_columns(&columns), &explained);
        basis(&rest).tr_mul(&before.residual).norm_squared()
    });
    gains.fold(0.0, f64::max)
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
