//! Which sets of effects are compared: those that the evidence leads to.
//!
//! From the likeliest sets of each size every further effect is screened by what it promises, its
//! shape as at that set, with what had no name as it is, or as none. What promises most is fitted and
//! weighed. It ends where one effect more makes nothing likelier.

use lut_gen::effect::Spread;
use nalgebra::DMatrix;
use rayon::prelude::*;

use super::weigh::{Weighed, beside_its_solve, level, log_odds};
use crate::diagnose::coordinate::Candidate;
use crate::diagnose::fit::Fit;
use crate::diagnose::search::{Search, signature};
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
const LEAST: f64 = -1.0;
/// What an effect must take off the sum of squares to be one at all, or a richer form of it.
const ADDS: f64 = 2.0;

/// A search in one noise.
pub(super) struct Leading<'s, 'a> {
    pub search: &'s Search<'a>,
    pub discrepancy: &'s Discrepancy,
}

impl Leading<'_, '_> {
    /// The base, what was tried, and what the evidence leads to from there, weighed. Sets that are
    /// `seen` to add nothing are passed over, and what is found to add nothing joins them.
    pub fn led(&self, tried: &[&Fit], seen: &mut Vec<Vec<Candidate>>) -> Vec<Weighed> {
        let (search, discrepancy) = (self.search, self.discrepancy);
        let Some(base) = Weighed::of(search, search.base.clone(), discrepancy, &[]) else { return Vec::new() };
        // some were tried in another noise
        let again = |fit: &&Fit| Weighed::again(search, fit, discrepancy, &base.evidence.sizes);
        let mut all: Vec<Weighed> = tried.par_iter().filter_map(again).collect();
        all.push(base);
        for count in 0..MOST {
            let wanted = self.wanted(&all, count, seen);
            let fitted = wanted.par_iter().filter_map(|(parent, candidate)| {
                let parent = &all[*parent];
                Weighed::of(search, search.extended(&parent.fit, candidate), discrepancy, &parent.evidence.sizes)
            });
            let fitted: Vec<Weighed> = fitted.collect();
            all.extend(fitted);
            let idle: Vec<bool> = all.iter().map(|set| is_idle(set, &all)).collect();
            let (gone, kept): (Vec<_>, Vec<_>) = all.into_iter().zip(idle).partition(|(_, is_idle)| *is_idle);
            seen.extend(gone.into_iter().map(|(set, _)| set.fit.candidates));
            all = level(kept.into_iter().map(|(set, _)| set).collect(), discrepancy);
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

    /// Sets of a size, by number, each with an effect that it is to be extended by.
    fn wanted(&self, all: &[Weighed], count: usize, seen: &[Vec<Candidate>]) -> Vec<(usize, Candidate)> {
        let parents = parents(all, count);
        let partners = |at: &usize| -> Vec<(usize, Candidate)> {
            let few = self.promising(&all[*at]);
            few.into_iter().map(|candidate| (*at, candidate)).collect()
        };
        let mut wanted: Vec<(usize, Candidate)> = Vec::new();
        for (parent, candidate) in parents.par_iter().flat_map_iter(partners).collect::<Vec<_>>() {
            let set = with(&all[parent].fit, candidate);
            let is_same = |other: &[Candidate]| other.len() == set.len() && set.iter().all(|c| other.contains(c));
            let is_there = seen.iter().any(|known| is_same(known))
                || all.iter().any(|known| is_same(&known.fit.candidates))
                || wanted.iter().any(|(parent, c)| is_same(&with(&all[*parent].fit, *c)));
            if !is_there {
                wanted.push((parent, candidate));
            }
        }
        wanted
    }

    /// What a set is worth being extended by, the most promising first.
    fn promising(&self, set: &Weighed) -> Vec<Candidate> {
        let search = self.search;
        let own: Vec<usize> =
            (0..search.candidates.len()).filter(|at| may_join(set, &search.candidates[*at])).collect();
        let is_base = set.fit.candidates.is_empty();
        let problem = beside_its_solve(search, &set.fit);
        // far from the base the shape of an effect is another one
        let here = |at: &usize| match is_base {
            true => search.signatures[*at].clone(),
            false => signature(&problem, &set.fit, &search.candidates[*at]),
        };
        let signatures: Vec<DMatrix<f64>> = own.par_iter().map(here).collect();
        let columns: Vec<_> = signatures.iter().flat_map(|own| own.column_iter()).collect();
        if columns.is_empty() {
            return Vec::new();
        }
        let columns = DMatrix::from_columns(&columns);
        let of = |(at, signature): (&usize, &DMatrix<f64>)| {
            std::iter::repeat_n((*at, amount(search, &search.candidates[*at])), signature.ncols())
        };
        let (number, parameters): (Vec<usize>, Vec<Parameter>) = own.iter().zip(&signatures).flat_map(of).unzip();
        let told = promises(&set.linearised(), &set.evidence.sizes, self.discrepancy, (&columns, &parameters));
        let best = |at: usize| {
            let each = number.iter().zip(&told).filter(|(own, _)| **own == at).map(|(_, promise)| *promise);
            each.fold(f64::NEG_INFINITY, f64::max) + log_odds(&search.candidates[at], &search.candidates)
        };
        let mut ranked: Vec<(f64, usize)> = own.into_iter().map(|at| (best(at), at)).collect();
        // every effect is tried alone: the noise about the base may hide what is there, however little it promises
        if !is_base {
            ranked.retain(|(best, _)| *best > LEAST);
            ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
            ranked.truncate(PARTNERS);
        }
        ranked.into_iter().map(|(_, at)| search.candidates[at]).collect()
    }
}

/// True where a candidate may join a set: of an effect that it holds another owner may be wrong as
/// well, but not another form.
fn may_join(set: &Weighed, candidate: &Candidate) -> bool {
    set.fit.candidates.iter().all(|own| match own.effect.code == candidate.effect.code {
        true => own.effect == candidate.effect && own.owner != candidate.owner,
        false => true,
    })
}

/// True where a set without one of its effects, or with a simpler form of it, leaves the same: what it
/// adds is nothing, and the other tells all that it does.
fn is_idle(set: &Weighed, all: &[Weighed]) -> bool {
    let fit = &set.fit;
    let tells_all = |other: &Weighed| {
        let fewer = other.fit.candidates.len() + 1 == fit.candidates.len()
            && other.fit.candidates.iter().all(|c| fit.candidates.contains(c));
        let simpler = other.fit.x.len() < fit.x.len() && names(&other.fit) == names(fit);
        (fewer || simpler) && other.fit.square < fit.square + ADDS
    };
    all.iter().any(tells_all)
}

/// What a fit's effects are, whatever their form.
fn names(fit: &Fit) -> Vec<(&'static str, usize)> {
    let mut names: Vec<_> = fit.candidates.iter().map(|c| (c.effect.code, c.owner)).collect();
    names.sort_unstable();
    names
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
