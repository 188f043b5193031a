//! Error on conditions that no fit has seen, with the base and with what was found.

use rayon::prelude::*;

use crate::experiment::Experiment;

use super::fit::{Fit, Problem};
use super::search::{Explanation, Search};
use super::{Prepared, used};

/// Root mean square errors over conditions that were left out of fit and choice alike.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldOut {
    /// With the base, N.
    pub rmse_before_n: f64,
    /// With the effects, N.
    pub rmse_after_n: f64,
    /// Their names.
    pub conditions: Vec<String>,
}

/// Leaves every group of conditions out in turn, refits the base and the rivals on the others, takes the likeliest rival there and predicts
/// the group with it; runs that were marked `hold_out` are predicted instead where there are any. `None` with a single group.
#[must_use]
pub fn of(experiment: &Experiment, prepared: &Prepared<'_>, search: &Search<'_>, held: &[Explanation]) -> Option<HeldOut> {
    let design = prepared.problem.design;
    let marked = design.series.iter().any(|s| s.hold_out);
    let groups: Vec<Option<usize>> = if marked { vec![None] } else { (0..design.groups).map(Some).collect() };
    if !marked && groups.len() < 2 {
        return None;
    }
    let each: Vec<(f64, f64, usize)> = groups
        .par_iter()
        .map(|group| {
            let problem = Problem {
                design,
                chain: prepared.problem.chain,
                contacts_mm: prepared.problem.contacts_mm.clone(),
                back_n: prepared.problem.back_n.clone(),
                whitening: prepared.problem.whitening.clone(),
                used: used(design, *group),
            };
            let base = problem.fit(&[], &search.base.x);
            let refits = held.iter().map(|e| problem.fit(&e.fit.candidates, &e.fit.x));
            let charged = |f: &Fit| f.square + 3.0 * f.coordinates.len() as f64;
            let best = refits.min_by(|a, b| charged(a).total_cmp(&charged(b)));
            let predicted = |s: &super::design::Series| match group {
                Some(group) => s.group == *group && !s.hold_out,
                None => s.hold_out,
            };
            let (before, count) = miss(&prepared.problem, &base, &predicted);
            let after = best.map_or(before, |fit| miss(&prepared.problem, &fit, &predicted).0);
            (before, after, count)
        })
        .collect();
    let count: usize = each.iter().map(|e| e.2).sum();
    let rmse = |of: fn(&(f64, f64, usize)) -> f64| (each.iter().map(of).sum::<f64>() / count.max(1) as f64).sqrt();
    let conditions = groups.iter().map(|group| match group {
        Some(group) => design.group_name(experiment, *group),
        None => "runs marked hold_out".to_owned(),
    });
    Some(HeldOut { rmse_before_n: rmse(|e| e.0), rmse_after_n: rmse(|e| e.1), conditions: conditions.collect() })
}

/// Sum of squares, N^2, over predicted runs, and its number of nodes.
fn miss(problem: &Problem<'_>, fit: &Fit, predicted: &dyn Fn(&super::design::Series) -> bool) -> (f64, usize) {
    let contacts: Vec<f64> = problem.contacts_mm.clone();
    let curves = problem.chain.predict(&fit.model, &contacts);
    let (mut sum, mut count) = (0.0, 0);
    for (series, curve) in problem.design.series.iter().zip(&curves).filter(|(s, _)| predicted(s)) {
        for (node, force_n) in series.nodes.iter().zip(curve) {
            sum += (node.force_n - force_n).powi(2);
            count += 1;
        }
    }
    (sum, count)
}
