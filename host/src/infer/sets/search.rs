//! Which sets of effects are compared: those that the evidence leads to.
//!
//! From the likeliest sets of each size every further effect is screened by what it promises, its
//! shape as at that set, with what had no name as it is, or as none. What promises most is fitted and
//! weighed. It ends where one effect more makes nothing likelier.

use nalgebra::DMatrix;
use rayon::prelude::*;

use super::weigh::{Weighed, level};
use super::{BEHIND, Effect, Fitted, Forward};
use crate::infer::evidence::{Discrepancy, Parameter, promises};

/// Effects in a set.
const MOST: usize = 3;
/// Sets of one size that are extended.
const EXTENDED: usize = 3;
/// Partners that each is fitted with, the most promising first, and what the least of them must
/// promise, its odds included: a linear promise may be short by that much.
const PARTNERS: usize = 6;
const LEAST: f64 = -1.0;
/// What an effect must take off the sum of squares to be one at all, or a richer form of it.
const ADDS: f64 = 2.0;

/// The base, what was tried, and what the evidence leads to from there, weighed. Sets that are
/// `seen` to add nothing are passed over, and what is found to add nothing joins them.
pub fn led<F: Forward>(
    of: &F,
    discrepancy: &Discrepancy,
    tried: &[&F::Fit],
    seen: &mut Vec<Vec<Effect<F>>>,
) -> Vec<Weighed<F::Fit>> {
    let Some(base) = Weighed::of(of, of.base().clone(), discrepancy, &[]) else { return Vec::new() };
    // some were tried in another noise
    let again = |fit: &&F::Fit| Weighed::again(of, fit, discrepancy, &base.evidence.sizes);
    let mut all: Vec<Weighed<F::Fit>> = tried.par_iter().filter_map(again).collect();
    all.push(base);
    for count in 0..MOST {
        let wanted = wanted(of, discrepancy, (&all, count), seen);
        let fitted = wanted.par_iter().filter_map(|(parent, effect)| {
            let parent = &all[*parent];
            Weighed::of(of, of.extended(&parent.fit, effect)?, discrepancy, &parent.evidence.sizes)
        });
        let fitted: Vec<_> = fitted.collect();
        all.extend(fitted);
        let idle: Vec<bool> = all.iter().map(|set| is_idle(of, set, &all)).collect();
        let (gone, kept): (Vec<_>, Vec<_>) = all.into_iter().zip(idle).partition(|(_, is_idle)| *is_idle);
        seen.extend(gone.into_iter().map(|(set, _)| set.fit.effects().to_vec()));
        all = level(kept.into_iter().map(|(set, _)| set).collect(), discrepancy);
        let best = |is: &dyn Fn(usize) -> bool| {
            let own = all.iter().filter(|set| is(set.fit.effects().len()));
            own.map(|set| set.log).fold(f64::NEG_INFINITY, f64::max)
        };
        if best(&|size| size == count + 1) <= best(&|size| size <= count) {
            break;
        }
    }
    all
}

/// Sets of a size, by number, each with an effect that it is to be extended by.
fn wanted<F: Forward>(
    of: &F,
    discrepancy: &Discrepancy,
    (all, count): (&[Weighed<F::Fit>], usize),
    seen: &[Vec<Effect<F>>],
) -> Vec<(usize, Effect<F>)> {
    let parents = parents(all, count);
    let partners = |at: &usize| -> Vec<(usize, Effect<F>)> {
        let few = promising(of, discrepancy, &all[*at]);
        few.into_iter().map(|effect| (*at, effect)).collect()
    };
    let mut wanted: Vec<(usize, Effect<F>)> = Vec::new();
    for (parent, effect) in parents.par_iter().flat_map_iter(partners).collect::<Vec<_>>() {
        let set = with(&all[parent].fit, effect);
        let is_same = |other: &[Effect<F>]| other.len() == set.len() && set.iter().all(|c| other.contains(c));
        let is_there = seen.iter().any(|known| is_same(known))
            || all.iter().any(|known| is_same(known.fit.effects()))
            || wanted.iter().any(|(parent, c)| is_same(&with(&all[*parent].fit, *c)));
        if !is_there {
            wanted.push((parent, effect));
        }
    }
    wanted
}

