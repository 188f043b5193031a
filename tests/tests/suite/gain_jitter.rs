//! How much the gain is thought to scatter from spot to spot is a prior, and no evidence of the modulus (Peelle's puzzle).
#![allow(clippy::unwrap_used)]
use std::path::Path;

use crate::{MODELS, SOLVER};
use lut_gen::chain::Chain;
use lut_gen::effect::relaxation;
use lut_gen::solid::law::PronyTerm;
use palpate::diagnose::Prepared;
use palpate::diagnose::coordinate::Candidate;
use palpate::diagnose::design::Design;
use palpate::diagnose::fit::{Fit, Problem};
use palpate::diagnose::jitter::{EXPECTED, Posterior};
use palpate::diagnose::noise::Jitter;
use palpate::diagnose::search::{Search, allowed};
use palpate::diagnose::whiten::Whitening;
use palpate::infer::covariance::covariance;
use palpate::simulate::{EXAMPLE, Effect, parse, simulate};

/// Largest move of the logarithm of the modulus, in the smaller of two standard errors.
const MOST: f64 = 0.2;

/// Logarithm of the modulus with its standard error.
fn modulus(fit: &Fit) -> (f64, f64) {
    (fit.x[0], covariance(&fit.information).unwrap()[(0, 0)].sqrt())
}

/// Relaxation with finite elements of the whole paths.
fn relaxing(search: &Search<'_>) -> Fit {
    let fit = search.extended(&search.base, &search.candidates[0]);
    search.solved(&fit).unwrap_or(fit)
}

fn moved((one, its): (f64, f64), (other, error): (f64, f64)) -> f64 {
    (one - other).abs() / its.min(error)
}

/// Data without an effect, fitted with the base, and data with relaxation of three sizes, fitted with relaxation that may be wrong by the error of its form.
#[test]
fn twice_the_prior_of_the_gains_jitter_moves_no_modulus() {
    for (g, seed) in [(0.0, 2), (0.0, 5), (0.02, 3), (0.1, 4), (0.1, 5), (0.3, 2), (0.3, 3)] {
        let mut spec =
            parse(Path::new("example.toml"), &EXAMPLE.replace("seed = 1", &format!("seed = {seed}"))).unwrap();
        spec.effects = if g > 0.0 { vec![Effect::Relaxation(vec![PronyTerm::alike(g, 1.0)])] } else { Vec::new() };
        let experiment = simulate(&spec, &SOLVER, &|_, _, _| {}).unwrap().experiment();
        let design = Design::of(&experiment, &experiment.specimens[0].material).unwrap();
        let library = MODELS.of(&design.geometries, &|_, _| {}).unwrap();
        let chain = Chain { library, passages: design.passages() };
        let prepared = Prepared::new(&design, &chain, experiment.sensor.noise_n).unwrap();
        let search = Search::new(prepared, vec![Candidate { effect: &relaxation::ONE, owner: 0 }]);
        let fit = if g > 0.0 { relaxing(&search) } else { search.base.clone() };
        let jittered = |times: f64| {
            let mut noise = search.noise.clone();
            let before = Jitter { gain: times * EXPECTED.gain, ..EXPECTED };
            noise.jitter = Posterior::expecting(&before, &design, &search.curves, &noise.sensor).unwrap().mean();
            let whitening = Whitening::new(&design, &search.curves, &noise).unwrap();
            let whitening = whitening.for_rows(&search.problem.used).unwrap();
            let problem = Problem { whitening, ..search.problem.clone() };
            (modulus(&problem.refit(&fit, &allowed(&problem, &fit))), noise.jitter.gain)
        };
        let ((one, before), (other, after)) = (jittered(1.0), jittered(2.0));
        let by = moved(one, other);
        println!(
            "relaxation {g}, seed {seed}: a jitter of {before:.4} becomes {after:.4} and moves the modulus by {by:.3}: {one:?} {other:?}"
        );
        assert!(by < MOST, "relaxation {g}, seed {seed}: {by}");
    }
}
