#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
use super::*;
use crate::testbed::{Chance, factored_table};

/// EVA and ICF: stiff and soft.
const STIFF: Curve = Curve::of(0);
const SOFT: Curve = Curve::of(2);

fn shown(curve: Curve) -> Showing {
    Showing::of(curve, Origin::ASKED)
}

fn at(showing: &Showing, table: &Table<'_>, force_n: f32) -> Wanted {
    showing.at(table, felt(force_n), 1.5).unwrap()
}

fn felt(force_n: f32) -> Felt {
    Felt { shaft_n: force_n, coil_n: force_n, place_mm: None, ahead_mm: None }
}

/// Below the threshold both wait, and the first reading above it moves nothing.
#[test]
fn shaft_and_coil_wait_for_the_least_force_that_is_told() {
    let config = DisplayConfig::default();
    let of = |read_n, least_n| {
        let felt = Felt::new(&config, read_n, least_n);
        (felt.shaft_n, felt.coil_n)
    };
    assert_eq!(of(0.0, 0.2), (0.2, 0.2));
    assert_eq!(of(0.2, 0.2), (0.2, 0.2));
    assert_eq!(of(0.3, 0.2), (0.3, 0.3));
    // without a threshold only the coil waits
    assert_eq!(of(0.0, 0.0), (0.0, config.coil_standby_n));
    assert_eq!(of(f32::NAN, -3.0), (0.0, config.coil_standby_n));
    // a calibration that states a threshold of newtons, or none
    assert_eq!(of(0.0, 12.0), (config.least_max_n, config.least_max_n));
    assert_eq!(of(0.0, f32::NAN), (0.0, config.coil_standby_n));
}

/// At a finger's place the coil answers to what the material bears there, whatever is read, and to no less than it
/// waits at; the shaft goes on as before.
#[test]
fn at_a_place_the_coil_answers_to_what_the_material_bears() {
    let bytes = factored_table();
    let table = Table::parse(&bytes).unwrap();
    let config = DisplayConfig::default();
    let at = |place_mm: f32| {
        let felt = Felt::new(&config, 3.0, 0.2).at_place(&config, place_mm);
        shown(STIFF).at(&table, felt, 0.0).unwrap()
    };
    let curve = Between::new(&table, 0, 0, 0.0).unwrap();
    for force_n in [0.3, 1.0, 2.0] {
        let wanted = at(curve.shaft_mm(force_n) + pulp::compression_mm(force_n));
        assert!((wanted.bears_n.unwrap() - force_n).abs() < 1e-3);
        assert!((wanted.current.unwrap().a - curve.current(force_n).unwrap().a).abs() < 1e-3);
        assert_eq!(wanted.shaft_mm, curve.shaft_mm(3.0));
    }
    for nothing in [0.0, -2.0, f32::NAN] {
        assert_eq!(at(nothing).current, curve.current(config.coil_standby_n));
    }
}

/// At every force: what is wanted a tick later differs by a fiftieth of the difference of both curves.
#[test]
fn an_exchange_in_the_middle_of_a_press_moves_by_a_fiftieth_a_tick_and_takes_a_second() {
    let bytes = factored_table();
    let table = Table::parse(&bytes).unwrap();
    for force_n in [0.0, 0.3, 1.0, 2.5, 4.5] {
        let mut showing = shown(STIFF);
        let [stiff, soft] = [STIFF, SOFT].map(|curve| at(&shown(curve), &table, force_n));
        showing.go_over(SOFT, Origin::ASKED);
        let mut last = at(&showing, &table, force_n);
        assert_eq!(last, Wanted { is_settled: false, ..stiff }, "nothing has changed yet");
        for tick in 1..=50 {
            showing.step();
            let now = at(&showing, &table, force_n);
            let part = |from: f32, to: f32| (to - from).abs() / 50.0 + 1e-5;
            assert!((now.shaft_mm - last.shaft_mm).abs() <= part(stiff.shaft_mm, soft.shaft_mm), "{tick}");
            let [a, b] = [stiff, soft].map(|w| w.current.unwrap().a);
            assert!((now.current.unwrap().a - last.current.unwrap().a).abs() <= part(a, b), "{tick}");
            assert!((showing.share() - 0.02 * tick as f32).abs() < 1e-6);
            last = now;
        }
        assert_eq!((last, showing), (soft, shown(SOFT)));
    }
}

