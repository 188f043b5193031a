//! Six hyper-viscoelastic parameters from one recording of a ramp and a hold (thesis section 2.11).
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate::identify::newton::verdict::Standing;
use tests::tissue::{LIVER, Pressed, recover};

/// What one press tells lies in its interval; how much the bulk gives way and how that relaxes is said to be known only together.
///
/// The interval of k, which the truth's bulk hides, is known to be too short (docs/identification.md): only its standing is asked for.
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
        assert!(p.holds() || p.name == "k", "{p:?}");
        let identified = ["mu_MPa", "alpha", "g", "tau_s"].contains(&p.name);
        // An interval that held anything would prove nothing.
        assert!(!identified || p.interval.1 / p.interval.0 < 2.0, "{p:?}");
        assert_eq!(p.standing == Some(Standing::Identified), identified, "{p:?}");
    }
}
