//! Thesis Figs. 33 and 34: which boundings of the Kalman filter find the parameters from 20 x 20 initial estimates.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use protocol::lut::Table;
use tests::bounding::{BOUNDINGS, Benchmark, HIGH, LOW, initial_estimates, run, successes, table};

#[test]
fn the_order_of_the_boundings_is_the_thesis_and_ours_never_fails() {
    let bytes = table().unwrap();
    let table = Table::parse(&bytes).unwrap();
    let initial = initial_estimates();
    assert_eq!(initial.len(), 400);
    let edge = successes(&table, &Benchmark::EDGE, &initial).unwrap();
    let centre = successes(&table, &Benchmark::CENTRE, &initial).unwrap();
    println!("of 400: {BOUNDINGS:?}\nedge {edge:?}\ncentre {centre:?}");
    let [projection, penalty, neighbour, _, constrained] = edge;
    assert!(neighbour > penalty && penalty > projection, "{edge:?}");
    assert_eq!(constrained, 400, "{edge:?}");
    let [projection, penalty, neighbour, _, constrained] = centre;
    assert_eq!((projection, penalty, constrained), (400, 400, 400), "{centre:?}");
    assert!(neighbour < 400 && neighbour > 300, "{centre:?}");
    // Ours, wherever the target lies, corners included, and whether R is 10 uN or 1 mN.
    for error_n in [1e-5, 1e-4, 1e-3] {
        for (i, j) in [(1, 1), (1, 10), (1, 18), (10, 1), (10, 10), (10, 18), (18, 1), (18, 10), (18, 18)] {
            let at = |k: usize, i: u32| (LOW[k] + (HIGH[k] - LOW[k]) * f64::from(i) / 19.0) as f32;
            let target = Benchmark { mu_mpa: at(0, i), alpha: at(1, j), error_n, ..Benchmark::EDGE };
            let ends = run(&table, &target, BOUNDINGS[4].1, &initial).unwrap();
            let failed: Vec<_> = ends.iter().filter(|end| !end.success).collect();
            assert!(failed.is_empty(), "{target:?}: {} failed, first {:?}", failed.len(), failed[0]);
        }
    }
}
