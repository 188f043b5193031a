//! Compressed coupons of the foam: what they let a diagnosis say that balls do not.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::{MODELS, SOLVER};
use palpate::diagnose::plan::On;
use palpate::diagnose::{self, Diagnosis, Verdict};
use palpate::experiment::{Experiment, Test};
use palpate::simulate::{Effect, RunTemplate, Spec, TrueSpecimen, simulate};
use tests::hidden::{Case, Design, NoiseKind, What};
use tests::score::follow::Followed;

/// A D18 without an effect: two balls, three rates, loading alone.
fn clean(seed: u64) -> Spec {
    Case::new(Design::D18, seed).hiding(What::Clean).in_noise(NoiseKind::Matched).spec()
}

/// Adds two coupons of 20 mm diameter that are shortened by half their height.
fn with_coupons(mut spec: Spec, test: Test) -> Spec {
    let coupon = TrueSpecimen { name: "coupon".to_owned(), radius_mm: 10.0, ..spec.specimens[0].clone() };
    let ramp = RunTemplate::ramp("coupon", "", 0.5 * coupon.height_mm, 2.0);
    spec.specimens.push(coupon);
    spec.runs.push(RunTemplate { test, indenter: None, replicates: 2, ..ramp });
    spec
}

fn experiment(spec: &Spec) -> Experiment {
    simulate(spec, &SOLVER, &|_, _, _| {}).unwrap().experiment()
}

fn diagnosed(experiment: &Experiment) -> Diagnosis {
    let mut found = diagnose::diagnose(experiment, &MODELS, &|_, _, _| {}).unwrap();
    assert_eq!(found.len(), 1, "a coupon is of the same material");
    let found = found.remove(0);
    let told: Vec<String> =
        found.findings.iter().map(|f| format!("{} {:?} or {:?}", f.code, f.parameters, f.ambiguous_with)).collect();
    println!("{}: {told:?} in {:?}; {:?}", found.verdict.word(), found.shows_in, found.messages);
    found
}

fn codes(found: &Diagnosis) -> Vec<&'static str> {
    found.findings.iter().flat_map(|f| std::iter::once(f.code).chain(f.ambiguous_with.iter().copied())).collect()
}

/// Relative half width of the 95 % interval of the exponent.
fn spread(found: &Diagnosis) -> f64 {
    let [_, (alpha, (low, high))] = found.evidence.as_ref().unwrap().base.base();
    0.5 * (high - low) / alpha
}

/// Where nothing is wrong nothing is said, and the foam is known better than from balls alone.
#[test]
fn a_clean_foam_stays_clean_with_coupons() {
    for (seed, test) in [(43_001, Test::Confined), (43_002, Test::Uniaxial)] {
        let without = diagnosed(&experiment(&clean(seed)));
        let found = diagnosed(&experiment(&with_coupons(clean(seed), test)));
        assert_eq!((without.verdict, found.verdict), (Verdict::Clean, Verdict::Clean), "{:?}", codes(&found));
        assert_eq!(found.evidence.as_ref().unwrap().design.checks.len(), 2);
        assert!(spread(&found) < 0.5 * spread(&without), "{} {}", spread(&found), spread(&without));
    }
}

/// An elastic departure has twins under balls; two coupons tell which it is, with the amount that is true.
#[test]
fn coupons_tell_elastic_twins_apart() {
    let hidden = [
        (43_011, Effect::Poisson { nu: 0.1 }, "nu", 0.1),
        (43_012, Effect::Poisson { nu: 0.1 }, "nu", 0.1),
        (43_013, Effect::SecondTerm { mu2_ratio: 0.3, alpha2: 2.0 }, "mu2_ratio", 0.3),
        (43_014, Effect::SecondTerm { mu2_ratio: 0.3, alpha2: 25.0 }, "mu2_ratio", 0.3),
    ];
    for (seed, effect, name, amount) in hidden {
        let found = diagnosed(&experiment(&with_coupons(clean(seed).with(effect.clone()), Test::Confined)));
        assert_eq!((found.verdict, codes(&found)), (Verdict::Named, vec![effect.code()]), "{seed}");
        let value = found.findings[0].parameters.iter().find(|p| p.0 == name).unwrap().1;
        // which of two terms is the first is a matter of names
        let value = if value > 1.0 { 1.0 / value } else { value };
        // a gain of 2 % a coupon, and of 1 % a spot
        assert!((value / amount - 1.0).abs() < 0.15, "{name} {value}");
    }
}

