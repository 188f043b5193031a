//! Finite elements for the sets that may be the likeliest: two fidelities, the dear one only where it
//! may decide.

use rayon::prelude::*;

use super::Weighed;
use crate::diagnose::fit::Fit;
use crate::diagnose::search::Search;
use crate::infer::evidence::Discrepancy;
use crate::infer::sets::{BEHIND, level};

/// Sets that are solved at a time, the likeliest first, and in all.
const AT_ONCE: usize = 4;
const IN_ALL: usize = 16;
/// Rounds of solves of a set that may be the likeliest, and of the one that is.
const FEW: usize = 2;
const MANY: usize = 4;

/// Sets with finite elements at the place of those that may be the likeliest, the likeliest first.
pub(super) fn solved(search: &Search<'_>, mut all: Vec<Weighed>, discrepancy: &Discrepancy) -> Vec<Weighed> {
    for _ in 0..IN_ALL / AT_ONCE {
        sort(&mut all);
        let open = open(search, &all);
        if open.is_empty() {
            break;
        }
        let each: Vec<Option<Weighed>> = open.par_iter().map(|at| again(search, &all[*at], discrepancy)).collect();
        for (at, solved) in open.into_iter().zip(each) {
            match solved {
                Some(solved) => all[at] = solved,
                // where finite elements fail the chain is what there is
                None => all[at].fit.settled = true,
            }
        }
    }
    all = level(all, discrepancy);
    sort(&mut all);
    if let Some(best) = all.first().filter(|best| lut_gen::chain::is_rough(&best.fit.model)) {
        let fit = search.ended(&best.fit, MANY);
        if let Some(ended) = fit.and_then(|fit| Weighed::of(search, fit, discrepancy, &best.evidence.sizes)) {
            all[0] = ended;
            sort(&mut all);
        }
    }
    all
}

/// Sets that lie near the likeliest and are not solved, by number.
fn open(search: &Search<'_>, all: &[Weighed]) -> Vec<usize> {
    let Some(best) = all.first().map(|set| set.log) else { return Vec::new() };
    let is_open = |set: &Weighed| set.log > best - BEHIND && !set.fit.settled && search.needs_solve(&set.fit);
    (0..all.len()).filter(|at| is_open(&all[*at])).take(AT_ONCE).collect()
}

/// A set once more with finite elements: of one effect alone every valley is looked into, of several
/// that in which the fit lies.
fn again(search: &Search<'_>, set: &Weighed, discrepancy: &Discrepancy) -> Option<Weighed> {
    let fit = match set.fit.candidates.len() {
        1 => search.solved(&set.fit),
        _ => search.ended(&set.fit, FEW),
    };
    let fit = Fit { settled: true, ..fit? };
    Weighed::of(search, fit, discrepancy, &set.evidence.sizes)
}

fn sort(all: &mut [Weighed]) {
    all.sort_by(|a, b| b.log.total_cmp(&a.log));
}
