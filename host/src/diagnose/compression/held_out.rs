//! Error on compressions that no fit has seen.

use super::super::check::{Check, Coupon};
use super::super::design::Branch;
use super::super::search::{Search, allowed};
use super::super::sets::Weighed;
use super::forward::Coupons;

/// Root mean square errors over what was left out, N.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldOut {
    /// With a plain fit of the base to the others.
    pub before_n: f64,
    /// With one of the base beside the effects.
    pub after_n: f64,
    /// What was left out at a time.
    pub left_out: &'static str,
}

impl HeldOut {
    /// True where the effects predict better.
    #[must_use]
    pub fn gains(&self) -> bool {
        self.after_n < self.before_n
    }
}

/// Leaves out every compression in turn with those that repeat it, or, where all repeat each other, the deepest
/// third of the way down, the later half of the hold, and the way back.
pub(super) fn of(coupons: &Coupons<'_>, best: &Weighed) -> Option<HeldOut> {
    let design = coupons.search.problem.design;
    let own: Vec<&Coupon> = design.checks.iter().filter_map(Check::coupon).collect();
    let kind = |at: usize| own[..at].iter().position(|before| own[at].repeats(before)).unwrap_or(at);
    let kinds: Vec<usize> = (0..own.len()).map(kind).collect();
    let mut each: Vec<usize> = kinds.clone();
    each.sort_unstable();
    each.dedup();
    let masks: Vec<Vec<bool>> = if each.len() > 1 {
        each.iter().map(|kind| rows(&own, |at, _| kinds[at] == *kind)).collect()
    } else {
        parts(&own)
    };
    let told = if each.len() > 1 { "compressions, each with its repeats" } else { "parts of the path" };
    let (mut before, mut after, mut count) = (0.0, 0.0, 0_usize);
    for left in masks.iter().filter(|mask| mask.iter().any(|left| *left)) {
        let kept: Vec<bool> = left.iter().map(|left| !left).collect();
        let problem = coupons.search.problem.for_rows(kept)?;
        let base = problem.fit(&[], &coupons.search.base.x);
        let extended = problem.refit(&best.fit, &allowed(&problem, &best.fit));
        let groups = coupons.groups.clone();
        let there = Coupons { search: Search { problem, ..coupons.search.clone() }, groups };
        let square = |model: &lut_gen::chain::Model| {
            let (model, _) = there.plainly(model, &there.measured());
            let missed = there.measured() - there.predicted(&model);
            missed.iter().zip(left).filter(|(_, left)| **left).map(|(n, _)| n * n).sum::<f64>()
        };
        before += square(&base.model);
        after += square(&extended.model);
        count += left.iter().filter(|left| **left).count();
    }
    let rms = |square: f64| (square / count.max(1) as f64).sqrt();
    (count > 0).then(|| HeldOut { before_n: rms(before), after_n: rms(after), left_out: told })
}

/// Rows that are left out.
fn rows(own: &[&Coupon], is_left: impl Fn(usize, usize) -> bool) -> Vec<bool> {
    own.iter()
        .enumerate()
        .flat_map(|(at, c)| (0..c.nodes().len()).map(|k| is_left(at, k)).collect::<Vec<_>>())
        .collect()
}

/// Parts of the path of every compression.
fn parts(own: &[&Coupon]) -> Vec<Vec<bool>> {
    let of = |branch: Branch, from: f64| {
        rows(own, |at, k| {
            let nodes = own[at].nodes();
            let same: Vec<usize> = (0..nodes.len()).filter(|k| nodes[*k].branch == branch).collect();
            let place = same.iter().position(|own| *own == k);
            place.is_some_and(|place| place as f64 >= from * same.len() as f64)
        })
    };
    vec![of(Branch::Loading, 2.0 / 3.0), of(Branch::Hold, 0.5), of(Branch::Unloading, 0.0)]
}
