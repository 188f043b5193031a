#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
use super::*;
use crate::lut::{AxisSpec, CoilSpec, DisplaySpec, MaterialSpec, Role, Scale, TableSpec, axis_name};
use proptest::prelude::*;

/// A material whose curves stand on even nodes to `force_n`.
#[derive(Debug, Clone)]
struct Foam {
    force_n: f64,
    shaft_mm: Vec<f64>,
    coil: Option<CoilSpec>,
}

fn table(foams: &[Foam]) -> Vec<u8> {
    let material = |(i, foam): (usize, &Foam)| MaterialSpec {
        name: format!("foam {i}"),
        mu_mpa: 0.1,
        alpha: 8.0,
        height_mm: 20.0,
        acceptance: 0.03,
        rate_mm_s: 0.0,
        force_n: vec![1.0, 2.0],
        display: DisplaySpec {
            force_n: (0..foam.shaft_mm.len())
                .map(|k| foam.force_n * k as f64 / (foam.shaft_mm.len() - 1) as f64)
                .collect(),
            shaft_mm: foam.shaft_mm.clone(),
            coil: foam.coil.clone(),
        },
    };
    let spec = TableSpec {
        axes: vec![
            AxisSpec::new(axis_name::DEPTH, "mm", Role::Row, Scale::Linear, [1.0, 2.0]),
            AxisSpec::new(axis_name::ALPHA, "", Role::Column, Scale::Listed, [8.0]),
        ],
        columns: vec![vec![1.0, 2.0]],
        library: foams.iter().enumerate().map(material).collect(),
        discretisation: 0.0,
        interpolation: 0.0,
        provenance: "made up for tests".into(),
    };
    spec.to_bytes().unwrap()
}

/// Steps that are never negative, summed to at most `most`.
fn rising(steps: Vec<f64>, most: f64) -> Vec<f64> {
    let all: f64 = steps.iter().sum::<f64>().max(1.0);
    let mut at = 0.0;
    std::iter::once(0.0)
        .chain(steps.iter().map(|step| {
            at += step * most / all;
            at
        }))
        .collect()
}

fn foam() -> impl Strategy<Value = Foam> {
    let steps = || proptest::collection::vec(0.0..1.0f64, 5);
    (1.0..8.0f64, steps(), 0.5..20.0f64, steps(), 0.1..2.5f64, 0.0..0.5f64, 0.5..1.0f64, 0.0..0.2f64).prop_map(
        |(force_n, shaft, travel_mm, current, most_a, from, to, bound_a)| Foam {
            force_n,
            shaft_mm: rising(shaft, travel_mm),
            coil: Some(CoilSpec {
                current_a: rising(current, most_a),
                reachable_n: (from * force_n, to * force_n),
                bound_a,
            }),
        },
    )
}

/// Forces of a press, without force and beyond both curves included.
fn forces() -> impl Iterator<Item = f32> {
    (0..=100).map(|i| 0.1 * i as f32)
}

proptest! {
    /// Counts of the table are rounded: 65,535ths of the curve's largest value, twice.
    #[test]
    fn a_mixed_curve_rises_with_force_and_lies_between_both(low in foam(), high in foam(), weight in 0.0..1.0f32) {
        let bytes = table(&[low, high]);
        let table = Table::parse(&bytes).unwrap();
        let between = Between::new(&table, 0, 1, weight).unwrap();
        let [low, high] = [0, 1].map(|i| table.material(i).unwrap());
        let mut last = (0.0, 0.0);
        for force_n in forces() {
            let (shaft_mm, current) = (between.shaft_mm(force_n), between.current(force_n).unwrap());
            let [a, b] = [&low, &high].map(|m| (m.shaft_mm(force_n), m.current(force_n).unwrap()));
            prop_assert!(a.0.min(b.0) <= shaft_mm && shaft_mm <= a.0.max(b.0));
            prop_assert!(a.1.a.min(b.1.a) <= current.a && current.a <= a.1.a.max(b.1.a));
            // Held at the beginning of its reach a current is that of a larger force: it steps there once, at
            // the first force, and rises from then on.
            prop_assert!(shaft_mm >= last.0 - 1e-5 && current.a >= last.1 - 1e-6, "{force_n} N");
            last = (shaft_mm, current.a);
            if weight > 0.0 {
                prop_assert_eq!(current.unreachable, a.1.unreachable || b.1.unreachable);
                let (from, to) = between.reachable_n().unwrap();
                prop_assert_eq!(current.unreachable, force_n > 0.0 && !(from <= force_n && force_n <= to));
            }
        }
    }

    /// The force at the travel of a force is that force, where travel rises; ends and what is no number are told.
    #[test]
    fn the_force_at_a_travel_is_the_inverse_of_both_compressions(low in foam(), high in foam(), weight in 0.0..1.0f32) {
        let bytes = table(&[low, high]);
        let table = Table::parse(&bytes).unwrap();
        let between = Between::new(&table, 0, 1, weight).unwrap();
        let pulp_mm = |force_n: f32| 0.5 * force_n;
        let last_n = [0, 1].map(|i| table.material(i).unwrap().display_force_max_n());
        let last_n = if weight == 0.0 { last_n[0] } else { last_n[0].min(last_n[1]) };
        for part in [0.1, 0.4, 0.9] {
            let force_n = part * last_n;
            let found_n = between.force_at(between.shaft_mm(force_n) + pulp_mm(force_n), pulp_mm);
            prop_assert!((found_n - force_n).abs() < 1e-3, "{found_n} N instead of {force_n}");
        }
        prop_assert_eq!(between.force_at(1e3, pulp_mm), last_n);
        for nothing in [0.0, -1.0, f32::NAN] {
            prop_assert!(between.force_at(nothing, pulp_mm) < 1e-3);
        }
    }

    #[test]
    fn from_one_material_to_the_other_a_curve_goes_one_way(low in foam(), high in foam(), force_n in 0.0..10.0f32) {
        let bytes = table(&[low, high]);
        let table = Table::parse(&bytes).unwrap();
        let at = |i: i32| Between::new(&table, 0, 1, i as f32 / 20.0).unwrap();
        let way = |value: &dyn Fn(&Between<'_>) -> f32| {
            let steps: Vec<f32> = (0..20).map(|i| value(&at(i + 1)) - value(&at(i))).collect();
            steps.iter().all(|s| *s >= -1e-5) || steps.iter().all(|s| *s <= 1e-5)
        };
        prop_assert!(way(&|b| b.shaft_mm(force_n)));
        prop_assert!(way(&|b| b.current(force_n).unwrap().a));
    }

    /// The bound of the mixed current holds both stated errors, and is the material's own at both ends.
    #[test]
    fn errors_are_added(low in foam(), high in foam(), weight in 0.0..1.0f32, force_n in 0.0..10.0f32) {
        let bytes = table(&[low, high]);
        let table = Table::parse(&bytes).unwrap();
        let bounds = [0, 1].map(|i| table.material(i).unwrap().coil().unwrap().bound_a);
        let of = |weight| Between::new(&table, 0, 1, weight).unwrap().bound_a(force_n).unwrap();
        prop_assert!((0.0..=CURRENT_MAX_A).contains(&of(weight)));
        prop_assert!(of(weight) >= bounds[0].min(bounds[1]));
        prop_assert_eq!([of(0.0), of(1.0)], bounds);
        // What mixing adds vanishes towards the ends: half the distance of both at most.
        let apart_a = [0, 1].map(|i| table.material(i).unwrap().current(force_n).unwrap().a);
        let most_a = bounds[0].max(bounds[1]) + 0.5 * (apart_a[0] - apart_a[1]).abs();
        prop_assert!(of(weight) <= most_a + 1e-6);
    }
}

