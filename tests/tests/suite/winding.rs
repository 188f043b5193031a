//! The board's numbers of the winding, and the table that simulations begin with, beside the finite
//! elements of the ring's own file.
#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::LazyLock;

use firmware::coil::winding::{CoilCircuit, LINKAGE_STEP_A, LINKAGES, Winding};
use palpate::magnet::circuit::{self, Circuit, ring_linkage};
use palpate::magnet::{BUILT_IN, Magnet, parse};

/// Part by which a number of the board may differ: four digits are told (5e-4 of the smallest), the
/// mesh errs by 1e-5.
const DIGITS: f64 = 1e-3;

fn ring() -> Magnet {
    let file = BUILT_IN.iter().find(|magnet| magnet.name == "ring").unwrap();
    parse(Path::new("ring.toml"), file.text, &BTreeMap::new()).unwrap()
}

/// The table's currents but for zero, with what finite elements say of them.
static SOLVED: LazyLock<Vec<(f64, f64)>> = LazyLock::new(|| {
    let currents: Vec<f64> = ring_linkage().unwrap().iter().skip(1).map(|row| row.0).collect();
    circuit::linkage(&ring(), &currents).unwrap().1
});

fn near(told: f64, computed: f64, part: f64, what: &str) {
    assert!((told / computed - 1.0).abs() < part, "{what}: {told} told, {computed} computed");
}

#[test]
fn the_board_tells_the_ring_as_its_file_does() {
    let (told, wire) = (Winding::RING, ring().design.coils[0].winding);
    near(f64::from(told.resistance_ohm), wire.ohm(20.0), DIGITS, "resistance at 20 C");
    near(f64::from(told.ohm(105.0)), wire.ohm(105.0), DIGITS, "resistance at 105 C");
    near(f64::from(told.capacity_j_per_k), wire.heat_j_k(), DIGITS, "heat capacity of the copper");
    near(1.0 / f64::from(told.resistance_k_per_w), wire.cooling_w_k, DIGITS, "cooling");
    // The board trips before the varnish ends.
    assert!(f64::from(CoilCircuit::default().range_c.1) < wire.limit_c);
    for i in 1..LINKAGES {
        let ampere = f64::from(LINKAGE_STEP_A) * i as f64;
        let computed = SOLVED.iter().find(|(a, _)| (a - ampere).abs() < 1e-9).unwrap().1;
        near(f64::from(told.linkage_wb[i]), computed, DIGITS, &format!("linkage at {ampere} A"));
    }
}

/// What the regulator is made for: the slope between its points beside that of the curve, at every
/// current up to the trip.
#[test]
fn the_boards_inductance_is_that_of_the_curve_within_its_tolerance() {
    let (told, circuit) = (CoilCircuit::default(), Circuit::ring());
    for pair in SOLVED.windows(2).filter(|pair| pair[1].0 < 2.8) {
        let middle_a = 0.5 * (pair[0].0 + pair[1].0);
        let computed_h = circuit.inductance_h(0.5 * (pair[0].1 + pair[1].1));
        let told_h = f64::from(told.winding.inductance_h((middle_a / f64::from(LINKAGE_STEP_A)) as usize));
        // A quarter of an ampere is where the curve bends most: within the tolerance that the
        // margins are tested over.
        near(told_h, computed_h, f64::from(told.inductance_tolerance), &format!("inductance at {middle_a} A"));
    }
    // And the largest, which the expected current counts on.
    assert!(told.winding.inductance_most_h() > 0.98 * circuit.inductance_h(0.0) as f32);
}

#[test]
fn the_table_that_simulations_begin_with_is_what_finite_elements_say() {
    for ((ampere, told), (_, computed)) in ring_linkage().unwrap().into_iter().skip(1).zip(SOLVED.iter()) {
        // Seven decimals are told: 1e-5 of the smallest. The solver ends at 1e-8 or so.
        assert!((told - computed).abs() < 1e-7, "{ampere} A: {told} Wb told, {computed} Wb computed");
    }
}

/// A magnet of one's own goes the same way as the ring: solved, and then a circuit.
#[test]
fn a_magnet_that_is_solved_is_the_same_circuit() {
    let currents: Vec<f64> = (1..=8).map(|i| 0.375 * f64::from(i)).collect();
    let (solved, read) = (Circuit::solved(&ring(), &currents).unwrap(), Circuit::ring());
    assert_eq!(solved.winding, read.winding);
    for (_, linkage_wb) in SOLVED.iter().filter(|(a, _)| *a <= 3.0) {
        let (a, b) = (solved.current_a(*linkage_wb), read.current_a(*linkage_wb));
        // A third of the points: cubics between them, at the knee at worst.
        assert!((a - b).abs() < 0.02, "{linkage_wb} Wb: {a} and {b} A");
    }
}
