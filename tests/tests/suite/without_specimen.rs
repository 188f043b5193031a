//! Runs in air, under a mass and on a stiff block: what they let a diagnosis say that presses into the specimen do not.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::{MODELS, SOLVER};
use lut_gen::solid::law::PronyTerm;
use palpate::diagnose::{self, Diagnosis, Verdict};
use palpate::experiment::{Experiment, Test};
use palpate::simulate::{Effect, RunTemplate, Spec, TrueLaw, TrueSpecimen, simulate};
use tests::hidden::{Case, Design, NoiseKind, What};

/// Time that loads stand, s.
const STANDING_S: f64 = 60.0;

/// A clean D18 to which effects and runs are added; its foam reads a few newtons.
fn clean(seed: u64) -> Spec {
    Case::new(Design::D18, seed).hiding(What::Clean).in_noise(NoiseKind::Matched).spec()
}

fn standing(test: Test, load_n: f64) -> RunTemplate {
    let ramp = RunTemplate::ramp("", "", 1.0, 1.0);
    RunTemplate { test, specimen: None, indenter: None, hold_s: STANDING_S, load_n, replicates: 2, ..ramp }
}

/// Adds a stiff block that is pressed to a load, slowly enough that the way down is seen where the machine yields.
fn on_block(mut spec: Spec, load_n: f64) -> Spec {
    let law = TrueLaw::Rigid { reduced_modulus_mpa: 3000.0 };
    let block = TrueSpecimen { name: "block".to_owned(), law, ..spec.specimens[0].clone() };
    let ball = spec.indenters[0].name.clone();
    spec.specimens.push(block);
    let ramp = RunTemplate::ramp("block", &ball, 1.0, 0.5);
    spec.runs.push(RunTemplate { hold_s: STANDING_S, load_n, replicates: 2, unload: true, ..ramp });
    spec
}

fn experiment(spec: &Spec) -> Experiment {
    simulate(spec, &SOLVER, &|_, _, _| {}).unwrap().experiment()
}

fn diagnosed(experiment: &Experiment) -> Diagnosis {
    let mut found = diagnose::diagnose(experiment, &MODELS, &|_, _, _| {}).unwrap();
    assert_eq!(found.len(), 1, "a block is no material");
    let found = found.remove(0);
    let told: Vec<String> =
        found.findings.iter().map(|f| format!("{} {:?} or {:?}", f.code, f.parameters, f.ambiguous_with)).collect();
    println!("{}: {told:?} in {:?}; {:?}", found.verdict.word(), found.shows_in, found.messages);
    found
}

/// Largest force of an experiment, N.
fn largest_n(experiment: &Experiment) -> f64 {
    experiment.runs.iter().flat_map(|r| r.recording.force_n.iter().copied()).fold(0.0, f64::max)
}

fn codes(found: &Diagnosis) -> Vec<&'static str> {
    found.findings.iter().flat_map(|f| std::iter::once(f.code).chain(f.ambiguous_with.iter().copied())).collect()
}

/// Where nothing is wrong nothing is said, whatever is recorded.
#[test]
fn nothing_wrong_is_clean_with_all_of_them() {
    let load_n = largest_n(&experiment(&clean(41_001)));
    let mut spec = on_block(clean(41_001), load_n);
    spec.runs.extend([standing(Test::Air, 0.0), standing(Test::Mass, load_n), standing(Test::Mass, 0.3 * load_n)]);
    let found = diagnosed(&experiment(&spec));
    assert_eq!(found.verdict, Verdict::Clean, "{:?}", codes(&found));
    let evidence = found.evidence.as_ref().unwrap();
    assert_eq!(evidence.design.checks.len(), 8);
    // a gain and a cancelling pair are seen now; no run here tells the depth gauge's
    assert!(found.cancelling.iter().all(|told| told.contains("depth gauge")), "{:?}", found.cancelling);
    assert!(!found.blind_to.contains(&"sensor-gain"), "{:?}", found.blind_to);
}

/// The gain of a sensor is mu until a mass is put on it.
#[test]
fn a_mass_tells_the_gain_from_the_modulus() {
    let mut spec = clean(41_002);
    spec.effects.push(Effect::SensorGain { gain: 1.06 });
    let without = experiment(&spec);
    let found = diagnosed(&without);
    assert_eq!(found.verdict, Verdict::Clean);
    assert!(found.blind_to.contains(&"sensor-gain") && found.cancelling.len() == 3);
    spec.runs.push(standing(Test::Mass, 0.8 * largest_n(&without)));
    let found = diagnosed(&experiment(&spec));
    // a creep that has ended before any press has is a gain: no run of these tells one from the other
    let codes = codes(&found);
    assert!(codes[0] == "sensor-gain" && codes[1..].iter().all(|code| *code == "sensor-creep"), "{codes:?}");
    let (_, value, (low, high)) = found.findings[0].parameters[0];
    assert!(low < 1.06 && 1.06 < high && (value - 1.06).abs() < 0.01, "{value} [{low}, {high}]");
}

/// A machine that yields looks like a wrong radius of one ball, until it presses on something that does not.
#[test]
fn a_stiff_block_tells_a_yielding_machine_from_a_wrong_ball() {
    let mut spec = Case::new(Design::D6, 495_027).hiding(What::Catalogue("compliance", 4)).spec();
    let without = experiment(&spec);
    let found = diagnosed(&without);
    assert!(![Verdict::Clean, Verdict::Named].contains(&found.verdict), "{:?}", codes(&found));
    spec = on_block(spec, largest_n(&without));
    let found = diagnosed(&experiment(&spec));
    assert_eq!((found.verdict, codes(&found)), (Verdict::Named, vec!["compliance"]));
}

/// Relaxation of the specimen and creep of the sensor of equal size and time: on the specimen nearly nothing moves; on a block only the creep does.
#[test]
fn a_stiff_block_shows_what_cancels() {
    let mut spec = clean(41_004);
    for run in &mut spec.runs {
        run.hold_s = 5.0;
    }
    spec.effects.push(Effect::Relaxation(vec![PronyTerm::alike(0.1, 1.5)]));
    spec.effects.push(Effect::SensorCreep { amplitude: 0.1, tau_s: 1.5 });
    let without = experiment(&spec);
    let alone = diagnosed(&without);
    assert!(alone.cancelling.iter().any(|text| text.contains("stiff block")), "{:?}", alone.cancelling);
    let found = diagnosed(&experiment(&on_block(spec, largest_n(&without))));
    let codes = codes(&found);
    assert!(codes.contains(&"relaxation") && codes.contains(&"sensor-creep"), "{codes:?}");
    assert_eq!(found.findings.len(), 2);
}

/// What cannot be used is told with its file.
#[test]
fn what_says_nothing_is_told() {
    let mut spec = clean(41_001);
    spec.runs.push(standing(Test::Mass, 1.0));
    let mut data = experiment(&spec);
    for run in &mut data.runs {
        run.load_n = None;
    }
    let found = diagnosed(&data);
    let told = found.messages.iter().filter(|m| m.contains("a mass without load_N says nothing of the sensor"));
    assert_eq!(told.count(), 2, "{:?}", found.messages);
}
