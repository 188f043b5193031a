//! Error on commands that no fit has seen, with the base law and with what was found.

use rayon::prelude::*;

use super::Weighed;
use super::fit::{Fit, Problem};
use super::forward::Search;

/// Root mean square errors over commands that were left out of fit and choice alike.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldOut {
    /// With the base, in the channel's unit.
    pub rmse_before: f64,
    /// With the effects.
    pub rmse_after: f64,
    /// Sum of the squares of whitened errors with the base.
    pub square_before: f64,
    /// The same with the effects.
    pub square_after: f64,
    /// Names of the commands.
    pub conditions: Vec<String>,
}

/// Leaves every command out in turn, refits base and rivals on the others, takes the likeliest rival there and predicts the command with it;
/// runs that were marked `hold_out` are predicted instead where there are any. `None` with a single command.
#[must_use]
pub fn of(search: &Search<'_>, held: &[Weighed]) -> Option<HeldOut> {
    let problem = &search.problem;
    let design = problem.design;
    let marked = design.series.iter().any(|s| s.hold_out);
    let groups: Vec<Option<usize>> = if marked { vec![None] } else { (0..design.conditions.len()).map(Some).collect() };
    if !marked && groups.len() < 2 {
        return None;
    }
    let each: Vec<(Miss, Miss)> = groups
        .par_iter()
        .map(|group| {
            let predicted = |s: usize| match group {
                Some(group) => design.series[s].condition == *group,
                None => design.series[s].hold_out,
            };
            let of = |whose: &dyn Fn(usize) -> bool| problem.for_runs((0..design.series.len()).map(whose).collect());
            let fitted = of(&|s| !predicted(s) && !design.series[s].hold_out);
            let shown = of(&predicted);
            let base = fitted.fit(&search.base.law);
            let best = held
                .iter()
                .map(|e| fitted.fit(&e.fit.law))
                .min_by(|a, b| a.square.total_cmp(&b.square))
                .unwrap_or_else(|| base.clone());
            (miss(&shown, &base), miss(&shown, &best))
        })
        .collect();
    let sum = |of: &dyn Fn(&(Miss, Miss)) -> f64| each.iter().map(of).sum::<f64>();
    let count = sum(&|e| e.0.count).max(1.0);
    let conditions = groups.iter().map(|group| match group {
        Some(group) => design.conditions[*group].clone(),
        None => "runs marked hold_out".to_owned(),
    });
    Some(HeldOut {
        rmse_before: (sum(&|e| e.0.square) / count).sqrt(),
        rmse_after: (sum(&|e| e.1.square) / count).sqrt(),
        square_before: sum(&|e| e.0.whitened),
        square_after: sum(&|e| e.1.whitened),
        conditions: conditions.collect(),
    })
}

/// Sums over predicted runs.
#[derive(Clone, Copy)]
struct Miss {
    square: f64,
    whitened: f64,
    count: f64,
}

fn miss(problem: &Problem<'_>, fit: &Fit) -> Miss {
    let plain = problem.plain(&fit.law);
    let used = problem.design.series.iter().zip(&problem.used).filter(|(_, used)| **used);
    let count: usize = used.map(|(s, _)| s.compared.iter().filter(|c| **c).count()).sum();
    let mut whitened = plain.clone();
    problem.whitening.apply(&mut whitened);
    Miss { square: plain.norm_squared(), whitened: whitened.norm_squared(), count: count as f64 }
}
