//! Effects that mean nothing: smooth random functions of depth whose sign depends at random on one variable.

use nalgebra::{DMatrix, DVector};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use rayon::prelude::*;

use super::design::Series;
use super::evidence::{basis, rest_of};
use super::fit::{Fit, Problem, predicted};
use crate::infer::descent::Rule;
use crate::infer::lowrank::Fold;

/// Placebo effects that a real one must beat.
const PLACEBOS: usize = 40;
const SEED: u64 = 0x706c_6163;

/// What placebo effects with that many parameters improve the sum of squares by, errors of the effects before them allowed for: twice the logarithm of their mean likelihood,
/// each being as good as any other. The luckiest alone, of forty, would beat a true cause of five standard deviations every fourth time.
#[must_use]
pub fn gain_of_any(problem: &Problem<'_>, before: &Fit, allowed: &Fold, parameters: usize) -> f64 {
    let mut chance = Pcg64::seed_from_u64(SEED);
    let explained = basis(&allowed.all_taken_off(before.jacobian.clone()));
    let residual = allowed.taken_off(&before.residual);
    let base = predicted(problem.design, problem.chain, &before.model, &problem.contacts_mm);
    let each = (0..PLACEBOS).map(|_| {
        let columns: Vec<DVector<f64>> = (0..parameters.max(1)).map(|_| placebo(problem, &base, &mut chance)).collect();
        let rest = rest_of(&allowed.all_taken_off(DMatrix::from_columns(&columns)), &explained);
        basis(&rest).tr_mul(&residual).norm_squared()
    });
    let gains: Vec<f64> = each.collect();
    let largest = gains.iter().copied().fold(0.0, f64::max);
    let mean = gains.iter().map(|gain| (0.5 * (gain - largest)).exp()).sum::<f64>() / gains.len() as f64;
    largest + 2.0 * mean.ln()
}

/// Charge for a shape of a smooth function. They are many and fit a part of anything: departures that are nothing else lose by 30 and more against a cause, true causes by up to 10
/// where shapes are no dearer than parameters.
const SHAPE: f64 = 5.0;

/// Least sum of squares that a departure without a cause brings, with the charge for its parameters: a gain which is another one for every ball, rate, specimen or
/// cycle, one that changes smoothly over the session, or a smooth function of depth or time that is the same in all runs. What is no better than that shows in the
/// variable and has no shape of its own.
#[must_use]
pub fn causeless(problem: &Problem<'_>, before: &Fit, charge: f64) -> f64 {
    let explained = basis(&before.jacobian);
    let base = predicted(problem.design, problem.chain, &before.model, &problem.contacts_mm);
    let own = charge * before.coordinates.len() as f64;
    let gains = by_level(problem, &base).into_iter().filter(|columns| !columns.is_empty()).map(|columns| {
        let rest = rest_of(&DMatrix::from_columns(&columns), &explained);
        before.square - basis(&rest).tr_mul(&before.residual).norm_squared() + own + charge * columns.len() as f64
    });
    let smooth = smooth(problem, &base);
    let smooth =
        smooth.par_iter().map(|columns| left_beside(problem, before, columns) + own + SHAPE * columns.len() as f64);
    gains.chain(smooth.collect::<Vec<f64>>()).fold(f64::INFINITY, f64::min)
}

/// Least sum of squares of a fit with some columns beside it, its own parameters fitted with theirs: next to what was missing they may be far off.
fn left_beside(problem: &Problem<'_>, before: &Fit, columns: &[DVector<f64>]) -> f64 {
    /// Far closer than any two departures are told apart.
    const CLOSE: Rule = Rule { most_steps: 6, settled: 0.1, settled_share: 0.0, rival: None };
    let own = Problem { whole: before.model.whole.clone(), ..problem.clone() };
    let columns = basis(&DMatrix::from_columns(columns));
    own.least_without(before, |of| rest_of(of, &columns), &CLOSE)
}

