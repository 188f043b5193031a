//! Magnets beside another solver and a closed form; the figures are in docs/verification.md, and
//! `cargo run --release -p tests --example verification` makes them again.
#![allow(clippy::unwrap_used)]

use tests::magnets::{CYLINDER_ENDS, Compared, Shared, c_cores, finite_depth, magnetised, permanent, pot, ring};
use tests::shared_or_skipped;

fn met(list: &[Compared]) {
    for compared in list {
        println!("{compared:?}");
        assert!(compared.is_met(), "{compared:?}");
    }
}

/// Runs a comparison where the shared folder has its file.
fn with(file: &str, compare: impl Fn(Shared<'_>) -> Vec<Compared>) {
    if shared_or_skipped(&format!("reference/display/{file}")).is_some() {
        met(&compare(Shared(&tests::shared())));
    }
}

#[test]
fn the_ring_is_that_of_another_solver() {
    with("ring_A.csv", |shared| ring(shared, true).unwrap());
}

#[test]
fn the_ring_without_a_probe_is_that_of_another_solver() {
    with("ring_A_noprobe.csv", |shared| ring(shared, false).unwrap());
}

#[test]
fn the_pot_magnet_is_that_of_another_solver() {
    with("pot_A.csv", |shared| pot(shared).unwrap());
}

#[test]
fn permanent_magnets_are_those_of_another_solver() {
    for name in ["pm_a", "pm_b", "pm_c", "pm_d"] {
        with(&format!("{name}.csv"), |shared| vec![permanent(shared, name).unwrap()]);
    }
}

#[test]
fn a_magnetised_cylinder_is_the_closed_form() {
    with("linear_cylinder.csv", |shared| CYLINDER_ENDS.map(|edge| magnetised(shared, edge).unwrap()).to_vec());
}

#[test]
fn a_gap_leaks_as_much_as_another_solver_says() {
    met(&c_cores().unwrap());
}

#[test]
fn a_ring_of_finite_depth_leaks_as_in_three_dimensions() {
    with("ring_A.csv", |shared| finite_depth(shared).unwrap());
}
