//! From an experiment's runs to a problem: which conditions there are, and what is free.

use lut_gen::solid::model::Resolution;

use crate::experiment::{Experiment, Length};
use crate::identify::data::{Height, LoadingCurve, MODEL_OF_HEIGHT, Selection};
use crate::identify::fe::block;
use crate::identify::grip::Grip;
use crate::identify::spec::{Extra, FitSpec, FittedLaw, Own};

use super::condition::{Condition, Source};
use super::coordinate::{Kind, LEAST_SHARE, Scope, Unknown, Values};
use super::problem::Problem;
use super::surrogate::Surrogate;

/// Bounds of an exponent. The engine is tested from 1 to 24 (`lut-gen/tests/suite/region.rs`); what lies beyond is
/// solved where it can be, and reported as outside when the fit ends there.
pub const ALPHA: (f64, f64) = (0.8, 30.0);
/// Exponents between which a search begins.
pub const FIRST_ALPHA: (f64, f64) = (4.0, 14.0);
/// Bounds of Poisson's ratio of a foam.
const NU: (f64, f64) = (0.0, 0.45);
/// Bounds of Ogden's compressibility: Poisson's ratios of 0.49993 to 0.1.
const COMPRESSIBILITY: (f64, f64) = (4e-4, 2.4);
/// Its lower bound between rubbing platens, where stiffer bulks are not solved reliably: a ratio of 0.4983.
const RUBBED_COMPRESSIBILITY: f64 = 1.0 / 300.0;
/// Bounds of the share of a second term: one of nothing has no exponent.
const SHARE: (f64, f64) = (LEAST_SHARE, 1.0 - LEAST_SHARE);
/// Bounds of a relaxing part.
const PART: (f64, f64) = (0.0, 0.97);
/// Bounds of friction.
const FRICTION: (f64, f64) = (1e-4, 1.0);
/// Bounds of friction on platens; at 1 nothing slides any more.
const PLATEN_FRICTION: (f64, f64) = (1e-3, 1.0);
/// The modulus is searched this factor around Hertz's estimate.
const MODULUS_FACTOR: f64 = 300.0;
/// Rates, depths and holds within these shares are one condition.
const SAME_RATE: f64 = 0.05;
const SAME_DEPTH: f64 = 0.03;
const SAME_HOLD: f64 = 0.2;
/// How much deeper than the guess of the contact says a ramp is solved, in ball radii.
const MARGIN: f64 = 0.03;
/// Faces come to touch over this many distances between samples.
const TOUCH_STEPS: f64 = 2.0;
/// Shortest relaxation time searched, in durations of the shortest ramp, and longest, in durations of the longest run.
const TAU: (f64, f64) = (0.02, 5.0);

/// Builds the problem of one material; nothing is solved yet.
pub fn problem<'a>(
    experiment: &Experiment,
    selection: &'a Selection,
    material: &str,
    spec: &FitSpec,
    source: &dyn Fn(&Condition) -> Source,
) -> Problem<'a> {
    let (law, terms) = spec.resolved(experiment, material);
    let (mut conditions, condition_of) = conditions(experiment, selection, spec);
    let unknowns = unknowns(experiment, selection, spec, law, terms);
    for condition in &mut conditions {
        condition.attach(&unknowns);
        condition.source = source(condition);
        if let Source::Table(table) = &condition.source {
            (condition.depth_mm, condition.hold_s) = (table.depth_mm, table.hold_s);
            condition.attach(&unknowns);
        }
    }
    let base = Values {
        law,
        terms,
        mu_mpa: 1.0,
        share: 0.5,
        alpha: [FIRST_ALPHA.0; 2],
        nu: spec.nu,
        compressibility: 0.1,
        prony: vec![(0.3, 0.3, 1.0); spec.relaxation],
        friction: spec.friction,
        platen_friction: spec.platen_friction,
        height_mm: 0.0,
        ball_mm: 0.0,
    };
    Problem { selection, unknowns, base, conditions, condition_of, weights: Vec::new(), loss: spec.loss, smooth: 1.0 }
}