fn straight(force_n: f64, travel_mm: f64, most_a: f64, reachable_n: (f64, f64)) -> Foam {
    let coil = Some(CoilSpec { current_a: vec![0.0, most_a], reachable_n, bound_a: 0.1 });
    Foam { force_n, shaft_mm: vec![0.0, travel_mm], coil }
}

#[test]
fn halfway_is_the_mean_and_both_ends_are_the_materials_themselves() {
    let bytes = table(&[straight(4.0, 2.0, 1.0, (0.0, 4.0)), straight(4.0, 6.0, 2.0, (0.0, 2.0))]);
    let table = Table::parse(&bytes).unwrap();
    let at = |weight| Between::new(&table, 0, 1, weight).unwrap();
    // Nodes and values are rounded to 65,535ths.
    assert!((at(0.5).shaft_mm(2.0) - 2.0).abs() < 1e-4);
    assert!((at(0.5).current(2.0).unwrap().a - 0.75).abs() < 1e-4);
    // 0.1 A of both, and half of the half ampere between them.
    assert!((at(0.5).bound_a(2.0).unwrap() - 0.35).abs() < 1e-4);
    assert_eq!(at(0.5).reachable_n(), Some((0.0, 2.0)));
    assert!(at(0.5).current(2.1).unwrap().unreachable && !at(0.5).current(2.0).unwrap().unreachable);
    for (weight, i) in [(0.0, 0), (-1.0, 0), (f32::NAN, 0), (1.0, 1), (7.0, 1)] {
        let own = table.material(i).unwrap();
        for force_n in forces().chain([f32::NAN, -1.0]) {
            assert_eq!(at(weight).shaft_mm(force_n).to_bits(), own.shaft_mm(force_n).to_bits());
            assert_eq!(at(weight).current(force_n), own.current(force_n));
        }
    }
    assert!(Between::new(&table, 0, 2, 0.5).is_none() && Between::new(&table, 0xff, 0, 0.0).is_none());
}

#[test]
fn reaches_that_do_not_meet_leave_no_force_that_is_reachable() {
    let bytes = table(&[straight(4.0, 2.0, 1.0, (0.0, 1.0)), straight(4.0, 6.0, 2.0, (3.0, 4.0))]);
    let table = Table::parse(&bytes).unwrap();
    let between = Between::new(&table, 0, 1, 0.25).unwrap();
    assert_eq!(between.reachable_n().map(|(from, to)| from > to), Some(true));
    assert!((1..40).all(|i| between.current(0.1 * i as f32).unwrap().unreachable));
    assert_eq!(between.current(0.0).unwrap(), Current { a: 0.0, unreachable: false });
}

#[test]
fn without_a_control_curve_of_both_there_is_none_between() {
    let bare = Foam { coil: None, ..straight(4.0, 2.0, 1.0, (0.0, 4.0)) };
    let bytes = table(&[bare, straight(4.0, 6.0, 2.0, (0.0, 2.0))]);
    let table = Table::parse(&bytes).unwrap();
    let between = Between::new(&table, 0, 1, 0.5).unwrap();
    assert_eq!((between.current(1.0), between.bound_a(1.0), between.reachable_n()), (None, None, None));
    assert!((between.shaft_mm(2.0) - 2.0).abs() < 1e-4);
    assert!(Between::new(&table, 0, 1, 1.0).unwrap().current(1.0).is_some());
}
