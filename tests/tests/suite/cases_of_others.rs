//! `palpate diagnose` on cases that others made, with a generator and meshes of their own.
//!
//! They are not part of this repository; without them the tests say SKIPPED.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::MODELS;
use palpate::diagnose::{Diagnosis, Verdict, diagnose};
use palpate::experiment;

/// Material of all cases: `mu`, MPa, and `alpha`.
const TRUE: [f64; 2] = [0.050, 8.0];

/// The diagnosis of a case, or `None` with a visible message if it is absent.
fn diagnosed(case: &str) -> Option<Diagnosis> {
    let folder = tests::shared_or_skipped(&format!("cases/{case}/input"))?;
    let found = diagnose(&experiment::read(&folder).unwrap(), &MODELS, &|_, _, _| {}).unwrap();
    found.into_iter().next()
}

fn codes(found: &Diagnosis) -> Vec<&'static str> {
    found.findings.iter().flat_map(|f| std::iter::once(f.code).chain(f.ambiguous_with.iter().copied())).collect()
}

/// The intervals of `mu` and `alpha` hold the truth.
fn holds_the_truth(found: &Diagnosis) {
    let parameters = found.extended().unwrap_or(found.evidence.as_ref().unwrap().before.parameters);
    for ((_, (low, high)), truth) in parameters.iter().zip(TRUE) {
        assert!((*low..=*high).contains(&truth), "{truth} in {low} to {high}");
    }
}

/// A foam that relaxes by a fifth with a time of 2 s, held for 20 s by one ball.
#[test]
fn relaxation_is_named_with_its_amount() {
    let Some(found) = diagnosed("14a-hold-shows-relaxation") else { return };
    assert_eq!((found.verdict, codes(&found)), (Verdict::Named, vec!["relaxation"]));
    for ((name, value, (low, high)), truth) in found.findings[0].parameters.iter().zip([0.2, 2.0]) {
        assert!(
            (*low..=*high).contains(&truth) && (value / truth - 1.0).abs() < 0.03,
            "{name} {value} [{low}, {high}]"
        );
    }
    let held_out = found.held_out().unwrap();
    assert!(held_out.rmse_after_n < 0.1 * held_out.rmse_before_n, "{held_out:?}");
    holds_the_truth(&found);
}

/// Force and depth that were zeroed at a preload: an offset of the contact, or unknown, and no wrong ball.
#[test]
fn a_tare_at_a_preload_is_no_wrong_radius() {
    let Some(found) = diagnosed("02c-diagnose-of-tared-recordings") else { return };
    assert!(!codes(&found).contains(&"radius"), "{:?}", codes(&found));
    assert_ne!(found.verdict, Verdict::Clean);
    if let Some(held_out) = found.held_out() {
        assert!(held_out.rmse_after_n <= held_out.rmse_before_n, "{held_out:?}");
    }
    holds_the_truth(&found);
}

/// Nothing is wrong: nothing is named, and what another solver's forces differ by is less than a percent.
#[test]
fn another_solver_s_foam_has_no_name() {
    for case in ["00-control", "00-control-replicates"] {
        let Some(found) = diagnosed(case) else { return };
        assert!(found.findings.is_empty(), "{case}: {:?}", codes(&found));
        let left = found.evidence.as_ref().unwrap().judged.remainder.unwrap_or(0.0);
        assert!(left < 0.01, "{case}: {left}");
        holds_the_truth(&found);
    }
}