/// Depth past contact at the end of a run's ramp, by the guess of its contact.
fn reached_mm(data: &LoadingCurve) -> f64 {
    let standing = &data.depth_mm[data.hold_from..];
    let peak = if standing.is_empty() {
        data.depth_mm.iter().copied().fold(f64::NEG_INFINITY, f64::max)
    } else {
        standing.iter().sum::<f64>() / standing.len() as f64
    };
    peak - data.contact.contact_mm
}

/// Duration of a run's hold, s.
fn held_s(data: &LoadingCurve) -> f64 {
    if data.hold_from < data.time_s.len() { data.time_s.last().copied().unwrap_or(0.0) } else { 0.0 }
}

/// Without relaxation a pairing of specimen and ball is a condition; with it, its rates, depths and holds are as well.
fn conditions(experiment: &Experiment, selection: &Selection, spec: &FitSpec) -> (Vec<Condition>, Vec<usize>) {
    let relaxing = spec.relaxation > 0;
    let mut conditions: Vec<Condition> = Vec::new();
    let mut of_pairing: Vec<usize> = Vec::new();
    let mut condition_of = Vec::new();
    for data in &selection.curves {
        let (depth_mm, hold_s) = (reached_mm(data), held_s(data));
        let near = |a: f64, b: f64, share: f64| (a - b).abs() <= share * a.max(b);
        let same = (0..conditions.len()).find(|&at| {
            let c = &conditions[at];
            of_pairing[at] == data.pairing
                && (!relaxing
                    || near(c.rate_mm_s, data.rate_mm_per_s, SAME_RATE)
                        && near(c.depth_mm, depth_mm, SAME_DEPTH)
                        && near(c.hold_s, hold_s, SAME_HOLD))
        });
        let at = same.unwrap_or_else(|| {
            let pairing = &selection.pairings[data.pairing];
            of_pairing.push(data.pairing);
            conditions.push(Condition {
                specimen: pairing.specimen,
                grip: pairing.grip,
                rubs: pairing.grip == Grip::Platens && spec.rubs(),
                rounding_mm: 0.0,
                block: block(experiment, selection, pairing),
                depth_mm: if relaxing { depth_mm } else { 0.0 },
                rate_mm_s: if relaxing { data.rate_mm_per_s } else { 1.0 },
                hold_s,
                source: Source::Solves(Resolution::Standard),
                locals: Vec::new(),
                modulus: 0,
                surrogate: Surrogate::default(),
                scatter: 0.0,
                solves: 0,
            });
            conditions.len() - 1
        });
        conditions[at].hold_s = conditions[at].hold_s.max(hold_s);
        if conditions[at].grip.mode().is_some() {
            let steps = data.depth_mm[..data.hold_from].windows(2).map(|pair| (pair[1] - pair[0]).abs());
            let step_mm = steps.sum::<f64>() / (data.hold_from - 1) as f64;
            conditions[at].rounding_mm = conditions[at].rounding_mm.max(TOUCH_STEPS * step_mm);
        }
        if !relaxing {
            // A contact that is found earlier than guessed lets the ball go deeper; past the ramp's end the curve goes on straight.
            let pairing = &selection.pairings[data.pairing];
            let margin_mm = match pairing.grip {
                Grip::Ball { radius_mm, .. } => MARGIN * radius_mm,
                // Nothing is spared by a shorter way.
                _ => pairing.depth_mm,
            };
            let reach = (depth_mm + margin_mm).min(pairing.depth_mm);
            conditions[at].depth_mm = conditions[at].depth_mm.max(reach);
        }
        condition_of.push(at);
    }
    (conditions, condition_of)
}

