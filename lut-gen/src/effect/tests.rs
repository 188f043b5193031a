use super::*;

#[test]
fn every_effect_of_the_contract_is_in_the_catalogue() {
    let contract = "relaxation, poisson, second-term, softening, thickness, friction, adhesion, contact-offset, compliance, \
                    radius, lag, sensor-gain, sensor-nonlinearity, sensor-creep, drift, numerics";
    for code in contract.split(", ") {
        assert!(find(code, None).is_some(), "{code}");
    }
    for effect in CATALOGUE {
        assert!(contract.split(", ").any(|code| code == effect.code), "{}", effect.code);
    }
}

#[test]
fn quantities_lie_within_their_bounds_and_twins_exist() {
    for effect in CATALOGUE {
        for q in effect.quantities {
            let inside = |x: f64| (q.low..=q.high).contains(&x);
            assert!(inside(q.null) && inside(q.plausible), "{} {}", effect.code, q.name);
            assert!(!q.starts.is_empty() && q.starts.iter().copied().all(inside), "{} {}", effect.code, q.name);
        }
        for twin in effect.twins {
            assert!(find(twin, None).is_some(), "{} names {twin}", effect.code);
        }
    }
}