/// A gain for every ball, rate, specimen or cycle but the first: columns of each variable, whitened.
fn by_level(problem: &Problem<'_>, base: &[Vec<f64>]) -> Vec<Vec<DVector<f64>>> {
    let cycle = |s: &Series| usize::try_from(s.cycle).unwrap_or(0);
    let variables: [&dyn Fn(&Series) -> usize; 4] = [&|s| s.rate, &|s| s.indenter, &|s| s.specimen, &cycle];
    let each = variables.into_iter().map(|of| {
        let mut levels: Vec<usize> = problem.design.series.iter().map(of).collect();
        levels.sort_unstable();
        levels.dedup();
        // a gain of all is mu
        let one = |level: &usize| {
            column(problem, |s, k| if of(&problem.design.series[s]) == *level { base[s][k] } else { 0.0 })
        };
        levels.iter().skip(1).map(one).collect()
    });
    each.collect()
}

/// Shapes of a smooth function: up to one and a half periods of a wave.
const SHAPES: u32 = 6;
/// Part of the depth over which what depends on depth or time alone comes in: nothing is read before contact.
const COMES_IN: f64 = 0.1;

/// Smooth functions (Chebyshev's polynomials) of the depth and of the time in a run (a part of its length), as parts of the run's largest force, and of the session clock, as
/// parts of the force: columns of each variable, whitened.
fn smooth(problem: &Problem<'_>, base: &[Vec<f64>]) -> Vec<Vec<DVector<f64>>> {
    let series = &problem.design.series;
    let deepest = series.iter().flat_map(|s| &s.nodes).map(|n| n.depth_mm).fold(f64::MIN_POSITIVE, f64::max);
    let longest = |s: usize| series[s].nodes.last().map_or(f64::MIN_POSITIVE, |n| n.time_s).max(f64::MIN_POSITIVE);
    let peak = |s: usize| base[s].iter().copied().fold(0.0, f64::max);
    let wave = |share: f64, shape: u32| (f64::from(shape) * (2.0 * share - 1.0).clamp(-1.0, 1.0).acos()).cos();
    let comes_in = |s: usize, k: usize| (series[s].nodes[k].depth_mm / (COMES_IN * deepest)).clamp(0.0, 1.0);
    let of_depth =
        |shape| column(problem, |s, k| peak(s) * comes_in(s, k) * wave(series[s].nodes[k].depth_mm / deepest, shape));
    let of_time =
        |shape| column(problem, |s, k| peak(s) * comes_in(s, k) * wave(series[s].nodes[k].time_s / longest(s), shape));
    let mut all = vec![(0..SHAPES).map(of_depth).collect(), (0..SHAPES).map(of_time).collect()];
    let clock: Option<Vec<f64>> = series.iter().map(|s| s.start_s).collect();
    if let Some(clock) = clock {
        let (first, last) = clock.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), t| (a.min(*t), b.max(*t)));
        let share = |s: usize| (clock[s] - first) / (last - first).max(f64::MIN_POSITIVE);
        // a gain of all is mu
        all.push((1..SHAPES).map(|shape| column(problem, |s, k| base[s][k] * wave(share(s), shape))).collect());
    }
    all
}

/// A value at every node that is used, whitened; of series and node.
fn column(problem: &Problem<'_>, value: impl Fn(usize, usize) -> f64) -> DVector<f64> {
    let mut column = DVector::zeros(problem.whitening.residuals());
    for (s, series) in problem.design.series.iter().enumerate() {
        for k in 0..series.nodes.len() {
            let at = problem.whitening.first(s) + k;
            if problem.used[at] {
                column[at] = value(s, k);
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
    let deepest: Vec<f64> = problem
        .design
        .series
        .iter()
        .map(|s| s.nodes.iter().map(|n| n.depth_mm).fold(f64::MIN_POSITIVE, f64::max))
        .collect();
    column(problem, |s, k| {
        let series = &problem.design.series[s];
        let wave = (waves * series.nodes[k].depth_mm / deepest[s] + phase).cos();
        base[s][k] * signs[level(series) % signs.len()] * wave
    })
}
