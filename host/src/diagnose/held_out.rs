//! Error on what no fit has seen, with the base and with what was found.

use rayon::prelude::*;

use crate::experiment::Experiment;

use super::coordinate::known_before;
use super::design::{Branch, Design, Node, Series};
use super::fit::{Fit, Problem};
use super::plain::{Plain, Plainly};
use super::search::{self, Search};
use super::sets::Weighed;
use crate::infer::covariance::Factor;
use crate::infer::lowrank::Fold;
use crate::infer::product::inner;

/// Root mean square errors over what was left out of fit and choice alike, and what the verdict makes of them.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldOut {
    /// Of the [plain best fit](Plain) of the base, N, over the samples of whole paths.
    pub rmse_before_n: f64,
    /// The same with the effects.
    pub rmse_after_n: f64,
    /// Largest force that was left out, N.
    pub peak_n: f64,
    /// Minus twice the logarithm of the density that was predicted with the base, less what base and effects have in common: whitened errors, weighed by what the other
    /// conditions left open of the parameters.
    pub deviance_before: f64,
    /// The same with the effects.
    pub deviance_after: f64,
    /// What was left out, in words.
    pub conditions: Vec<String>,
}

/// How much larger the error in newtons may be with the effects for them to predict as well: contact points of
/// runs that were left out are fitted, and take up what an offset of the contact explains.
const AS_WELL: f64 = 1.1;

impl HeldOut {
    /// True where the effects predict better than the base, each with its noise, and in newtons no worse.
    #[must_use]
    pub fn gains(&self) -> bool {
        self.deviance_after < self.deviance_before && self.rmse_after_n < AS_WELL * self.rmse_before_n
    }

    /// Errors before and after in percent of the largest force.
    #[must_use]
    pub fn percent_of_peak(&self) -> (f64, f64) {
        let of = |error_n: f64| 100.0 * error_n / self.peak_n.max(f64::MIN_POSITIVE);
        (of(self.rmse_before_n), of(self.rmse_after_n))
    }
}

/// What is left out at a time.
#[derive(Debug, Clone, Copy)]
enum Left {
    /// Runs that were marked `hold_out`.
    Marked,
    /// A group of conditions.
    Group(usize),
    /// A part of the path of every run.
    Part(Part),
}

/// Parts of a path that others may predict.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Part {
    /// The deepest third of the way down.
    Deep,
    /// The later half of the hold.
    LateHold,
    /// The way back.
    WayBack,
}

impl Part {
    const ALL: [Self; 3] = [Self::Deep, Self::LateHold, Self::WayBack];

    fn holds(self, series: &Series, node: &Node) -> bool {
        let most = |of: fn(&Node) -> f64| series.nodes.iter().map(of).fold(0.0, f64::max);
        match self {
            Self::Deep => node.branch == Branch::Loading && node.depth_mm > most(|n| n.depth_mm) * 2.0 / 3.0,
            Self::LateHold => node.branch == Branch::Hold && node.held_s > 0.5 * most(|n| n.held_s),
            Self::WayBack => node.branch == Branch::Unloading,
        }
    }

    fn words(self) -> &'static str {
        match self {
            Self::Deep => "the deepest third of the way down",
            Self::LateHold => "the later half of the hold",
            Self::WayBack => "the way back",
        }
    }
}

impl Left {
    /// Marked runs where there are any, else every group of conditions; parts of the path where there is one condition only.
    fn of(design: &Design) -> Vec<Self> {
        let has = |part: &Part| design.series.iter().any(|s| s.nodes.iter().any(|n| !n.lifted && part.holds(s, n)));
        match design.groups {
            _ if design.series.iter().any(|s| s.hold_out) => vec![Self::Marked],
            0 | 1 => Part::ALL.into_iter().filter(has).map(Self::Part).collect(),
            groups => (0..groups).map(Self::Group).collect(),
        }
    }

    /// True for what is predicted.
    fn holds(self, series: &Series, node: &Node) -> bool {
        match self {
            Self::Marked => series.hold_out,
            Self::Group(group) => series.group == group && !series.hold_out,
            Self::Part(part) => part.holds(series, node),
        }
    }

    /// True for what is fitted.
    fn keeps(self, series: &Series, node: &Node) -> bool {
        !series.hold_out && !self.holds(series, node)
    }

