//! The extended model at work: simulated relaxing presses, identified again with the effect in the chain, and what a board gains when its
//! table is regenerated (`palpate identify --model`, `palpate gain`).
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::path::Path;
use std::sync::LazyLock;

use crate::MODELS;
use lut_gen::solid::law::PronyTerm;
use lut_gen::solid::model::Resolution;
use palpate::experiment::Experiment;
use palpate::extended::gain::{self, Options};
use palpate::extended::{ExtendedModel, identify};
use palpate::identify::Outcome;
use palpate::simulate::{Effect, Noise, RunTemplate, Solver, Spec, simulate};

/// What is true: instantaneous modulus (MPa), exponent, the part that relaxes, its time (s).
const MU_MPA: f64 = 0.1;
const ALPHA: f64 = 8.0;
const G: f64 = 0.3;
const TAU_S: f64 = 1.0;

/// Two presses with a hold at each of three rates, by finite elements of the whole path.
static EXPERIMENT: LazyLock<Experiment> = LazyLock::new(|| {
    let mut spec = Spec::new("relaxing", 7).foam("foam", MU_MPA, ALPHA, 12.7).ball("r4", 4.0);
    for rate in [0.5, 2.0, 6.0] {
        let ramp = RunTemplate::ramp("foam", "r4", 2.0, rate);
        spec.runs.push(RunTemplate { hold_s: 3.0, replicates: 2, ..ramp });
    }
    // another mesh than the chain's and than the tables'
    spec.refinement = 0.8;
    spec.noise =
        Noise { sensor_n: 0.003, correlation_s: 0.1, contact_jitter_mm: 0.01, gain_jitter: 0.005, ..Noise::default() };
    let spec = spec.with(Effect::Relaxation(vec![PronyTerm::alike(G, TAU_S)]));
    simulate(&spec, &Solver::new(), &|_, _, _| {}).unwrap().experiment()
});

/// A model file as a diagnosis would leave it, its parameters somewhat off.
fn model(g: f64, tau_s: f64) -> ExtendedModel {
    let text = format!(
        "material = \"foam\"\nlaw = \"hyperfoam\"\nmu_MPa = 0.08\nalpha = 10\n\
         [[effect]]\ncode = \"relaxation\"\ng1 = {g}\ntau1_s = {tau_s}\n"
    );
    ExtendedModel::parse(Path::new("model.toml"), &text).unwrap()
}

#[test]
fn parameters_are_found_again_with_the_effect_fixed_or_freed() {
    let fit =
        |model: &ExtendedModel, freed| identify::identify(&EXPERIMENT, model, freed, &MODELS, &|_, _, _| {}).unwrap();
    let [base, fixed] = [fit(&ExtendedModel::base("foam", 0.1, 8.0), false), fit(&model(G, TAU_S), false)];
    let freed = fit(&model(0.15, 0.5), true);
    let error = |found: &identify::Identified, at: usize, truth: f64| (found.parameters[at].value / truth - 1.0).abs();
    for (what, found) in [("base", &base), ("fixed", &fixed), ("freed", &freed)] {
        let [mu, alpha] = [&found.parameters[0], &found.parameters[1]];
        println!(
            "{what}: mu {:.4} {:?}, alpha {:.2} {:?}, left {:.4} N, noise {:.4} N",
            mu.value, mu.interval, alpha.value, alpha.interval, found.rmse_n, found.noise_n
        );
        assert_eq!(found.outcome, Outcome::Fitted);
        assert_eq!(found.starts.len(), 3);
    }
    // what the base knows nothing of goes into its exponent; gain and contact jitter leave 3 % of both with the effect
    assert!(error(&base, 1, ALPHA) > 0.2, "the base is wrong");
    for found in [&fixed, &freed] {
        assert!(error(found, 0, MU_MPA) < 0.04 && error(found, 1, ALPHA) < 0.08);
        let [mu, alpha] = [0, 1].map(|at| found.parameters[at].interval.unwrap());
        assert!(mu.0 < MU_MPA && MU_MPA < mu.1 && alpha.0 < ALPHA && ALPHA < alpha.1);
    }
    assert!(fixed.rmse_n < 0.4 * base.rmse_n && freed.rmse_n < 0.4 * base.rmse_n);
    let relaxation = &freed.effects[0].parameters;
    println!(
        "freed: g {:.3} {:?}, tau {:.3} s {:?}",
        relaxation[0].value, relaxation[0].interval, relaxation[1].value, relaxation[1].interval
    );
    assert!((relaxation[0].value - G).abs() < 0.03 && (relaxation[1].value / TAU_S - 1.0).abs() < 0.1);
    assert!(fixed.effects[0].parameters.iter().all(|p| p.fixed) && relaxation.iter().all(|p| !p.fixed));
    let json = fixed.json(&EXPERIMENT, "model.toml");
    assert_eq!(json["outcome"], "fitted");
    assert_eq!(json["model"]["effects"][0]["parameters"]["g1"]["value"], G);
    assert!(json["parameters"]["mu_MPa"]["interval95"][0].as_f64().unwrap() < fixed.parameters[0].value);
}

#[test]
fn a_model_that_does_not_belong_to_the_experiment_is_refused() {
    let text = "material = \"foam\"\nlaw = \"hyperfoam\"\nmu_MPa = 0.1\nalpha = 8\n[indenter.r6]\nradius_mm = 6\n\
                [[effect]]\ncode = \"radius\"\nindenter = \"r6\"\nerror_mm = 0.1\n";
    let model = ExtendedModel::parse(Path::new("model.toml"), text).unwrap();
    let refused = identify::identify(&EXPERIMENT, &model, false, &MODELS, &|_, _, _| {}).unwrap_err().to_string();
    assert_eq!(refused, "the model's radius belongs to indenter \"r6\", which is not described; known: r4");
}

/// Each rate is palpated with tables whose material was fitted to the other two.
#[test]
fn a_board_gains_by_a_table_of_the_extended_model() {
    let options = Options {
        truth: Some((MU_MPA, ALPHA)),
        alpha: (0..6).map(|i| 2.0 + 2.5 * f64::from(i)).collect(),
        // the tables' own error is then 1 % and less: far below a seventh of the force
        resolution: Resolution::Refined(0.6),
    };
    let found = gain::gain(&EXPERIMENT, &model(G, TAU_S), &options, &MODELS, &|_, _, _| {}).unwrap();
    for line in found.lines() {
        println!("{line}");
    }
    for trial in &found.trials {
        println!("{} {:?} -> {:?}", trial.condition, trial.before, trial.after);
    }
    let [before, after] = found.tallies();
    assert_eq!((before.count, after.count), (6, 6));
    assert!(after.recognised >= 5 && after.mistaken == 0, "{after:?}");
    assert!(before.recognised <= 3, "{before:?}");
    assert!(after.mu_error < before.mu_error && after.force_error < 0.4 * before.force_error, "{before:?} {after:?}");
    assert_eq!(found.kept, ["relaxation (one-term): g1 0.3, tau1_s 1"]);
    assert!(found.left_out.is_empty() && found.freed.is_empty());
    let json = found.json();
    assert_eq!(json["palpations"].as_array().unwrap().len(), 6);
    assert_eq!(json["before"]["palpations"], 6);
}