fn unknowns(
    experiment: &Experiment,
    selection: &Selection,
    spec: &FitSpec,
    law: FittedLaw,
    terms: usize,
) -> Vec<Unknown> {
    let mut list = Vec::new();
    let mut add = |kind, scope, name: String, (low, high): (f64, f64), start: f64| {
        list.push(Unknown { kind, scope, name, low, high, start });
    };
    let mut specimens: Vec<usize> = selection.pairings.iter().map(|p| p.specimen).collect();
    specimens.sort_unstable();
    specimens.dedup();
    let scopes = |own: Own| -> Vec<(Scope, String)> {
        if spec.own.contains(&own) && specimens.len() > 1 {
            let named = |at: &usize| (Scope::Specimen(*at), format!(" of {}", experiment.specimens[*at].name));
            specimens.iter().map(named).collect()
        } else {
            vec![(Scope::All, String::new())]
        }
    };
    let modulus = first_modulus(experiment, selection);
    for (scope, of) in scopes(Own::Mu) {
        let bounds = (modulus / MODULUS_FACTOR, modulus * MODULUS_FACTOR);
        add(Kind::Modulus, scope, format!("mu_MPa{of}"), bounds, modulus);
    }
    for (scope, of) in scopes(Own::Alpha) {
        for term in 0..terms {
            let name = if terms == 1 { "alpha".to_owned() } else { format!("alpha_{}", term + 1) };
            // Two terms that begin alike stay alike.
            let start = if term == 0 { (FIRST_ALPHA.0 * FIRST_ALPHA.1).sqrt() } else { FIRST_ALPHA.0 / 2.0 };
            add(Kind::Alpha(term), scope, format!("{name}{of}"), ALPHA, start);
        }
    }
    if terms > 1 {
        add(Kind::Share, Scope::All, "share_2".to_owned(), SHARE, 0.3);
    }
    let on_platens = selection.pairings.iter().any(|p| p.grip == Grip::Platens);
    if law == FittedLaw::Ogden {
        let rubbed = on_platens && spec.rubs();
        let low = if rubbed { RUBBED_COMPRESSIBILITY } else { COMPRESSIBILITY.0 };
        add(Kind::Compressibility, Scope::All, "D_mu".to_owned(), (low, COMPRESSIBILITY.1), 0.1);
    } else if spec.frees_nu(selection) {
        add(Kind::Nu, Scope::All, "nu".to_owned(), NU, 0.1);
    }
    if spec.relaxation > 0 {
        relaxation(selection, spec.relaxation, &mut add);
    }
    if spec.free.contains(&Extra::PlatenFriction) && on_platens {
        add(Kind::PlatenFriction, Scope::All, "platen_friction".to_owned(), PLATEN_FRICTION, 0.2);
    }
    if spec.free.contains(&Extra::Friction) && selection.pairings.iter().any(|p| p.grip.indenter().is_some()) {
        add(Kind::Friction, Scope::All, "friction".to_owned(), FRICTION, 0.2);
    }
    // A specimen that is compressed or pulled as well has a measured height.
    let under_balls = |at: usize| selection.pairings.iter().all(|p| p.specimen != at || p.grip.indenter().is_some());
    for &at in &specimens {
        let deepest = selection.pairings.iter().filter(|p| p.specimen == at).map(|p| p.depth_mm).fold(0.0, f64::max);
        let specimen = &experiment.specimens[at];
        let name =
            if specimens.len() == 1 { "height_mm".to_owned() } else { format!("height_mm of {}", specimen.name) };
        let free = selection.pairings.iter().find_map(|p| match p.height {
            Height::Free(n) if p.specimen == at => selection.heights.get(n),
            _ => None,
        });
        match (specimen.height_mm, free) {
            (_, Some(free)) => {
                let start = (free.low_mm * free.high_mm).sqrt();
                add(Kind::Height, Scope::Specimen(at), name, (free.low_mm, free.high_mm), start);
            }
            (Length::Known(mm), None) if spec.free.contains(&Extra::Height) && under_balls(at) => {
                let low = (0.5 * mm).max(deepest / MODEL_OF_HEIGHT);
                add(Kind::Height, Scope::Specimen(at), name, (low, (2.0 * mm).max(1.5 * low)), mm.max(low));
            }
            _ => {}
        }
    }
    if spec.free.contains(&Extra::BallRadius) {
        let mut balls: Vec<(usize, f64)> =
            selection.pairings.iter().filter_map(|p| Some((p.grip.indenter()?, p.grip.ball_mm()))).collect();
        balls.sort_by_key(|(at, _)| *at);
        balls.dedup_by_key(|(at, _)| *at);
        for (at, mm) in &balls {
            let name = match balls.len() {
                1 => "ball_radius_mm".to_owned(),
                _ => format!("ball_radius_mm of {}", experiment.indenters[*at].name),
            };
            add(Kind::BallRadius, Scope::Indenter(*at), name, (0.5 * mm, 2.0 * mm), *mm);
        }
    }
    list
}