    fn name(self, experiment: &Experiment, design: &Design) -> String {
        match self {
            Self::Marked => "runs marked hold_out".to_owned(),
            Self::Group(group) => design.group_name(experiment, group),
            Self::Part(part) => part.words().to_owned(),
        }
    }
}

/// Leaves every group of conditions out in turn, refits the base and the rivals on the others, takes the likeliest rival there and predicts
/// the group with it. Runs that were marked `hold_out` are predicted instead where there are any; where there is one condition only, parts of the path.
/// `None` where what is left of a covariance is not positive definite.
#[must_use]
pub fn of(experiment: &Experiment, search: &Search<'_>, held: &[Weighed]) -> Option<HeldOut> {
    let design = search.problem.design;
    let all = Left::of(design);
    let each: Option<Vec<Each>> = all
        .par_iter()
        .map(|left| {
            let kept = rows_of(&search.problem, &|s, n| left.keeps(s, n), true);
            let problem = search.problem.for_rows(kept)?;
            let base = problem.fit(&[], &search.base.x);
            let refits = held.iter().map(|e| problem.refit(&e.fit, &search::allowed(&problem, &e.fit)));
            let best = refits.min_by(|a, b| a.score().total_cmp(&b.score()));
            let before = miss(&search.problem, &base, *left)?;
            let after = best.map_or(Some(before), |fit| miss(&search.problem, &fit, *left))?;
            Some(Each { before, after })
        })
        .collect();
    let each = each.filter(|each| !each.is_empty())?;
    let sum = |of: fn(&Each) -> f64| each.iter().map(of).sum::<f64>();
    let count = sum(|e| e.before.samples).max(1.0);
    let nodes = design.series.iter().flat_map(|s| s.nodes.iter().map(move |n| (s, n)));
    let left_out = nodes.filter(|(s, n)| all.iter().any(|left| left.holds(s, n)));
    let peak_n = left_out.map(|(_, n)| n.force_n).fold(0.0, f64::max);
    Some(HeldOut {
        rmse_before_n: (sum(|e| e.before.square_n2) / count).sqrt(),
        rmse_after_n: (sum(|e| e.after.square_n2) / count).sqrt(),
        peak_n,
        deviance_before: sum(|e| e.before.deviance),
        deviance_after: sum(|e| e.after.deviance),
        conditions: all.iter().map(|left| left.name(experiment, design)).collect(),
    })
}

/// What was left out at a time, with base and effects.
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

/// Of a fit's effects: their plain best fit to the others in newtons, the fit itself in the noise of the verdict. Contact points of runs that were left out whole are at their
/// best, for they belong to a run; those of runs that were fitted in part stay.
fn miss(problem: &Problem<'_>, fit: &Fit, left: Left) -> Option<Miss> {
    let predicted = |s: &Series, n: &Node| left.holds(s, n);
    let own = Problem { whole: fit.model.whole.clone(), ..problem.for_rows(rows_of(problem, &predicted, false))? };
    let plainly = Plainly { design: problem.design, chain: problem.chain, with: &fit.model };
    let known: Plain = plainly.best_of(&|s, n| left.keeps(s, n));
    let (square_n2, samples) = match left {
        Left::Part(_) => plainly.left_there(&known, &predicted),
        Left::Marked | Left::Group(_) => plainly.left(&known, &predicted),
    };
    Some(Miss { square_n2, deviance: deviance(&own, fit), samples })
}

/// Of errors `e` of runs whose prediction moves by `J` with parameters that are known to the inverse of `A`: normal with a covariance of `I + J inv(A) J'`.
/// Infinite where a number is none.
fn deviance(own: &Problem<'_>, fit: &Fit) -> f64 {
    let there = own.at(&fit.candidates, &fit.x, &Fold::none());
    let known = &fit.information + known_before(&fit.coordinates);
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

/// Rows that are meant, and those of runs without the specimen or not.
fn rows_of(problem: &Problem<'_>, meant: &dyn Fn(&Series, &Node) -> bool, checks: bool) -> Vec<bool> {
    let of = |s: &Series| s.nodes.iter().map(|n| !n.lifted && meant(s, n)).collect::<Vec<_>>();
    let mut rows: Vec<bool> = problem.design.series.iter().flat_map(of).collect();
    rows.resize(problem.whitening.residuals(), checks);
    rows
}
