//! Six hyper-viscoelastic parameters from one recording of a ramp and a hold (thesis section 2.11).
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate::identify::newton::verdict::Standing;
use tests::tissue::{LIVER, Pressed, recover};

/// Intervals hold the truth, also of what one ball cannot tell: how much the bulk gives way and how that relaxes.
#[test]
fn six_parameters_of_one_recording() {
    let experiment = Pressed::default().record(&LIVER, 1).unwrap();
    let (found, parameters) = recover(&experiment, &LIVER).unwrap();
    for p in &parameters {
        println!("{} {} in {:?}, truth {}: {:?}", p.name, p.value, p.interval, p.truth, p.standing);
    }
    println!("{} solves, {:.1} s", found.fe_solves, found.seconds);
    assert_eq!(parameters.len(), 6);
    for p in &parameters {
        assert!(p.holds(), "{p:?}");
        let identified = ["mu_MPa", "alpha", "g", "tau_s"].contains(&p.name);
        assert_eq!(p.standing == Some(Standing::Identified), identified, "{p:?}");
    }
}
