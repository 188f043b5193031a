//! Error on conditions that no fit has seen, with the base and with what was found.

use rayon::prelude::*;

use crate::experiment::Experiment;

use super::fit::{Fit, Problem};
use super::prepared::used;
use super::search::{self, Explanation, Search};
use crate::infer::covariance::Factor;
use crate::infer::lowrank::Fold;
use crate::infer::product::inner;

/// Root mean square errors over conditions that were left out of fit and choice alike.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldOut {
    /// With the base, N.
    pub rmse_before_n: f64,
    /// With the effects, N.
    pub rmse_after_n: f64,
    /// Minus twice the logarithm of the density that was predicted with the base, less what base and effects have in common: whitened errors, weighed by what the other
    /// conditions left open of the parameters.
    pub deviance_before: f64,
    /// The same with the effects.
    pub deviance_after: f64,
    /// Their names.
    pub conditions: Vec<String>,
}

/// Leaves every group of conditions out in turn, refits the base and the rivals on the others, takes the likeliest rival there and predicts
/// the group with it; runs that were marked `hold_out` are predicted instead where there are any. `None` with a single group, or where what is left of a covariance is
/// not positive definite.
#[must_use]
pub fn of(experiment: &Experiment, search: &Search<'_>, held: &[Explanation]) -> Option<HeldOut> {
    let design = search.problem.design;
    let marked = design.series.iter().any(|s| s.hold_out);
    let groups: Vec<Option<usize>> = if marked { vec![None] } else { (0..design.groups).map(Some).collect() };
    if !marked && groups.len() < 2 {
        return None;
    }
    let each: Option<Vec<Each>> = groups
        .par_iter()
        .map(|group| {
            let problem = search.problem.for_rows(used(design, *group))?;
            let base = problem.fit(&[], &search.base.x);
            let refits = held.iter().map(|e| problem.refit(&e.fit, &search::allowed(&problem, &e.fit)));
            let best = refits.min_by(|a, b| search::score(a).total_cmp(&search::score(b)));
            let predicted = |s: &super::design::Series| match group {
                Some(group) => s.group == *group && !s.hold_out,
                None => s.hold_out,
            };
            let before = miss(&search.problem, &base, &predicted)?;
            let after = best.map_or(Some(before), |fit| miss(&search.problem, &fit, &predicted))?;
            Some(Each { before, after })
        })
        .collect();
    let each = each?;
    let sum = |of: fn(&Each) -> f64| each.iter().map(of).sum::<f64>();
    let count = sum(|e| e.before.count).max(1.0);
    let conditions = groups.iter().map(|group| match group {
        Some(group) => design.group_name(experiment, *group),
        None => "runs marked hold_out".to_owned(),
    });
    Some(HeldOut {
        rmse_before_n: (sum(|e| e.before.square_n2) / count).sqrt(),
        rmse_after_n: (sum(|e| e.after.square_n2) / count).sqrt(),
        deviance_before: sum(|e| e.before.deviance),
        deviance_after: sum(|e| e.after.deviance),
        conditions: conditions.collect(),
    })
}

/// One group of conditions with base and effects.
struct Each {
    before: Miss,
    after: Miss,
}

/// How far predicted runs are from what was predicted.
#[derive(Clone, Copy)]
struct Miss {
    square_n2: f64,
    deviance: f64,
    count: f64,
}

fn miss(problem: &Problem<'_>, fit: &Fit, predicted: &dyn Fn(&super::design::Series) -> bool) -> Option<Miss> {
    let forces = super::fit::predicted(problem.design, problem.chain, &fit.model, &problem.contacts_mm);
    let own = Problem { whole: fit.model.whole.clone(), ..problem.for_rows(used_of(problem, predicted))? };
    let mut miss = Miss { square_n2: 0.0, deviance: deviance(&own, fit), count: 0.0 };
    for (series, force) in problem.design.series.iter().zip(&forces).filter(|(s, _)| predicted(s)) {
        for (node, force_n) in series.nodes.iter().zip(force).filter(|(n, _)| !n.lifted) {
            miss.square_n2 += (node.force_n - force_n).powi(2);
            miss.count += 1.0;
        }
    }
    Some(miss)
}

/// Of errors `e` of runs whose prediction moves by `J` with parameters that are known to the inverse of `A`: normal with a covariance of `I + J inv(A) J'`.
/// Infinite where a number is none.
fn deviance(own: &Problem<'_>, fit: &Fit) -> f64 {
    let there = own.at(&fit.candidates, &fit.x, &Fold::none());
    let known = &fit.information + search::known_before(&fit.coordinates);
    let both = &known + inner(&there.jacobian, &there.jacobian);
    let right = there.jacobian.tr_mul(&there.residual);
    match (Factor::of(&both), Factor::of(&known)) {
        (Some(both), Some(known)) => {
            let explained = right.dot(&both.solve(&right));
            there.residual.norm_squared() - explained + both.log_determinant() - known.log_determinant()
        }
        _ => f64::INFINITY,
    }
}

fn used_of(problem: &Problem<'_>, predicted: &dyn Fn(&super::design::Series) -> bool) -> Vec<bool> {
    let of = |s: &super::design::Series| {
        let own = predicted(s);
        s.nodes.iter().map(move |n| own && !n.lifted).collect::<Vec<_>>()
    };
    let mut used: Vec<bool> = problem.design.series.iter().flat_map(of).collect();
    // nothing is predicted without the specimen
    used.resize(problem.whitening.residuals(), false);
    used
}
