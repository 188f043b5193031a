//! What a seed decides.

use palpate::simulate::{Noise, Spec, Variable};
use rand::seq::IndexedRandom;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;

use super::layout::Layout;
use super::strength::{self, Scales};
use super::{CATALOGUE, Case, Design, LEVELS, NoiseKind, OUTSIDE, PAIRS, Truth, What};

/// Exponents, from 3 to 20: twelve of no regularity, so that suites share their finite-element curves.
const ALPHAS: [f64; 12] = [3.3, 4.1, 5.2, 6.1, 7.4, 8.6, 9.7, 11.3, 12.9, 14.6, 16.8, 19.2];
/// Shear moduli, MPa, even in the logarithm.
const MU_MPA: (f64, f64) = (0.005, 0.3);
/// Of a hundred cases so many are clean, of the catalogue, outside of it, pairs; the rest are placebos.
const SHARES: [u32; 4] = [25, 45, 15, 10];
/// Of a hundred cases so many have noise as assumed.
const MATCHED: u32 = 60;
/// Part of the peak of a placebo.
const PLACEBO: f64 = 0.03;
/// Level of the effects of a pair: both are visible.
const PAIR_LEVELS: [usize; 2] = [3, 4];
/// Force over that of Hertz at the peak: foams soften as they are pressed aside, more so with a larger exponent.
const BELOW_HERTZ: f64 = 0.75;

/// The foam of a case.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Foam {
    /// Shear modulus, MPa.
    pub mu_mpa: f64,
    /// Exponent.
    pub alpha: f64,
}

/// One stream a question, so that fixing one answer changes no other.
fn chance(case: &Case, question: u64) -> Pcg64 {
    let mut mixed = case.seed.wrapping_mul(4).wrapping_add(case.design as u64).wrapping_mul(16).wrapping_add(question);
    mixed = (mixed ^ (mixed >> 31)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    mixed = (mixed ^ (mixed >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    Pcg64::seed_from_u64(mixed ^ (mixed >> 32))
}

/// Even in the logarithm.
pub(crate) fn even(chance: &mut Pcg64, low: f64, high: f64) -> f64 {
    low * (high / low).powf(chance.random::<f64>())
}

fn layout(case: &Case) -> Layout {
    Layout::of(case.design, &mut chance(case, 6))
}

fn foam(case: &Case) -> Foam {
    let mut chance = chance(case, 1);
    let mu_mpa = even(&mut chance, MU_MPA.0, MU_MPA.1);
    // experiments of their own designs have no curve in common
    let alpha = match case.design {
        Design::Own => even(&mut chance, 3.0, 20.0),
        _ => ALPHAS.choose(&mut chance).copied().unwrap_or(8.6),
    };
    Foam { mu_mpa, alpha }
}

fn what(case: &Case) -> What {
    if let Some(what) = &case.what {
        return what.clone();
    }
    let mut chance = chance(case, 2);
    let mut at = chance.random_range(0..100_u32);
    let level = chance.random_range(0..LEVELS);
    let number = |count: usize, chance: &mut Pcg64| chance.random_range(0..count);
    for (kind, share) in SHARES.iter().enumerate() {
        if at < *share {
            return match kind {
                0 => What::Clean,
                1 => What::Catalogue(CATALOGUE[number(CATALOGUE.len(), &mut chance)], level),
                2 => What::Outside(OUTSIDE[number(OUTSIDE.len(), &mut chance)], level),
                _ => What::Pair(PAIRS[number(PAIRS.len(), &mut chance)], PAIR_LEVELS[number(2, &mut chance)]),
            };
        }
        at -= share;
    }
    What::Placebo(Variable::ALL[number(Variable::ALL.len(), &mut chance)].1)
}

fn noise_kind(case: &Case) -> NoiseKind {
    case.noise.unwrap_or_else(|| {
        let matched = chance(case, 3).random_range(0..100_u32) < MATCHED;
        if matched { NoiseKind::Matched } else { NoiseKind::Mismatched }
    })
}

/// Largest force of the design, N, estimated.
fn peak_n(layout: &Layout, foam: &Foam) -> f64 {
    let radius = layout.radii_mm().iter().copied().fold(0.0, f64::max);
    BELOW_HERTZ * 8.0 / 3.0 * foam.mu_mpa * radius.sqrt() * layout.peak_mm.powf(1.5)
}

pub(super) fn truth(case: &Case) -> Truth {
    let (foam, what, layout) = (foam(case), what(case), layout(case));
    let scales = Scales { peak_n: peak_n(&layout, &foam), foam, design: case.design, layout };
    let mut chance = chance(case, 4);
    let effects = match &what {
        What::Clean => Vec::new(),
        What::Catalogue(code, level) | What::Outside(code, level) | What::Deleted(code, level) => {
            strength::effect(code, *level, &scales, &mut chance).into_iter().collect()
        }
        What::Placebo(variable) => {
            vec![palpate::simulate::Effect::Placebo { variable: *variable, amplitude: PLACEBO }]
        }
        What::Pair(codes, level) => {
            codes.iter().filter_map(|code| strength::effect(code, *level, &scales, &mut chance)).collect()
        }
    };
    Truth { what, effects, noise: noise_kind(case), foam }
}

pub(super) fn spec(case: &Case, truth: &Truth) -> Spec {
    let name = format!("hidden {}-{}", case.design.name(), case.seed);
    let layout = layout(case);
    let mut spec = layout.fill(Spec::new(&name, case.seed), &truth.foam);
    let peak = peak_n(&layout, &truth.foam);
    let mut chance = chance(case, 5);
    spec.noise = Noise {
        sensor_n: peak * chance.random_range(0.003..0.01),
        correlation_s: chance.random_range(0.05..0.3),
        contact_jitter_mm: chance.random_range(0.01..0.03),
        gain_jitter: chance.random_range(0.005..0.015),
        ..Noise::default()
    };
    let (quantum, walk, proportional) =
        (chance.random_range(0.0005..0.002), chance.random_range(0.0..0.005), chance.random_range(0.002..0.01));
    if truth.noise == NoiseKind::Mismatched {
        spec.noise.quantum_n = peak * quantum;
        spec.noise.drift_n_per_h = peak * walk;
        spec.noise.proportional = proportional;
        spec.noise.heavy_tails = true;
    }
    spec.effects.clone_from(&truth.effects);
    spec
}
