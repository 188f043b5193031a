//! Error on conditions that no fit has seen, with the base and with what was found.

use rayon::prelude::*;

use crate::experiment::Experiment;

use super::design::Series;
use super::fit::{Fit, Problem};
use super::plain::{Plain, Plainly};
use super::prepared::used;
use super::search::{self, Explanation, Search};
use crate::infer::covariance::Factor;
use crate::infer::lowrank::Fold;
use crate::infer::product::inner;

/// Root mean square errors over conditions that were left out of fit and choice alike, and what the verdict makes of them.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldOut {
    /// Of the [plain best fit](Plain) of the base, N, over the samples of whole paths.
    pub rmse_before_n: f64,
    /// The same with the effects.
    pub rmse_after_n: f64,
    /// Largest force of the runs that were left out, N.
    pub peak_n: f64,
    /// Minus twice the logarithm of the density that was predicted with the base, less what base and effects have in common: whitened errors, weighed by what the other
    /// conditions left open of the parameters.
    pub deviance_before: f64,
    /// The same with the effects.
    pub deviance_after: f64,
    /// Their names.
    pub conditions: Vec<String>,
}

impl HeldOut {
    /// Errors before and after in percent of the largest force.
    #[must_use]
    pub fn percent_of_peak(&self) -> (f64, f64) {
        let of = |error_n: f64| 100.0 * error_n / self.peak_n.max(f64::MIN_POSITIVE);
        (of(self.rmse_before_n), of(self.rmse_after_n))
    }
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
            let predicted = |s: &Series| match group {
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
    let count = sum(|e| e.before.samples).max(1.0);
    let left_out = design.series.iter().filter(|s| s.hold_out == marked);
    let peak_n = left_out.flat_map(|s| &s.nodes).map(|n| n.force_n).fold(0.0, f64::max);
    let conditions = groups.iter().map(|group| match group {
        Some(group) => design.group_name(experiment, *group),
        None => "runs marked hold_out".to_owned(),
    });
    Some(HeldOut {
        rmse_before_n: (sum(|e| e.before.square_n2) / count).sqrt(),
        rmse_after_n: (sum(|e| e.after.square_n2) / count).sqrt(),
        peak_n,
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
    samples: f64,
}

/// Of a fit's effects: their plain best fit to the other runs in newtons, the fit itself in the noise of the verdict.
fn miss(problem: &Problem<'_>, fit: &Fit, predicted: &(dyn Fn(&Series) -> bool + Sync)) -> Option<Miss> {
    let own = Problem { whole: fit.model.whole.clone(), ..problem.for_rows(used_of(problem, predicted))? };
    let plainly = Plainly { design: problem.design, chain: problem.chain, with: &fit.model };
    let known: Plain = plainly.best_of(&|s| !s.hold_out && !predicted(s));
    let (square_n2, samples) = plainly.left(&known, predicted);
    Some(Miss { square_n2, deviance: deviance(&own, fit), samples })
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

fn used_of(problem: &Problem<'_>, predicted: &dyn Fn(&Series) -> bool) -> Vec<bool> {
    let of = |s: &Series| {
        let own = predicted(s);
        s.nodes.iter().map(move |n| own && !n.lifted).collect::<Vec<_>>()
    };
    let mut used: Vec<bool> = problem.design.series.iter().flat_map(of).collect();
    // nothing is predicted without the specimen
    used.resize(problem.whitening.residuals(), false);
    used
}
