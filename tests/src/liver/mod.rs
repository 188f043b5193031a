//! Bovine liver as `palpate simulate` makes it with the values of thesis section 2.11, pressed and held, and its six parameters back from it.
//!
//! All seeds share one forward problem. [`table`] solves it at a few hundred points once, so that a hundred fits cost no solves of their own;
//! [`judge`] profiles the likelihood over the same solves by a search of its own.

pub mod judge;
pub mod table;

use std::path::Path;

use lut_gen::solid::law::PronyTerm;
use palpate::experiment::{Base, Experiment};
use palpate::simulate::{Effect, Noise, RunTemplate, SimulateError, Solver, Spec, TrueLaw, TrueSpecimen, simulate};

use crate::tissue::{LIVER, Tissue};

/// The thesis' values, but bulk and shear relax alike: a bulk that relaxes by 0.003 alone cannot be told from any other here.
pub const TRUTH: Tissue = Tissue { k: LIVER.g, ..LIVER };

/// The larger of the thesis' balls (mm), its depth (mm) and rate (mm/s): under the smaller one that depth is the ball's equator, where the
/// model of a fit ends. The hold (s) is not printed.
pub const BALL_MM: f64 = 6.0;
/// Depth, mm.
pub const DEPTH_MM: f64 = 4.0;
/// Rate, mm/s.
pub const RATE_MM_S: f64 = 1.0;
/// Hold, s.
pub const HOLD_S: f64 = 10.0;
/// Height of the block, mm: not printed either.
const HEIGHT_MM: f64 = 30.0;
/// The recording begins above the surface, mm.
const AIR_MM: f64 = 0.3;
/// Noise, part of the largest force.
const NOISE: f64 = 0.01;

/// The experiment of a noise seed, as a folder of `palpate simulate` would be read.
///
/// # Errors
/// When a solve of the simulation fails.
pub fn experiment(seed: u64, solver: &Solver) -> Result<Experiment, SimulateError> {
    let nu = (3.0 - TRUTH.d_mu) / (6.0 + TRUTH.d_mu);
    let mut spec = Spec::new("liver", seed).ball("ball", BALL_MM);
    spec.specimens.push(TrueSpecimen {
        name: "liver".to_owned(),
        law: TrueLaw::Ogden,
        mu_mpa: TRUTH.mu_mpa,
        alpha: TRUTH.alpha,
        nu,
        second: None,
        thermal_strain: 0.0,
        height_mm: HEIGHT_MM,
        radius_mm: 25.0,
        base: Base::Bonded,
    });
    let ramp = RunTemplate::ramp("liver", "ball", DEPTH_MM, RATE_MM_S);
    spec.runs.push(RunTemplate { hold_s: HOLD_S, air_mm: AIR_MM, ..ramp });
    let mut spec = spec.with(Effect::Relaxation(vec![PronyTerm { g: TRUTH.g, k: TRUTH.k, tau_s: TRUTH.tau_s }]));
    let clean = simulate(&spec, solver, &|_, _, _| {})?;
    let peak_n = clean.runs.iter().flat_map(|run| &run.force_n).copied().fold(0.0, f64::max);
    spec.noise = Noise { sensor_n: NOISE * peak_n, ..Noise::default() };
    Ok(simulate(&spec, solver, &|_, _, _| {})?.experiment_in(Path::new("liver")))
}