/// Relaxing parts and times; the first guess is what the holds lose and how long they last.
fn relaxation(selection: &Selection, terms: usize, add: &mut dyn FnMut(Kind, Scope, String, (f64, f64), f64)) {
    let durations = selection.curves.iter().map(|data| {
        let ramp = reached_mm(data) / data.rate_mm_per_s;
        (ramp, ramp + held_s(data))
    });
    let (shortest, longest) = durations.fold((f64::INFINITY, 0.0_f64), |(a, b), (ramp, all)| (a.min(ramp), b.max(all)));
    let held = selection.curves.iter().map(held_s).fold(0.0, f64::max);
    let lost = selection.curves.iter().filter(|data| data.hold_from < data.force_n.len()).map(|data| {
        let peak = data.force_n[..data.hold_from].iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        1.0 - data.force_n.last().copied().unwrap_or(peak) / peak
    });
    let lost = lost.fold(0.3, f64::max).clamp(0.05, 0.9);
    for term in 0..terms {
        let of = if terms == 1 { String::new() } else { format!("_{}", term + 1) };
        let part = lost / terms as f64;
        let tau = match (terms, term) {
            (1, _) => 0.3 * held.max(shortest),
            (_, 0) => 0.05 * held.max(shortest),
            _ => 0.5 * held.max(shortest),
        };
        let bounds = (TAU.0 * shortest, TAU.1 * longest);
        add(Kind::G(term), Scope::All, format!("g{of}"), PART, part);
        add(Kind::K(term), Scope::All, format!("k{of}"), PART, part);
        add(Kind::Tau(term), Scope::All, format!("tau{of}_s"), bounds, tau.clamp(bounds.0, bounds.1));
    }
}

/// Shear modulus (MPa) that the largest forces give at `nu = 0`: under a ball by Hertz's law, `F = 8/3 mu sqrt(R) d^1.5`
/// (thesis Eq. 50), between faces by Hooke's, `F = 2 mu A d / h`.
fn first_modulus(experiment: &Experiment, selection: &Selection) -> f64 {
    let estimates = selection.curves.iter().map(|data| {
        let pairing = &selection.pairings[data.pairing];
        let peak = data.force_n.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        let depth_mm = reached_mm(data).max(1e-3);
        match pairing.grip {
            Grip::Ball { radius_mm, .. } => peak / (8.0 / 3.0 * radius_mm.sqrt() * depth_mm.powf(1.5)),
            _ => {
                let block = block(experiment, selection, pairing);
                peak * block.height_mm / (2.0 * std::f64::consts::PI * block.radius_mm.powi(2) * depth_mm)
            }
        }
    });
    let mut all: Vec<f64> = estimates.collect();
    all.sort_by(f64::total_cmp);
    all.get(all.len() / 2).copied().unwrap_or(0.1)
}