/// Whatever is asked for and when: shaft and current lie between the least and the largest of all curves, and
/// move in a tick by no more than a fiftieth of that range.
#[test]
fn no_sequence_of_requests_makes_a_jump() {
    let bytes = factored_table();
    let table = Table::parse(&bytes).unwrap();
    let mut chance = Chance(5);
    for _ in 0..100 {
        let force_n = 4.5 * chance.even() as f32;
        let pick = |chance: &mut Chance| {
            let mut index = || (4.0 * chance.even()) as u8;
            Curve { low: index(), high: index(), weight: chance.even() as f32 }
        };
        let all: Vec<Wanted> = (0..4).map(|i| at(&shown(Curve::of(i)), &table, force_n)).collect();
        let range = |value: fn(&Wanted) -> f32| {
            all.iter().map(value).fold((f32::MAX, f32::MIN), |(a, b), x| (a.min(x), b.max(x)))
        };
        let values: [fn(&Wanted) -> f32; 2] = [|w| w.shaft_mm, |w| w.current.unwrap().a];
        let mut showing = shown(pick(&mut chance));
        let mut last = at(&showing, &table, force_n);
        for _ in 0..300 {
            if chance.even() < 0.05 {
                showing.go_over(pick(&mut chance), Origin::ASKED);
            }
            showing.step();
            let now = at(&showing, &table, force_n);
            for value in values {
                let (least, most) = range(value);
                assert!((least..=most).contains(&value(&now)));
                assert!((value(&now) - value(&last)).abs() <= (most - least) / 50.0 + 1e-5);
            }
            last = now;
        }
    }
}

#[test]
fn what_is_asked_for_during_a_transition_waits_and_only_the_latest_of_it_counts() {
    let mut showing = shown(STIFF);
    showing.go_over(SOFT, Origin::ASKED);
    (0..20).for_each(|_| showing.step());
    showing.go_over(Curve::of(1), Origin::ASKED);
    showing.go_over(Curve::of(3), Origin::ASKED);
    (0..29).for_each(|_| showing.step());
    assert_eq!((showing.to(), showing.share()), (SOFT, 0.98));
    showing.step();
    assert_eq!((showing.to(), showing.share()), (Curve::of(3), 0.0));
    (0..50).for_each(|_| showing.step());
    assert_eq!(showing, shown(Curve::of(3)));
}

/// A curve and its origin change together.
#[test]
fn where_a_curve_comes_from_is_told_when_it_is_gone_over_to() {
    let of = |of_palpation| Origin { of_palpation, departs: 0.1, outside: false };
    let mut showing = Showing::of(STIFF, of(1));
    showing.go_over(SOFT, of(2));
    showing.go_over(STIFF, of(3));
    assert_eq!((showing.to(), showing.origin()), (SOFT, of(2)));
    (0..50).for_each(|_| showing.step());
    assert_eq!((showing.to(), showing.origin(), showing.share()), (STIFF, of(3), 0.0));
    (0..50).for_each(|_| showing.step());
    showing.go_over(STIFF, of(4));
    assert_eq!((showing.origin(), showing.share()), (of(4), 1.0));
}

#[test]
fn the_curve_that_is_shown_and_none_at_all_change_nothing() {
    let mut showing = shown(SOFT);
    showing.go_over(SOFT, Origin::ASKED);
    showing.go_over(Curve::NONE, Origin::ASKED);
    assert_eq!(showing, shown(SOFT));
    // Back to what is left, while it is left: the transition ends first.
    showing.go_over(STIFF, Origin::ASKED);
    showing.step();
    showing.go_over(STIFF, Origin::ASKED);
    assert_eq!(showing.to(), STIFF);
    (0..50).for_each(|_| showing.step());
    assert_eq!(showing, shown(STIFF));
}