/// What a set is worth being extended by, the most promising first.
fn promising<F: Forward>(of: &F, discrepancy: &Discrepancy, set: &Weighed<F::Fit>) -> Vec<Effect<F>> {
    let held = set.fit.effects();
    let own: Vec<&Effect<F>> = of.effects().iter().filter(|effect| of.may_join(held, effect)).collect();
    // far from the base the shape of an effect is another one
    let told: Vec<(DMatrix<f64>, Parameter)> = own.par_iter().map(|effect| of.signature(&set.fit, effect)).collect();
    let columns: Vec<_> = told.iter().flat_map(|(own, _)| own.column_iter()).collect();
    if columns.is_empty() {
        return Vec::new();
    }
    let columns = DMatrix::from_columns(&columns);
    let each = |(at, (signature, amount)): (usize, &(DMatrix<f64>, Parameter))| {
        std::iter::repeat_n((at, *amount), signature.ncols())
    };
    let (number, parameters): (Vec<usize>, Vec<Parameter>) = told.iter().enumerate().flat_map(each).unzip();
    let told = promises(&set.linearised(), &set.evidence.sizes, discrepancy, (&columns, &parameters));
    let best = |at: usize| {
        let each = number.iter().zip(&told).filter(|(own, _)| **own == at).map(|(_, promise)| *promise);
        each.fold(f64::NEG_INFINITY, f64::max) + of.log_odds(own[at])
    };
    let mut ranked: Vec<(f64, Effect<F>)> = (0..own.len()).map(|at| (best(at), *own[at])).collect();
    // every effect is tried alone: the noise about the base may hide what is there, however little it promises
    if !set.is_base() {
        ranked.retain(|(best, _)| *best > LEAST);
        ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
        ranked.truncate(PARTNERS);
    }
    ranked.into_iter().map(|(_, effect)| effect).collect()
}

/// True where a set without one of its effects, or with a simpler form of it, leaves the same: what it
/// adds is nothing, and the other tells all that it does.
fn is_idle<F: Forward>(of: &F, set: &Weighed<F::Fit>, all: &[Weighed<F::Fit>]) -> bool {
    let (own, square, parameters) = (set.fit.effects(), set.square(), set.parameters());
    let is_alike = |its: &[Effect<F>]| {
        its.len() == own.len() && its.iter().all(|one| own.iter().any(|other| of.is_form_of(one, other)))
    };
    let tells_all = |other: &Weighed<F::Fit>| {
        let its = other.fit.effects();
        let fewer = its.len() + 1 == own.len() && its.iter().all(|effect| own.contains(effect));
        let simpler = other.parameters() < parameters && is_alike(its);
        (fewer || simpler) && other.square() < square + ADDS
    };
    all.iter().any(tells_all)
}

impl<T: Fitted> Weighed<T> {
    /// Sum of squares of its residuals.
    fn square(&self) -> f64 {
        self.linearised().residual.norm_squared()
    }

    fn parameters(&self) -> usize {
        self.evidence.x.len()
    }
}

fn with<T: Fitted>(fit: &T, effect: T::Effect) -> Vec<T::Effect> {
    fit.effects().iter().copied().chain([effect]).collect()
}

/// The likeliest sets of a size.
fn parents<T: Fitted>(all: &[Weighed<T>], count: usize) -> Vec<usize> {
    let best = all.iter().map(|set| set.log).fold(f64::NEG_INFINITY, f64::max);
    let mut own: Vec<usize> = (0..all.len()).filter(|at| all[*at].fit.effects().len() == count).collect();
    own.sort_by(|a, b| all[*b].log.total_cmp(&all[*a].log));
    own.retain(|at| count == 0 || all[*at].log > best - BEHIND);
    own.truncate(EXTENDED);
    own
}