/// What is ambiguous under balls, or no better than a departure without a name, proposes a coupon first, and that names it.
fn is_decided_by_a_coupon(case: &Case) {
    let all = case.make(&SOLVER).unwrap().experiment();
    let found = diagnosed(&all);
    assert!([Verdict::Ambiguous, Verdict::Unknown].contains(&found.verdict), "{:?}", codes(&found));
    let first = &found.proposals[0];
    assert!(matches!(first.motion.on, On::Confined(_)), "{}", first.what);
    assert!(first.what.contains("in a ring that fits it, lubricated, by "), "{}", first.what);
    // half of the height, or less where a rival would leave the range of the sensor
    let height_mm = all.specimens[first.motion.specimen].height_mm.known().unwrap();
    assert!((0.3..=0.5).contains(&(first.motion.depth_mm / height_mm)), "{}", first.what);
    let followed = Followed::of(case, &all, &found, None, (&SOLVER, &MODELS)).unwrap().unwrap();
    println!("{}", followed.answer.line());
    assert!(followed.resolved && followed.runs.len() == 1, "{}", followed.answer.line());
}

fn hiding(design: Design, seed: u64, code: &'static str, level: usize, noise: NoiseKind) -> Case {
    Case::new(design, seed).hiding(What::Catalogue(code, level)).in_noise(noise)
}

/// A ratio of 0.02 under loading alone, which four other names explain as well.
#[test]
fn a_small_poisson_ratio_is_decided_by_a_coupon() {
    is_decided_by_a_coupon(&hiding(Design::D18, 60_045, "poisson", 0, NoiseKind::Matched));
}

/// A second term of 0.6.
#[test]
fn a_second_term_is_decided_by_a_coupon() {
    is_decided_by_a_coupon(&hiding(Design::D36, 60_027, "second-term", 4, NoiseKind::Matched));
}

/// Balls that meet a stiff skin, and coupons that do not, agree on no law: nothing is named with confidence.
#[test]
fn what_coupons_deny_is_not_named() {
    for (seed, share) in [(43_031, 0.2), (43_032, 0.5)] {
        let mut spec = clean(seed);
        let peak_n = experiment(&spec).runs.iter().flat_map(|r| r.recording.force_n.clone()).fold(0.0, f64::max);
        spec.effects.push(Effect::StiffSkin { stiffness_n_per_mm2: share * peak_n * 5.0 / 27.0 });
        let found = diagnosed(&experiment(&with_coupons(spec, Test::Confined)));
        assert!([Verdict::Unknown, Verdict::Ambiguous].contains(&found.verdict), "{seed} {:?}", codes(&found));
        assert!(!found.shows_in.is_empty());
    }
}

/// A coupon that says nothing is told with its file, and the rest is diagnosed.
#[test]
fn a_coupon_that_says_nothing_is_told() {
    let mut data = experiment(&with_coupons(clean(43_001), Test::Confined));
    for specimen in data.specimens.iter_mut().filter(|s| s.name == "coupon") {
        specimen.radius_mm = palpate::experiment::Length::Unknown;
    }
    let found = diagnosed(&data);
    let told = "a coupon of unknown height or cross-section says nothing of the material";
    assert_eq!(found.messages.iter().filter(|m| m.ends_with(told)).count(), 2, "{:?}", found.messages);
    assert_eq!(found.verdict, Verdict::Clean);
}
