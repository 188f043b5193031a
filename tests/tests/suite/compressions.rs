//! Materials that are compressed and never indented: simulated by the material point along the whole motion
//! (`lut_gen::solid::homogeneous`), which shares no code with the chain that names effects, and a public recording.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::path::Path;

use crate::SOLVER;
use lut_gen::solid::law::PronyTerm;
use palpate::diagnose::Verdict;
use palpate::diagnose::compression::{Diagnosis, answer, diagnose};
use palpate::experiment::{self, Test};
use palpate::simulate::{Effect, RunTemplate, Spec, TrueSpecimen, simulate};
use tests::hidden::{Case, Design, NoiseKind, What};

/// Pieces of a foam that are shortened by half at two rates, three of each, held and let go.
fn pieces(seed: u64) -> Spec {
    let mut spec = Case::new(Design::D18, seed).hiding(What::Clean).in_noise(NoiseKind::Matched).spec();
    let piece = TrueSpecimen { name: "piece".to_owned(), radius_mm: 12.0, ..spec.specimens[0].clone() };
    let run = |rate_mm_s: f64, hold_s: f64| RunTemplate {
        test: Test::Uniaxial,
        indenter: None,
        replicates: 3,
        hold_s,
        unload: true,
        ..RunTemplate::ramp("piece", "", 0.5 * piece.height_mm, rate_mm_s)
    };
    spec.runs = vec![run(1.0, 10.0), run(0.1, 0.0)];
    spec.specimens.push(piece);
    spec
}

fn found(spec: &Spec) -> Diagnosis {
    let made = simulate(spec, &SOLVER, &|_, _, _| {}).unwrap().experiment();
    let mut all = diagnose(&made);
    assert_eq!(all.len(), 1);
    let found = all.remove(0);
    println!("{} {:?} {:?}", found.verdict.word(), codes(&found), found.refusal);
    found
}

fn codes(found: &Diagnosis) -> Vec<&'static str> {
    found.findings.iter().flat_map(|f| std::iter::once(f.code).chain(f.ambiguous_with.iter().copied())).collect()
}

#[test]
fn clean_foams_stay_clean() {
    let all: Vec<Diagnosis> = (71_000..71_010).map(|seed| found(&pieces(seed))).collect();
    assert!(all.iter().all(|one| one.findings.is_empty()));
    assert!(all.iter().filter(|one| one.verdict != Verdict::Clean).count() <= 1);
}

/// Three foams each; what is hidden is named in most, alone or in a set, and nothing else is.
#[test]
fn what_is_hidden_is_named() {
    let hidden = |at: usize| {
        let memory = Effect::Relaxation(vec![PronyTerm { g: 0.2, k: 0.2, tau_s: 1.5 }]);
        let [soft, gain] =
            [Effect::Softening { r: 3.0, m_mpa: 0.02, beta: 0.1 }, Effect::Compliance { mm_per_n: 0.05 }];
        [("relaxation", memory), ("softening", soft), ("compliance", gain)][at].clone()
    };
    for at in 0..3 {
        let (code, effect) = hidden(at);
        let all: Vec<Diagnosis> =
            (0..3).map(|k| found(&pieces(71_100 + 10 * at as u64 + k).with(effect.clone()))).collect();
        let right = all.iter().filter(|one| codes(one).contains(&code)).count();
        let wrong: Vec<_> = all.iter().map(codes).filter(|c| !c.is_empty() && !c.contains(&code)).collect();
        assert!(right >= 2 && wrong.is_empty(), "{code}: {right} of 3, wrong {wrong:?}");
    }
}

/// Amounts are those that were hidden.
#[test]
fn a_relaxation_has_its_amount_and_time() {
    let effect = Effect::Relaxation(vec![PronyTerm { g: 0.2, k: 0.2, tau_s: 1.5 }]);
    let found = found(&pieces(71_200).with(effect));
    let [(_, g, _), (_, tau_s, _)] = found.findings[0].parameters[..] else { panic!("two parameters") };
    // the chain's material point against that of the simulation: a hundredth
    assert!((g / 0.2 - 1.0).abs() < 0.03 && (tau_s / 1.5 - 1.0).abs() < 0.05, "{g} {tau_s}");
    let told = answer::json(&found, None);
    assert_eq!(told["effects"][0]["kind"], "memory of the specimen", "{told}");
    assert!(told["held_out"]["rmse_N_after"].as_f64() < told["held_out"]["rmse_N_before"].as_f64());
}

#[test]
fn without_repeats_and_a_stated_noise_it_is_refused() {
    let mut spec = pieces(71_300);
    spec.runs.iter_mut().for_each(|run| run.replicates = 1);
    let found = found(&spec);
    assert_eq!(found.verdict, Verdict::Refused);
    let reason = found.refusal.unwrap().to_string();
    assert!(reason.contains("no two compressions repeat each other") && reason.contains("noise_N"), "{reason}");
}

/// Racing-shoe foam, six cycles and a hold: it softens and relaxes, as an independent fit with a free elastic law
/// says too (`docs/real-diagnoses.md`: only both together predict later cycles, a slow ramp and the hold).
#[test]
fn a_shoe_foam_softens_and_relaxes() {
    if tests::shared_or_skipped("data/shoe_foam").is_none() {
        return;
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("experiments/shoe_foam_cycles");
    let all = diagnose(&experiment::read(&folder).unwrap());
    let judged = &all[0].evidence.as_ref().unwrap().judged;
    assert_eq!((all[0].verdict, codes(&all[0])), (Verdict::Named, vec!["softening"]));
    let belief = judged.belief("relaxation").unwrap();
    assert!(belief.probability > 0.99, "{}", belief.probability);
    assert!(judged.remainder.unwrap() > 0.03);
}
