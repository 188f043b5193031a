//! The error bound a table states, against solves on a mesh it never saw, through the reader the board uses.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use lut_gen::solid::contact::Ball;
use lut_gen::solid::law::Hyperfoam;
use lut_gen::solid::model::{Indentation, Resolution, Specimen};
use lut_gen::table::{ForceGrid, Form, GridSpec, write};
use proptest::strategy::{Strategy, ValueTree};
use proptest::test_runner::TestRunner;
use protocol::lut::{Table, axis_name};

/// Draws of exponents; at each, depths and moduli.
const EXPONENTS: usize = 4;
const POINTS: usize = 30;

#[test]
fn forces_read_from_a_table_are_within_its_bound() {
    let ball = Ball { radius_mm: 4.0 };
    let spec = GridSpec::thesis(Specimen::of_height(12.7), ball);
    let grid = ForceGrid::build(&spec, &|_, _| {}).unwrap();
    let bytes = write(&[grid], Form::Factored, Vec::new()).unwrap();
    let table = Table::parse(&bytes).unwrap();
    let bound = f64::from(table.error_bound().total());
    let mut runner = TestRunner::deterministic();
    let mut draw = |range: std::ops::Range<f64>| range.new_tree(&mut runner).unwrap().current();
    let mut worst = 0.0_f64;
    for _ in 0..EXPONENTS {
        let column = draw(0.0..30.0) as usize;
        let alpha = f64::from(table.column_value(column, axis_name::ALPHA).unwrap());
        let problem = Indentation {
            law: Hyperfoam::one_term(1.0, alpha).unwrap(),
            specimen: spec.specimen,
            ball,
            depth_mm: 4.0,
            resolution: Resolution::Refined(2.0),
        };
        let truth = problem.solve_at(&[]).unwrap().profile;
        for _ in 0..POINTS {
            // the force is proportional to mu, so that the modulus does not change relative errors
            let depth = draw(0.05..4.0);
            let read = f64::from(table.force_n(table.locate(depth as f32).unwrap(), column));
            worst = worst.max((read - truth.force_n(depth)).abs() / truth.force_n(4.0));
        }
    }
    println!("worst {worst:.1e}, stated {bound:.1e}");
    assert!(worst < bound, "{worst} {bound}");
    // and the statement is no empty one
    assert!(bound < 5e-3, "{bound}");
}
