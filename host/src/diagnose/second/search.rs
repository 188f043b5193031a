//! Which sets of effects are compared: those that the evidence leads to.
//!
//! From the likeliest sets of each size every further effect is screened by what it promises, its
//! shape as at the base and the discrepancy as in the set. What promises most is fitted and
//! weighed. It ends where one effect more makes nothing likelier.

use lut_gen::effect::Spread;
use nalgebra::DMatrix;
use rayon::prelude::*;

use super::weigh::{Weighed, log_odds};
use crate::diagnose::coordinate::Candidate;
use crate::diagnose::fit::Fit;
use crate::diagnose::search::{Explanation, Search};
use crate::infer::evidence::{Discrepancy, Parameter, Prior, promises};

/// Effects in a set.
const MOST: usize = 3;
/// Sets of one size that are extended, and how far (in the logarithm) behind the likeliest set they
/// may lie: one in a million.
const EXTENDED: usize = 3;
pub(super) const BEHIND: f64 = 14.0;
/// Partners that each is fitted with, the most promising first, and what the least of them must
/// promise, its odds included: a linear promise may be short by that much.
const PARTNERS: usize = 6;
const LEAST: f64 = -3.0;

/// The base, what was tried, and what the evidence leads to from there, weighed.
pub(super) fn led(search: &Search<'_>, tried: &[&Explanation], discrepancy: &Discrepancy) -> Vec<Weighed> {
    let Some(base) = Weighed::of(search, search.base.clone(), discrepancy, &[]) else { return Vec::new() };
    // some were tried in another noise
    let again = |e: &&Explanation| Weighed::again(search, &e.fit, discrepancy, &base.evidence.sizes);
    let mut all: Vec<Weighed> = tried.par_iter().filter_map(again).collect();
    all.push(base);
    for count in 0..MOST {
        let parents = parents(&all, count);
        let partners = |at: &usize| -> Vec<(usize, Candidate)> {
            let few = promising(search, &all[*at], discrepancy);
            few.into_iter().map(|candidate| (*at, candidate)).collect()
        };
        let mut wanted: Vec<(usize, Candidate)> = Vec::new();
        for (parent, candidate) in parents.par_iter().flat_map_iter(partners).collect::<Vec<_>>() {
            let set = with(&all[parent].fit, candidate);
            let is_same = |other: &[Candidate]| other.len() == set.len() && set.iter().all(|c| other.contains(c));
            let is_there = all.iter().any(|known| is_same(&known.fit.candidates))
                || wanted.iter().any(|(parent, c)| is_same(&with(&all[*parent].fit, *c)));
            if !is_there {
                wanted.push((parent, candidate));
            }
        }
        let fitted = wanted.par_iter().filter_map(|(parent, candidate)| {
            let parent = &all[*parent];
            Weighed::of(search, search.extended(&parent.fit, candidate), discrepancy, &parent.evidence.sizes)
        });
        let fitted: Vec<Weighed> = fitted.collect();
        all.extend(fitted);
        let best = |is: &dyn Fn(usize) -> bool| {
            let own = all.iter().filter(|set| is(set.fit.candidates.len()));
            own.map(|set| set.log).fold(f64::NEG_INFINITY, f64::max)
        };
        if best(&|size| size == count + 1) <= best(&|size| size <= count) {
            break;
        }
    }
    all
}

fn with(fit: &Fit, candidate: Candidate) -> Vec<Candidate> {
    fit.candidates.iter().copied().chain([candidate]).collect()
}

/// The likeliest sets of a size.
fn parents(all: &[Weighed], count: usize) -> Vec<usize> {
    let best = all.iter().map(|set| set.log).fold(f64::NEG_INFINITY, f64::max);
    let mut own: Vec<usize> = (0..all.len()).filter(|at| all[*at].fit.candidates.len() == count).collect();
    own.sort_by(|a, b| all[*b].log.total_cmp(&all[*a].log));
    own.retain(|at| count == 0 || all[*at].log > best - BEHIND);
    own.truncate(EXTENDED);
    own
}

/// What a set is worth being extended by, the most promising first.
fn promising(search: &Search<'_>, set: &Weighed, discrepancy: &Discrepancy) -> Vec<Candidate> {
    // of an effect that it holds another owner may be wrong as well, but not another form
    let may = |candidate: &Candidate| {
        set.fit.candidates.iter().all(|own| match own.effect.code == candidate.effect.code {
            true => own.effect == candidate.effect && own.owner != candidate.owner,
            false => true,
        })
    };
    let own: Vec<usize> = (0..search.candidates.len()).filter(|at| may(&search.candidates[*at])).collect();
    let columns: Vec<_> = own.iter().flat_map(|at| search.signatures[*at].column_iter()).collect();
    if columns.is_empty() {
        return Vec::new();
    }
    let columns = DMatrix::from_columns(&columns);
    let of = |at: &usize| {
        std::iter::repeat_n((*at, amount(search, &search.candidates[*at])), search.signatures[*at].ncols())
    };
    let (number, parameters): (Vec<usize>, Vec<Parameter>) = own.iter().flat_map(of).unzip();
    let told = promises(&set.linearised(), &set.evidence.sizes, discrepancy, (&columns, &parameters));
    let best = |at: usize| {
        let each = number.iter().zip(&told).filter(|(own, _)| **own == at).map(|(_, promise)| *promise);
        each.fold(f64::NEG_INFINITY, f64::max) + log_odds(&search.candidates[at], &search.candidates)
    };
    let mut ranked: Vec<(f64, usize)> = own.into_iter().map(|at| (best(at), at)).filter(|(b, _)| *b > LEAST).collect();
    ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
    ranked.into_iter().take(PARTNERS).map(|(_, at)| search.candidates[at]).collect()
}

/// The amount of a candidate in plausible ones, the unit of its signature.
fn amount(search: &Search<'_>, candidate: &Candidate) -> Parameter {
    let sizes = candidate.sizes(search.problem.design);
    let amounts = candidate.effect.quantities.iter().map(|q| q.bounded_at(&sizes));
    let mut amounts = amounts.filter(|q| q.spread == Spread::Even && q.prior > 0.0 && q.plausible != q.null);
    let Some(q) = amounts.next() else {
        return Parameter { x: 0.0, bounds: (0.0, f64::MAX), prior: Prior::Cauchy { null: 0.0, scale: 1.0 } };
    };
    let unit = q.plausible - q.null;
    let [a, b] = [q.low, q.high].map(|end| (end - q.null) / unit);
    let prior = Prior::Cauchy { null: 0.0, scale: q.prior / unit.abs() };
    Parameter { x: 0.0, bounds: (a.min(b), a.max(b)), prior }
}
