//! MultiStart where every answer is known: coupons, which cost no finite elements.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::experiment::{Experiment, Test};
use crate::identify::spec::{Extra, FitSpec, Method};
use crate::identify::{Identification, Outcome, identify};
use crate::simulate::{RunTemplate, SecondTerm, Solver, Spec, simulate};

use super::map::candidates;
use super::*;

/// Coupons of 20 mm diameter, shortened by half at 2 mm/s between platens and in a ring, with noise of 0.3 N, about a hundredth of the largest forces.
fn coupons(second: Option<SecondTerm>, nu: f64) -> Experiment {
    let mut spec = Spec::new("coupons", 5).foam("coupon", 0.1, 8.0, 12.0);
    let one = &mut spec.specimens[0];
    (one.radius_mm, one.second, one.nu) = (10.0, second, nu);
    for test in [Test::Uniaxial, Test::Confined] {
        let ramp = RunTemplate::ramp("coupon", "", 6.0, 2.0);
        spec.runs.push(RunTemplate { test, indenter: None, ..ramp });
    }
    (spec.noise.sensor_n, spec.sample_hz) = (0.3, 25.0);
    simulate(&spec, &Solver::new(), &|_, _, _| {}).unwrap().experiment()
}

fn found(experiment: &Experiment, spec: &FitSpec) -> Identification {
    identify(experiment, spec, &|_, _, _| {}).unwrap().remove(0)
}

/// Share that a fit's parameters may be off beyond noise: it spreads the touch of the faces over two samples, here 0.16 mm, which stiffens mu by a hundredth; with samples four times
/// as dense by half of that.
const TOUCH: f64 = 0.02;

/// Both methods, and what each says of every parameter of the truth.
fn agree(experiment: &Experiment, spec: &FitSpec, truth: &[(&str, f64)]) -> Identification {
    let newton = found(experiment, spec);
    let simplex = found(experiment, &FitSpec { method: Method::Simplex, ..spec.clone() });
    assert_eq!((simplex.outcome, simplex.fe_solves), (Outcome::Fitted, 0), "{:?}", simplex.messages);
    let fit = simplex.fit.as_ref().unwrap();
    assert!(fit.search.as_ref().unwrap().converged(), "{:?}", simplex.messages);
    let of = |found: &Identification, name: &str| {
        found.fit.as_ref().unwrap().parameters.iter().find(|p| p.name == name).unwrap().clone()
    };
    for (name, value) in truth {
        let (a, b) = (of(&simplex, name), of(&newton, name));
        println!(
            "{name}: truth {value}, simplex {} {:?}, Gauss-Newton {} {:?}",
            a.value, a.interval95, b.value, b.interval95
        );
        for (one, other) in [(&a, &b), (&b, &a)] {
            let interval = one.interval95;
            assert!((interval.low..=interval.high).contains(&other.value), "{name}: {other:?} outside of {one:?}");
        }
        let (low, high) = (a.interval95.low * (1.0 - TOUCH), a.interval95.high * (1.0 + TOUCH));
        assert!((low..=high).contains(value), "{name}: {value} outside of {a:?}");
    }
    simplex
}

#[test]
fn a_ratio_that_is_free_is_found_by_both_methods() {
    let spec = FitSpec { free: vec![Extra::Nu], terms: Some(1), ..FitSpec::default() };
    let simplex = agree(&coupons(None, 0.2), &spec, &[("mu_MPa", 0.1), ("alpha", 8.0), ("nu", 0.2)]);
    let fit = simplex.fit.as_ref().unwrap();
    let search = fit.search.as_ref().unwrap();
    assert!(search.starts.len() > 1 && search.sample.len() > 100, "{} {}", search.starts.len(), search.sample.len());
    // the objective that is told is that of the parameters that are told
    assert!((search.starts[0].descent.value / fit.objective_n - 1.0).abs() < 1e-9);
    assert!(search.sample.is_sorted_by(|a, b| a.objective_n <= b.objective_n));
    assert!(search.sample.iter().all(|s| s.objective_n >= fit.objective_n));
}

/// Forces of two terms of one ratio: the sum is sharp, its parts are known with their intervals.
#[test]
fn two_terms_are_found_by_both_methods() {
    let second = SecondTerm { mu_mpa: 0.06, alpha: 2.0 };
    let spec = FitSpec { terms: Some(2), nu: 0.2, ..FitSpec::default() };
    agree(&coupons(Some(second), 0.2), &spec, &[("mu_MPa", 0.16)]);
}

/// Of two points that are near in every coordinate the better one is a candidate; nothing above the threshold is.
#[test]
fn candidates_lie_apart_and_under_the_threshold() {
    let bounds = Bounds { low: vec![0.0, 0.0], high: vec![1.0, 1.0] };
    let points = [(0.50, 0.50, 1.0), (0.55, 0.52, 1.1), (0.50, 0.80, 1.2), (0.1, 0.1, 1.3)];
    let mut sample: Vec<Sampled> = points.iter().map(|p| Sampled { point: vec![p.0, p.1], objective_n: p.2 }).collect();
    sample.extend((0..16).map(|i| Sampled { point: vec![0.9, f64::from(i) / 16.0], objective_n: 5.0 }));
    let (threshold, starts) = candidates(&sample, &bounds, 8);
    assert_eq!((threshold, starts.len()), (1.3, 3));
    assert_eq!(starts[..2], [vec![0.5, 0.5], vec![0.5, 0.8]]);
    assert_eq!(candidates(&sample, &bounds, 1).1.len(), 1);
    assert_eq!(candidates(&[], &bounds, 8), (f64::INFINITY, Vec::new()));
}
