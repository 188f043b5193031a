//! Effects of the catalogue that these runs would not show: with the priors of their amounts they widen the intervals of every answer.
//!
//! An effect is there with the odds that the verdict gives it before it sees data ([`presence`]), else it is nothing. Point estimates stay those of the plain fit. The interval is that of the parameter given the data, over
//! every set of effects, with their amounts free within their priors ([`crate::infer::unseen`]).
//!
//! An amount of one sign (a compliance, a loss) is taken as normal about its null all the same: as noise has no sign, an interval that is even about the fit holds
//! the truth as often for `|a|` as for `a`. Of several such amounts that pull one way the interval knows the size, not the common sign.
//!
//! A shape parameter that has no null is a mixture: each of its starts has an even share of the amount's variance.

use lut_gen::effect::{CATALOGUE, Owner, Quantity, Spread, contact_offset, drift, relaxation, thickness};
use nalgebra::DMatrix;
use rayon::prelude::*;

use super::check::Check;
use super::coordinate::Candidate;
use super::design::Design;
use super::fit::{Fit, Problem};
use super::search::{allowed, changes};
use crate::infer::lowrank::LowRank;
use crate::infer::presence;
use crate::infer::unseen::Widening;

/// Every effect that may be there, with what it belongs to.
#[must_use]
pub fn candidates(design: &Design) -> Vec<Candidate> {
    let clock = design.series.iter().all(|s| s.start_s.is_some());
    let all = |of: Vec<usize>| {
        let mut all = of;
        all.sort_unstable();
        all.dedup();
        all
    };
    let balls = all(design.series.iter().map(|s| s.indenter).collect());
    let mut measured: Vec<usize> = design.series.iter().map(|s| s.specimen).collect();
    measured.extend(design.checks.iter().filter_map(Check::coupon_of));
    let measured = all(measured);
    let mut list = Vec::new();
    for effect in CATALOGUE {
        let absent = match effect {
            // two times are the one time twice
            _ if *effect == relaxation::TWO => true,
            _ if *effect == thickness::EVERY_HEIGHT => measured.len() < 2,
            _ if *effect == contact_offset::EFFECT => !design.zero_is_contact,
            _ if *effect == drift::EFFECT => !clock,
            _ => false,
        };
        let owners = match effect.owner {
            _ if absent => Vec::new(),
            Owner::All => vec![0],
            Owner::Indenter => balls.clone(),
            Owner::Specimen => measured.clone(),
        };
        list.extend(owners.into_iter().map(|owner| Candidate { effect, owner }));
    }
    list
}

/// Values of a candidate's quantities at one prior deviation of its amount, one list a shape, each of which has an even share of the variance.
#[must_use]
pub fn amounts(design: &Design, candidate: &Candidate) -> Vec<Vec<f64>> {
    let sizes = candidate.sizes(design);
    let each = |q: &Quantity| -> Vec<f64> {
        let q = q.bounded_at(&sizes);
        match q.spread {
            Spread::Even => vec![q.null + q.prior],
            Spread::Logarithmic => q.starts.iter().copied().filter(|s| (q.low..=q.high).contains(s)).collect(),
        }
    };
    candidate.effect.quantities.iter().map(each).fold(vec![Vec::new()], |lists, values| {
        lists.iter().flat_map(|list| values.iter().map(|v| [list.as_slice(), &[*v]].concat())).collect()
    })
}

/// Columns of what a candidate changes at one prior deviation, told by its code: `changes` makes whitened columns of values.
#[must_use]
pub fn columns(
    design: &Design,
    candidate: &Candidate,
    changes: impl Fn(Vec<Vec<f64>>) -> DMatrix<f64>,
) -> Option<LowRank> {
    let each = amounts(design, candidate);
    let share = (1.0 / each.len() as f64).sqrt();
    let mut columns = changes(each);
    // what a model cannot be asked (a part that failed, an amount beyond its force models) widens nothing
    if columns.iter().any(|value| !value.is_finite()) {
        return None;
    }
    let length = columns.norm();
    columns *= share;
    let count = columns.ncols();
    (length > 0.0).then(|| LowRank::new(columns, vec![1.0; count], candidate.effect.code))
}

/// True for what is fitted already: the candidate itself, or another form of an effect that belongs to all.
fn is_fitted(candidate: &Candidate, fit: &Fit) -> bool {
    fit.candidates.iter().any(|own| {
        own.effect.code == candidate.effect.code && (own.owner == candidate.owner || own.effect.owner == Owner::All)
    })
}

/// What the effects that a fit has not in it do to the errors of its parameters; `None` where the data do not determine them.
#[must_use]
pub fn widening(problem: &Problem<'_>, fit: &Fit) -> Option<Widening> {
    let design = problem.design;
    let list = candidates(design);
    let open: Vec<&Candidate> = list.iter().filter(|candidate| !is_fitted(candidate, fit)).collect();
    let of = |candidate: &&Candidate| columns(design, candidate, |values| changes(problem, fit, candidate, values));
    let each: Vec<LowRank> = open.par_iter().filter_map(of).collect();
    // what the effects of the fit may themselves be wrong by is no information
    let forms = allowed(problem, fit);
    let jacobian = forms.all_taken_off(fit.jacobian.clone());
    let residual = forms.taken_off(&fit.residual);
    let unseen = each.into_iter().map(|one| one.mapped(|columns| forms.all_taken_off(columns)));
    Widening::of(&jacobian, &residual, &unseen.collect::<Vec<_>>(), presence::probability())
}
