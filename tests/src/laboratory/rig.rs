//! Rig and material of a world: what is bare of effects, and the noise.

use palpate::simulate::{Noise, Spec};
use rand::{Rng, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64;

use super::World;
use crate::hidden::{Case, Foam, What, even};

/// What is asked of a seed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u64)]
pub(super) enum Question {
    Design = 1,
    What = 2,
    Foam = 3,
    Noise = 4,
    Rests = 5,
    Effects = 6,
    Balance = 7,
}

/// One stream a question, so that another answer to one changes no other.
pub(super) fn chance(seed: u64, question: Question) -> Pcg64 {
    let mut mixed = seed.wrapping_mul(16).wrapping_add(question as u64).wrapping_add(0x5851_f42d_4c95_7f2d);
    mixed = (mixed ^ (mixed >> 32)).wrapping_mul(0xd6e8_feb8_6659_fd93);
    mixed = (mixed ^ (mixed >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    Pcg64::seed_from_u64(mixed ^ (mixed >> 32))
}

/// Either, one as often as the other.
pub(super) fn sign(chance: &mut Pcg64) -> f64 {
    if chance.random::<bool>() { 1.0 } else { -1.0 }
}

/// An experiment of the world's design on its material, without effects and noise.
pub(super) fn bare(world: &World) -> Spec {
    let mut spec = Case::new(world.design, world.seed).hiding(What::Clean).spec();
    spec.name = format!("laboratory {}-{}", world.design.name(), world.seed);
    spec.noise = Noise::default();
    let mut chance = chance(world.seed, Question::Foam);
    let (mu_mpa, alpha) = (even(&mut chance, 0.003, 0.5), even(&mut chance, 3.0, 20.0));
    // pieces of one material
    let (of_mu, of_alpha) = (even(&mut chance, 0.002, 0.05), even(&mut chance, 0.001, 0.02));
    for piece in &mut spec.specimens {
        let mut normal = || chance.sample::<f64, _>(StandardNormal);
        piece.mu_mpa = mu_mpa * (of_mu * normal()).exp();
        piece.alpha = alpha * (of_alpha * normal()).exp();
    }
    spec.session.random_order = chance.random::<f64>() < 0.8;
    spec.session.gap_s = even(&mut chance, 5.0, 120.0);
    spec
}

/// The material of a specification: mean of its pieces.
pub(super) fn foam(spec: &Spec) -> Foam {
    let mean = |of: fn(&palpate::simulate::TrueSpecimen) -> f64| {
        (spec.specimens.iter().map(|one| of(one).ln()).sum::<f64>() / spec.specimens.len().max(1) as f64).exp()
    };
    Foam { mu_mpa: mean(|one| one.mu_mpa), alpha: mean(|one| one.alpha) }
}

/// Noise and places that differ, where the largest force is `peak_n`.
pub(super) fn noise(seed: u64, peak_n: f64) -> Noise {
    let chance = &mut chance(seed, Question::Noise);
    let in_one_of = |of: u32, chance: &mut Pcg64| chance.random_range(0..of) == 0;
    Noise {
        contact_jitter_mm: even(chance, 0.005, 0.08),
        gain_jitter: even(chance, 0.003, 0.06),
        memory_jitter: if in_one_of(2, chance) { even(chance, 0.01, 0.2) } else { 0.0 },
        sensor_n: peak_n * even(chance, 0.0005, 0.02),
        correlation_s: even(chance, 0.005, 1.0),
        heavy_tails: in_one_of(3, chance),
        drift_n_per_h: if in_one_of(2, chance) { peak_n * even(chance, 0.0005, 0.03) } else { 0.0 },
        quantum_n: if in_one_of(3, chance) { peak_n * even(chance, 0.0002, 0.01) } else { 0.0 },
        proportional: if in_one_of(3, chance) { even(chance, 0.001, 0.02) } else { 0.0 },
    }
}
