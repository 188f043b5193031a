use super::*;

#[test]
fn every_effect_of_the_contract_is_in_the_catalogue() {
    let contract = "relaxation, poisson, second-term, softening, thickness, friction, adhesion, contact-offset, compliance, \
                    radius, lag, sensor-gain, sensor-nonlinearity, sensor-creep, drift, numerics, depth-gain, time-gain";
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
            assert!(inside(q.begins) && inside(q.plausible), "{} {}", effect.code, q.name);
            assert!(!q.starts.is_empty() && q.starts.iter().copied().all(inside), "{} {}", effect.code, q.name);
        }
        for twin in effect.twins {
            assert!(find(twin, None).is_some(), "{} names {twin}", effect.code);
        }
    }
}

/// Every amplitude has a deviation that lies within its bounds, and every effect says where that comes from.
#[test]
fn every_effect_has_a_prior_with_a_source() {
    for effect in CATALOGUE {
        assert!(effect.prior.len() > 40, "{} {}: {:?}", effect.code, effect.form, effect.prior);
        for q in effect.quantities {
            let own = q.spread == Spread::Even;
            assert!(own == (q.prior > 0.0), "{} {}", effect.code, q.name);
            assert!((q.low..=q.high).contains(&(q.begins + q.prior)), "{} {}", effect.code, q.name);
        }
    }
}

/// A prior follows the sizes of an experiment as the amounts do.
#[test]
fn priors_follow_the_sizes_of_an_experiment() {
    let sizes = Sizes { force_n: 0.5, radius_mm: 6.0, height_mm: 20.0, rate_mm_per_s: 2.0, run_s: 4.0 };
    let of = |effect: &Effect| effect.quantities[0].bounded_at(&sizes).prior;
    assert!((of(&thickness::HEIGHT) - 0.4).abs() < 1e-12 && (of(&compliance::EFFECT) - 0.04).abs() < 1e-12);
    assert!((of(&sensor_gain::EFFECT) - 0.01).abs() < 1e-12 && (of(&depth_gain::EFFECT) - 0.006).abs() < 1e-12);
}

/// What a ball of 2 mm may be wrong by a ball of 12 mm may be six times; a limit of rates is looked for around the fastest.
#[test]
fn amounts_follow_the_sizes_of_an_experiment() {
    let sizes =
        |radius_mm, height_mm, rate_mm_per_s| Sizes { force_n: 0.5, radius_mm, height_mm, rate_mm_per_s, run_s: 4.0 };
    let of = |effect: &Effect, sizes: &Sizes| effect.quantities[0].bounded_at(sizes);
    let (small, large) = (sizes(2.0, 10.0, 8.0), sizes(12.0, 50.0, 0.1));
    let (a, b) = (of(&radius::EFFECT, &small), of(&radius::EFFECT, &large));
    assert!((b.low / a.low - 6.0).abs() < 1e-12 && a.low > -2.0 && (b.plausible / a.plausible - 6.0).abs() < 1e-12);
    let (a, b) = (of(&thickness::HEIGHT, &small), of(&thickness::HEIGHT, &large));
    assert!((b.high / a.high - 5.0).abs() < 1e-12 && a.low > -10.0);
    let start = |sizes: &Sizes| lag::RATE_LIMIT.quantities[0].scaled(lag::RATE_LIMIT.quantities[0].starts[0], sizes);
    // a little slower than the fastest
    assert!(start(&small) > 1.0 / 8.0 && start(&large) > 1.0 / 0.1 && start(&large) < 2.0 / 0.1);
    assert!((of(&compliance::EFFECT, &small).high - 4.0).abs() < 1e-12);
    assert!(of(&poisson::EFFECT, &small) == of(&poisson::EFFECT, &large));
}

/// Of two times of relaxation none may be ten times as long as the runs, which would be a trend; a single one may.
#[test]
fn of_two_times_the_longer_is_bounded_by_the_runs() {
    let sizes = |run_s| Sizes { force_n: 0.5, radius_mm: 4.0, height_mm: 20.0, rate_mm_per_s: 1.0, run_s };
    let longest = |effect: &Effect, run_s| effect.quantities.last().map(|q| q.bounded_at(&sizes(run_s)).high);
    assert_eq!(longest(&relaxation::TWO, 4.0), Some(40.0));
    assert_eq!(longest(&relaxation::TWO, 400.0), Some(500.0));
    assert_eq!(longest(&relaxation::ONE, 4.0), Some(500.0));
    // one reading is no run: what is left to search is not empty
    assert!(longest(&relaxation::TWO, 0.0) > Some(0.01));
}

/// A code is one file, and what is to be known of an effect is there: its assumption, where it shows, what separates it,
/// what it may be wrong by.
#[test]
fn an_effect_is_one_file_with_all_its_facts() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("src/effect");
    for (at, effect) in CATALOGUE.iter().enumerate() {
        let what = format!("{} {}", effect.code, effect.form);
        let file = folder.join(format!("{}.rs", effect.code.replace('-', "_")));
        assert!(file.is_file(), "{what}: {} is missing", file.display());
        for told in [effect.assumption, effect.signature, effect.separated_by] {
            assert!(told.len() > 10 && !told.ends_with('.'), "{what}: {told:?}");
        }
        let same = |other: &&Effect| (other.code, other.form) == (effect.code, effect.form);
        assert!(!effect.form.is_empty() && !CATALOGUE[..at].iter().any(same), "{what} is there twice");
        assert!(!effect.quantities.is_empty() && !effect.twins.contains(&effect.code), "{what}");
        for (k, q) in effect.quantities.iter().enumerate() {
            assert!(!effect.quantities[..k].iter().any(|other| other.name == q.name), "{what}: {} twice", q.name);
        }
        let (forth, back) = effect.form_error.chain.of();
        assert!(forth > 0.0 && back >= forth, "{what}");
        // who shares a code shares its kind
        assert!(find(effect.code, None).is_some_and(|first| first.kind == effect.kind), "{what}");
    }
}
