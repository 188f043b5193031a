//! Rests of a world: how many, over what, how smooth, how large.

use palpate::simulate::{Along, Kernel, Rest, ShareOf, Spec};
use rand::Rng;
use rand::seq::IndexedRandom;
use rand_pcg::Pcg64;

use super::Kind;
use crate::hidden::even;

/// Root mean square of all rests of a world together, as a share of the force.
pub(super) const TOTAL: (f64, f64) = (0.003, 0.02);
/// Length scales, parts of a variable's range.
const LENGTHS: (f64, f64) = (0.15, 2.0);
/// Of a hundred rests so many vary along a run, the others from run to run only.
const ALONG_RUNS: u32 = 80;
/// Of a hundred of these so many differ from run to run.
const DIFFER: u32 = 45;

/// One to four rests, of which the first four numbers are the draws.
pub(super) fn drawn(spec: &Spec, chance: &mut Pcg64) -> Vec<Rest> {
    let total = even(chance, TOTAL.0, TOTAL.1);
    let mut rests: Vec<Rest> = (0..chance.random_range(1..=4_u32)).map(|draw| one(spec, draw + 1, chance)).collect();
    let square: f64 = rests.iter().map(|rest| rest.amplitude.powi(2)).sum();
    rests.iter_mut().for_each(|rest| rest.amplitude *= total / square.sqrt());
    rests
}

/// A rest so large that it dominates, along the runs.
pub(super) fn dominating(spec: &Spec, chance: &mut Pcg64) -> Rest {
    let amplitude = even(chance, 0.03, 0.12);
    // depth and contact size alone can be an exponent's; what is over time or the way back needs no
    // other variable
    loop {
        let rest = Rest { amplitude, ..one(spec, 0, chance) };
        if kind(&rest).is_some() && along_runs(spec).contains(&rest.along) {
            return rest;
        }
    }
}

/// What varies in a run of a design.
fn along_runs(spec: &Spec) -> Vec<Along> {
    let mut all = vec![Along::Depth, Along::Contact, Along::Time];
    all.extend(spec.runs.iter().any(|run| run.unload).then_some(Along::Back));
    all
}

/// What varies from run to run.
fn between_runs(spec: &Spec) -> Vec<Along> {
    let mut all = vec![Along::Spot, Along::Order];
    let differs =
        |of: fn(&palpate::simulate::RunTemplate) -> f64| spec.runs.iter().any(|run| of(run) != of(&spec.runs[0]));
    all.extend(differs(|run| run.rate_mm_s).then_some(Along::Rate));
    all.extend(spec.runs.iter().any(|run| run.cycles > 1).then_some(Along::Cycle));
    all.extend((spec.indenters.len() > 1).then_some(Along::Ball));
    all.extend((spec.specimens.len() > 1).then_some(Along::Height));
    all
}

fn one(spec: &Spec, draw: u32, chance: &mut Pcg64) -> Rest {
    let (within, between) = (along_runs(spec), between_runs(spec));
    let of = |list: &[Along], chance: &mut Pcg64| list.choose(chance).copied().unwrap_or(Along::Depth);
    let (along, by) = if chance.random_range(0..100) >= ALONG_RUNS {
        (of(&between, chance), None)
    } else {
        let along = of(&within, chance);
        (along, (chance.random_range(0..100) < DIFFER).then(|| of(&between, chance)))
    };
    Rest {
        along,
        by,
        kernel: Kernel::ALL.choose(chance).map_or(Kernel::Matern52, |(_, kernel)| *kernel),
        length: even(chance, LENGTHS.0, LENGTHS.1),
        amplitude: even(chance, 0.2, 1.0),
        of: if chance.random_range(0..4) == 0 { ShareOf::Peak } else { ShareOf::Force },
        draw,
    }
}

/// The kind of what a rest varies with; a rest that has every spot its own has none.
pub(super) fn kind(rest: &Rest) -> Option<Kind> {
    if rest.by == Some(Along::Spot) {
        return None;
    }
    match rest.along {
        Along::Depth | Along::Contact => Some(Kind::ElasticLaw),
        Along::Time | Along::Rate => Some(Kind::Memory),
        Along::Back | Along::Cycle => Some(Kind::History),
        Along::Ball | Along::Height => Some(Kind::Geometry),
        Along::Order => Some(Kind::Clock),
        Along::Spot => None,
    }
}