/// From nothing: the shaft leaves the place where it was, and the current rises from zero.
#[test]
fn a_first_curve_is_gone_over_to_from_a_shaft_at_rest_and_no_current() {
    let bytes = factored_table();
    let table = Table::parse(&bytes).unwrap();
    let mut showing = Showing::NOTHING;
    assert_eq!(showing.at(&table, felt(1.0), 1.5), None);
    showing.go_over(SOFT, Origin::ASKED);
    let first = at(&showing, &table, 1.0);
    assert_eq!((first.shaft_mm, first.current.unwrap().a), (1.5, 0.0));
    showing.step();
    let soft = at(&shown(SOFT), &table, 1.0);
    let second = at(&showing, &table, 1.0);
    assert!((second.current.unwrap().a - 0.02 * soft.current.unwrap().a).abs() < 1e-6);
    assert!((second.shaft_mm - 1.5).abs() <= 0.02 * (soft.shaft_mm - 1.5).abs() + 1e-6);
}

/// A dummy has no control curve: it mixes as no current, and is told as such once it is alone.
#[test]
fn towards_a_material_without_control_curve_the_current_fades() {
    let bytes = factored_table();
    let table = Table::parse(&bytes).unwrap();
    let mut showing = shown(SOFT);
    let own_a = at(&showing, &table, 1.0).current.unwrap().a;
    showing.go_over(Curve::of(5), Origin::ASKED);
    (0..25).for_each(|_| showing.step());
    let half = at(&showing, &table, 1.0);
    assert!((half.current.unwrap().a - 0.5 * own_a).abs() < 1e-6);
    (0..25).for_each(|_| showing.step());
    assert_eq!(at(&showing, &table, 1.0).current, None);
}

#[test]
fn a_curve_that_is_not_in_the_table_is_none() {
    let bytes = factored_table();
    let table = Table::parse(&bytes).unwrap();
    assert_eq!(shown(Curve::of(8)).at(&table, felt(1.0), 0.0), None);
    assert!(shown(Curve::of(7)).at(&table, felt(1.0), 0.0).is_some());
}

/// Where a finger's place says the same as its force the shaft is wanted where the force wants it; half of what the place
/// says beyond is the surface's share of it, and of a rigid material's nothing.
#[test]
fn a_shaft_is_wanted_by_half_where_the_fingers_place_will_have_it() {
    let bytes = factored_table();
    let table = Table::parse(&bytes).unwrap();
    for curve in [STIFF, SOFT] {
        let between = Between::new(&table, curve.low, curve.low, 0.0).unwrap();
        let by = |force_n: f32, more_mm: f32| {
            let place_mm = between.shaft_mm(force_n) + pulp::compression_mm(force_n) + more_mm;
            let felt = Felt { ahead_mm: Some(place_mm), ..felt(force_n) };
            shown(curve).at(&table, felt, 0.0).unwrap().leads_mm
        };
        for force_n in [0.25, 0.3, 1.0, 2.0] {
            assert!(by(force_n, 0.0).abs() < 1e-6);
            // the force of another place a bit further is between both of these
            let gives = |from: f32, to: f32| {
                let mm = between.shaft_mm(to) - between.shaft_mm(from);
                mm / (mm + pulp::compression_mm(to) - pulp::compression_mm(from))
            };
            let (a, b) = (gives(force_n, force_n + 0.02), gives(force_n, force_n + 0.2));
            let share = by(force_n, 0.1) / 0.05;
            assert!(share >= 0.98 * a.min(b) && share <= 1.02 * a.max(b), "{force_n} N: {share}, {a} to {b}");
            assert!((by(force_n, -0.1) + by(force_n, 0.1)).abs() < 1e-5);
        }
        // beyond its last force a curve gives way no more
        assert_eq!(by(60.0, 0.5), 0.0);
    }
}
