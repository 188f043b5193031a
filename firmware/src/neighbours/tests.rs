#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
use super::*;
use crate::testbed::{Foam, LIBRARY, factored_table, factored_table_with, rated_table};
use protocol::lut::Between;

fn parameters(foam: &Foam) -> Parameters {
    Parameters {
        mu_mpa: foam.mu_mpa as f32,
        alpha: foam.alpha as f32,
        height_mm: foam.height_mm as f32,
        rate_mm_s: 2.0,
    }
}

/// The library's own curve is rounded to counts, and the surface bends between the grid's exponents: a thousandth of the force.
#[test]
fn a_material_of_the_library_lies_at_its_own_entry() {
    let bytes = factored_table();
    let table = Table::parse(&bytes).unwrap();
    for (i, foam) in LIBRARY.iter().enumerate() {
        let placed = between(&table, &parameters(foam)).unwrap();
        let Curve { low, high, weight } = placed.curve;
        let share = if usize::from(low) == i { 1.0 - weight } else { weight };
        assert!(usize::from(low) == i || usize::from(high) == i, "{}: {placed:?}", foam.name);
        assert!(share > 0.99 && placed.departs < 0.002 && !placed.outside, "{}: {placed:?}", foam.name);
        let own = entry(&table, i as u8, &parameters(foam)).unwrap();
        assert!(own.departs < 0.002 && !own.outside, "{}: {own:?}", foam.name);
    }
}

/// Left out of the library one by one: its own travel and the one shown in its place are no farther apart than is stated. The made-up travel
/// goes with mu to the power of -1/2 and knows no alpha, less than the -2/3 of the force that the statement counts with: it must hold.
#[test]
fn a_material_that_is_left_out_is_shown_within_what_is_stated() {
    for (i, foam) in LIBRARY.iter().enumerate() {
        let others: Vec<Foam> = LIBRARY.iter().enumerate().filter(|(k, _)| *k != i).map(|(_, foam)| *foam).collect();
        let (bytes, whole) = (factored_table_with(&others), factored_table());
        let (table, whole) = (Table::parse(&bytes).unwrap(), Table::parse(&whole).unwrap());
        let placed = between(&table, &parameters(foam)).unwrap();
        let curve = Between::new(&table, placed.curve.low, placed.curve.high, placed.curve.weight).unwrap();
        let own = whole.material(i).unwrap();
        let off = (1..=50)
            .map(|k| 0.1 * k as f32)
            .map(|force_n| (curve.shaft_mm(force_n) / own.shaft_mm(force_n) - 1.0).abs())
            .fold(0.0, f32::max);
        let named = placed.curve;
        println!("{}: {named:?}, off {off:.3}, stated {:.3}, outside {}", foam.name, placed.departs, placed.outside);
        assert!(off <= placed.departs, "{}: {off} {placed:?}", foam.name);
    }
}

/// dummy 1 is the softest: what is softer has no neighbour on its other side.
#[test]
fn beyond_the_library_the_nearest_entry_is_shown_and_the_distance_told() {
    let bytes = factored_table();
    let table = Table::parse(&bytes).unwrap();
    let softest = parameters(&LIBRARY[4]);
    let softer = Parameters { mu_mpa: softest.mu_mpa / 2.0, ..softest };
    let placed = between(&table, &softer).unwrap();
    assert_eq!((placed.curve.low, placed.outside), (4, true));
    // Half the modulus, half the force at both depths: 2/3 of ln 2 times the root of two.
    assert!((placed.departs - 0.6536).abs() < 0.01, "{placed:?}");
}

/// Along the valley mu and alpha make up for each other: the place stays.
#[test]
fn an_error_along_the_valley_hardly_moves_the_place() {
    let bytes = factored_table();
    let table = Table::parse(&bytes).unwrap();
    let foam = LIBRARY[1];
    let here = between(&table, &parameters(&foam)).unwrap();
    // A tenth more exponent, and the modulus with which the force at full depth stays.
    let steeper = Foam { alpha: 1.1 * foam.alpha, ..foam };
    let along = Foam { mu_mpa: foam.mu_mpa * foam.force_n(4.0) / steeper.force_n(4.0), ..steeper };
    let there = between(&table, &parameters(&along)).unwrap();
    // Against a tenth more modulus alone.
    let across = Parameters { mu_mpa: 1.1 * foam.mu_mpa as f32, ..parameters(&foam) };
    let moved = |placed: &Placed| {
        let curve = |p: &Placed| Between::new(&table, p.curve.low, p.curve.high, p.curve.weight).unwrap();
        (curve(placed).shaft_mm(2.0) / curve(&here).shaft_mm(2.0) - 1.0).abs()
    };
    let (along, across) = (moved(&there), moved(&between(&table, &across).unwrap()));
    assert!(along < 0.5 * across && across > 0.02, "{along} {across}");
}

#[test]
fn what_is_no_material_has_no_place() {
    let bytes = factored_table();
    let table = Table::parse(&bytes).unwrap();
    let sound = parameters(&LIBRARY[0]);
    for bad in [
        Parameters { mu_mpa: 0.0, ..sound },
        Parameters { mu_mpa: -1.0, ..sound },
        Parameters { mu_mpa: f32::NAN, ..sound },
        Parameters { mu_mpa: f32::INFINITY, ..sound },
        Parameters { alpha: 0.5, ..sound },
        Parameters { alpha: 30.0, ..sound },
        Parameters { alpha: f32::NAN, ..sound },
    ] {
        assert_eq!((between(&table, &bad), entry(&table, 0, &bad)), (None, None), "{bad:?}");
    }
    assert_eq!(entry(&table, 8, &sound), None);
    assert!(has_neighbours(&table));
    let empty = factored_table_with(&[]);
    let empty = Table::parse(&empty).unwrap();
    assert!(!has_neighbours(&empty) && between(&empty, &sound).is_none());
}

/// Heights and rates that the table does not have are those nearest to them.
#[test]
fn a_table_of_rates_is_asked_at_the_rate_of_the_press() {
    let bytes = rated_table();
    let table = Table::parse(&bytes).unwrap();
    let at = |rate_mm_s| between(&table, &Parameters { rate_mm_s, ..parameters(&LIBRARY[3]) }).unwrap();
    // The library's curves are those of the slowest rate, where the foam is softest.
    assert!(at(1.0).departs < 0.002);
    assert_ne!(at(4.0).curve, at(1.0).curve);
}

/// Between a foam with a control curve and one without the coil would be off.
#[test]
fn materials_with_and_without_control_curve_are_not_mixed() {
    let bytes = factored_table();
    let table = Table::parse(&bytes).unwrap();
    let mut mixed = 0;
    for i in 0..100 {
        let mu_mpa = 0.005 * 50f32.powf(0.01 * i as f32);
        let placed = between(&table, &Parameters { mu_mpa, ..parameters(&LIBRARY[3]) }).unwrap();
        let coil = |entry: u8| table.material(usize::from(entry)).unwrap().coil().is_some();
        assert_eq!(coil(placed.curve.low), coil(placed.curve.high), "{placed:?}");
        mixed += usize::from(placed.curve.weight > 0.0);
    }
    assert!(mixed > 50, "{mixed}");
}
