//! What effects may be wrong by as they are written down, which is no evidence for another one.

use lut_gen::chain::Model;
use lut_gen::effect::{Kind, Share, Stage, sensor_creep};
use nalgebra::{DMatrix, DVector};

use super::super::coordinate::Candidate;
use super::super::design::Branch;
use super::super::fit::{Fit, Problem};
use crate::infer::covariance::Factor;
use crate::infer::lowrank::Fold;
use crate::infer::product::inner;

/// Least and largest share that an effect may be wrong by, on the way down and on the way back.
#[must_use]
pub fn form_error_range() -> ((f64, f64), (f64, f64)) {
    let all = Share::ALL.map(Share::of);
    let ends = |of: fn(&(f64, f64)) -> f64| {
        let each = all.iter().map(of);
        (each.clone().fold(f64::INFINITY, f64::min), each.fold(0.0, f64::max))
    };
    (ends(|share| share.0), ends(|share| share.1))
}

/// What the effects of a fit add to the prediction may be wrong by a small share of itself, differently in each group of
/// conditions and each branch, and smoothly along it.
pub(in crate::diagnose) fn form_error(problem: &Problem<'_>, fit: &Fit) -> DMatrix<f64> {
    let len = problem.whitening.residuals();
    let (mut forth, mut back) = (DVector::zeros(len), DVector::zeros(len));
    let here = problem.plain(&fit.model);
    for candidate in &fit.candidates {
        let mut bare = fit.model.clone();
        bare.settings.retain(|s| s.effect != candidate.effect || s.owner != candidate.owner);
        let mut added = problem.plain(&bare) - &here;
        let own = share_of(candidate, fit);
        if matches!(own, Share::Elastic | Share::Rubbed) {
            beyond_base(problem, &fit.model, &here, &mut added);
        }
        if !reaches_coupons(candidate) {
            without_coupons(problem, &mut added);
        }
        let share = own.of();
        forth.axpy(share.0, &added, 1.0);
        back.axpy(share.1, &added, 1.0);
    }
    let mut columns = Vec::new();
    for at in 0..problem.design.checks.len() {
        // sensor and machine are as far from their equations there as anywhere
        let mut column = DVector::zeros(len);
        let own = problem.rows_of_check(at);
        column.rows_range_mut(own.clone()).copy_from(&forth.rows_range(own));
        if column.norm() > 0.0 {
            columns.push(column);
        }
    }
    for group in 0..problem.design.groups {
        for (branch, wrong) in [(Branch::Loading, &forth), (Branch::Hold, &forth), (Branch::Unloading, &back)] {
            for shape in 0..3 {
                let column = shaped(problem, wrong, (group, branch), shape);
                if column.norm() > 0.0 {
                    columns.push(column);
                }
            }
        }
    }
    columns.extend(remembered(problem, fit).filter(|column| column.norm() > 0.0));
    if columns.is_empty() {
        return DMatrix::zeros(len, 0);
    }
    let mut columns = DMatrix::from_columns(&columns);
    problem.whitening.apply_to(&mut columns);
    columns
}

/// True for effects that may be wrong by a part of what they add to a coupon: those of machine and sensor, and memories. Another elastic law is exact there
/// as it is written down, whatever the chain misses under a ball, and contacts have no part in it.
fn reaches_coupons(candidate: &Candidate) -> bool {
    let memory = matches!(candidate.effect.kind, Kind::Memory | Kind::History);
    memory || matches!(candidate.effect.stage, Stage::Machine | Stage::Sensor | Stage::Clock)
}

/// Takes off what an effect may be wrong by what lies in the rows of coupons.
fn without_coupons(problem: &Problem<'_>, added: &mut DVector<f64>) {
    let checks = problem.design.checks.iter().enumerate();
    for (at, _) in checks.filter(|(_, check)| check.coupon_of().is_some()) {
        added.rows_range_mut(problem.rows_of_check(at)).fill(0.0);
    }
}

