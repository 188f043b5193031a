//! What the sensor did: each case gives the truth within its intervals, or is refused with the key that helps.

use std::path::Path;

use crate::MODELS;
use palpate::diagnose::diagnose;
use palpate::identify::spec::FitSpec;
use palpate::identify::{Identification, identify};

use super::case::{input, message, read};

/// Material of all cases: `mu`, MPa, and `alpha`.
const TRUE: [(&str, f64); 2] = [("mu_MPa", 0.050), ("alpha", 8.0)];
/// What the cases allow where the data are whole: 6 % of `mu`, one of `alpha`.
const WHOLE: [f64; 2] = [0.003, 1.0];

fn found(folder: &Path) -> Identification {
    let all = identify(&read(folder), &FitSpec::default(), &|_, _, _| {});
    all.unwrap_or_else(|error| panic!("{error}")).remove(0)
}

/// The value and the interval of a parameter.
fn value(of: &Identification, name: &str) -> (f64, (f64, f64)) {
    let fit = of.fit.as_ref().expect("a fit");
    let own = fit.parameters.iter().find(|parameter| parameter.name == name).expect("the parameter");
    (own.value, (own.interval95.low, own.interval95.high))
}

/// The intervals hold the truth; with `within` the values are near it as well.
fn holds_the_truth(of: &Identification, truth: [(&str, f64); 2], within: Option<[f64; 2]>) {
    for (at, (name, truth)) in truth.into_iter().enumerate() {
        let (value, (low, high)) = value(of, name);
        assert!((low..=high).contains(&truth), "{name} {value} [{low}, {high}] {:#?}", of.messages);
        assert!(within.is_none_or(|within| (value - truth).abs() < within[at]), "{name} {value}");
    }
}

/// A message that holds all of these.
fn told(of: &Identification, parts: &[&str]) {
    let has = |message: &&String| parts.iter().all(|part| message.contains(part));
    assert!(of.messages.iter().any(|message| has(&message)), "{parts:?} in {:#?}", of.messages);
}

fn identified(case: &str) -> Option<Identification> {
    input(case).map(|folder| found(&folder))
}

#[test]
fn a_zero_that_the_approach_shows_is_taken_off_and_told() {
    for (case, zero) in [("01a-load-cell-not-zeroed", "0.099"), ("01b-load-cell-zero-negative", "-0.050")] {
        let Some(found) = identified(case) else { return };
        holds_the_truth(&found, TRUE, Some(WHOLE));
        told(&found, &["r8.csv: force zero: the sensor reads ", zero, "before contact", "it is taken off"]);
    }
}

#[test]
fn a_zero_that_nothing_shows_widens_the_intervals_and_is_told() {
    for case in ["02a-tared-at-preload", "02b-tared-at-preload-replicates"] {
        let Some(found) = identified(case) else { return };
        holds_the_truth(&found, TRUE, None);
        told(&found, &["record no force before contact", "[sensor] zero = \"known\""]);
    }
}

#[test]
fn a_press_slower_than_its_approach_is_found() {
    let Some(found) = identified("03a-fast-approach-slow-press") else { return };
    holds_the_truth(&found, TRUE, Some(WHOLE));
    for curve in &found.selection.curves {
        assert!((curve.rate_mm_per_s - 0.5).abs() < 0.02, "{}", curve.rate_mm_per_s);
    }
}

#[test]
fn directions_are_turned_with_a_message_or_refused_with_the_key() {
    let Some(found) = identified("04a-compression-negative") else { return };
    holds_the_truth(&found, TRUE, Some(WHOLE));
    told(&found, &["r8.csv: depth and force fall as the ball goes in", "sign = -1 for `depth_mm` and `force_N`"]);
    let Some(folder) = input("04b-force-negative") else { return };
    let refusal = message(&folder);
    assert!(refusal.starts_with("r8.csv: the force falls to -2.5"), "{refusal}");
    assert!(refusal.contains("write force_N = { name = \"...\", sign = -1 } in [columns]"), "{refusal}");
}

#[test]
fn a_saturated_sensor_is_named_and_its_readings_left_out() {
    let Some(folder) = input("05a-sensor-saturated") else { return };
    let of = found(&folder);
    holds_the_truth(&of, TRUE, Some(WHOLE));
    told(&of, &["r8.csv: the force sensor is saturated", "stands at 1.5 N"]);
    let found = diagnose(&read(&folder), &MODELS, &|_, _, _| {}).unwrap();
    let codes: Vec<&str> = found[0].faults.iter().map(|fault| fault.code()).collect();
    assert_eq!(codes, ["saturated", "saturated"]);
}

#[test]
fn glitches_and_codes_are_left_out_with_their_lines() {
    let Some(of) = identified("06a-one-glitch-a-run") else { return };
    holds_the_truth(&of, TRUE, Some([0.005, 1.5]));
    let (_, (low, high)) = value(&of, "mu_MPa");
    assert!(high / low < 1.5, "{low} {high}");
    for (file, line) in [("r8-a", 57), ("r8-b", 67), ("r5-a", 77), ("r5-b", 87)] {
        told(&of, &[&format!("{file}.csv: line {line}: force_N is 20."), "glitch"]);
    }
    let Some(of) = identified("06b-overload-code-in-the-air") else { return };
    holds_the_truth(&of, TRUE, Some(WHOLE));
    told(&of, &["r8-a.csv: line 18: force_N is 9999, a code of the device"]);
}

#[test]
fn a_deeper_loading_that_is_not_used_is_told() {
    let Some(of) = identified("13a-preconditioning-then-deep") else { return };
    holds_the_truth(&of, TRUE, None);
    told(&of, &["r8.csv: 4 loadings are recorded and the first is used, to 1.50 mm", "3.96 mm", "from_s = 15.2"]);
}

#[test]
fn a_fall_of_the_force_in_a_hold_is_told() {
    let Some(of) = identified("14a-hold-shows-relaxation") else { return };
    told(&of, &["falls by 16 % in the hold", "--relax 1", "palpate diagnose"]);
}

/// The closed form of the law between platens, which begins with a kink.
#[test]
fn coupons_whose_force_begins_with_a_kink_hold_the_truth() {
    for case in ["15a-coupon-sharp-contact", "15b-coupon-sharp-contact-sparse"] {
        let Some(of) = identified(case) else { return };
        holds_the_truth(&of, [("mu_MPa", 0.1), ("alpha", 8.0)], None);
        assert!(!of.messages.iter().any(|m| m.contains("systematically")), "{:#?}", of.messages);
    }
}