/// Leaves of what an effect adds what no other modulus and exponent could: those are fitted with it, and what all elastic forces are wrong by is
/// in the noise already.
fn beyond_base(problem: &Problem<'_>, model: &Model, here: &DVector<f64>, added: &mut DVector<f64>) {
    const STEP: f64 = 1e-3;
    let moved = [
        Model { mu_mpa: model.mu_mpa * (1.0 + STEP), ..model.clone() },
        Model { alpha: model.alpha * (1.0 + STEP), ..model.clone() },
    ];
    let columns = DMatrix::from_columns(&moved.map(|m| (problem.plain(&m) - here) / STEP));
    let mut white = columns.clone();
    problem.whitening.apply_to(&mut white);
    let mut seen = added.clone();
    problem.whitening.apply(&mut seen);
    let right = white.tr_mul(&seen);
    if let Some(normal) = Factor::of(&inner(&white, &white)) {
        *added -= columns * normal.solve(&right);
    }
}

/// How far an effect of a fit may be wrong.
fn share_of(candidate: &Candidate, fit: &Fit) -> Share {
    let is_solved = fit.model.whole.as_ref().is_some_and(|whole| whole.covers(candidate.effect.code));
    let own = candidate.effect.form_error;
    if is_solved { own.solved } else { own.chain }
}

/// The same as errors to be allowed.
#[must_use]
pub fn allowed(problem: &Problem<'_>, fit: &Fit) -> Fold {
    Fold::of(form_error(problem, fit))
}

/// What a sensor that creeps still reads of the run before, N: it recovers while nothing loads it, and whether its zero was taken again before the touch is not known.
fn remembered(problem: &Problem<'_>, fit: &Fit) -> Option<DVector<f64>> {
    let creep = fit.model.settings.iter().find(|s| *s.effect == sensor_creep::CREEP)?;
    let (amplitude, tau_s) = (creep.values[0], creep.values[1]);
    let mut bare = fit.model.clone();
    bare.settings.retain(|s| s != creep);
    let series = &problem.design.series;
    let mut session: Vec<(f64, usize)> =
        series.iter().enumerate().filter_map(|(run, s)| Some((s.start_s?, run))).collect();
    session.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut column = DVector::zeros(problem.whitening.residuals());
    let (mut late_n, mut since_s) = (0.0, f64::NEG_INFINITY);
    let forces = problem.chain.predict(&bare, &problem.contacts_mm);
    for (start_s, run) in session {
        let time_s = &problem.chain.passages[run].time_s;
        let first_n: f64 = late_n * (-(start_s - since_s).max(0.0) / tau_s).exp();
        for (k, node) in series[run].nodes.iter().enumerate() {
            column[problem.whitening.first(run) + k] = amplitude * first_n * (-node.time_s / tau_s).exp();
        }
        let (Some(last_s), Some(last_n)) = (time_s.last(), forces[run].last()) else { continue };
        let mut read_n = forces[run].clone();
        sensor_creep::creep(time_s, &mut read_n, (1.0, tau_s));
        late_n = read_n.last().map_or(0.0, |n| n - last_n) + first_n * (-last_s / tau_s).exp();
        since_s = start_s + last_s;
    }
    Some(column)
}

/// A vector times a polynomial along one branch of one group, 0 elsewhere.
fn shaped(
    problem: &Problem<'_>,
    values: &DVector<f64>,
    (group, branch): (usize, Branch),
    shape: usize,
) -> DVector<f64> {
    let mut column = DVector::zeros(values.len());
    for (s, series) in problem.design.series.iter().enumerate().filter(|(_, s)| s.group == group) {
        let deepest = series.nodes.iter().map(|n| n.depth_mm).fold(0.0, f64::max);
        for (k, node) in series.nodes.iter().enumerate().filter(|(_, n)| n.branch == branch) {
            let at = problem.whitening.first(s) + k;
            let x = match branch {
                Branch::Hold => k as f64 / series.nodes.len() as f64,
                Branch::Loading | Branch::Unloading => 2.0 * (node.depth_mm / deepest) - 1.0,
            };
            column[at] = values[at] * [1.0, x, 1.5 * x * x - 0.5][shape];
        }
    }
    column
}
