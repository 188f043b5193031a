//! The finger pad against other people's solvers (`shared/reference/display/README.md`, section 2).
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::path::PathBuf;

use lut_gen::pad::body::finger::Finger;
use lut_gen::pad::body::section::Section;
use lut_gen::pad::contact::rigid::{Rigid, Shape};
use lut_gen::pad::press::{Press, Side};
use lut_gen::pad::state::State;

/// Rows of numbers of a reference file, or `None`, said aloud, where it is absent.
fn reference(name: &str) -> Option<Vec<Vec<f64>>> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../shared/reference/display").join(name);
    let Ok(text) = std::fs::read_to_string(&path) else {
        println!("SKIPPED: {} is absent", path.display());
        return None;
    };
    let numbers = |line: &str| line.split(',').map(|cell| cell.trim().parse().ok()).collect::<Option<Vec<f64>>>();
    Some(text.lines().filter(|line| !line.starts_with('#')).filter_map(numbers).collect())
}

fn on_plate(section: Section, edge_mm: f64, penalty: Option<f64>, travels: &[f64]) -> Vec<State> {
    let finger = Finger { edge_mm, ..Finger::round().unwrap() };
    let plate = Rigid { shape: Shape::Plate, tip_mm: -finger.height_mm };
    let mut press = Press::new(section, Side::Soft(finger.body().unwrap()), Side::Rigid(plate));
    press.penalty_mpa_per_mm = penalty;
    let start = std::time::Instant::now();
    let states = press.solve(travels).unwrap();
    println!(
        "{section:?} edge {edge_mm}: {} unknowns, {} steps, {:.2} s",
        press.model().unwrap().unknowns(),
        states.iter().map(|s| s.steps).sum::<usize>(),
        start.elapsed().as_secs_f64()
    );
    states
}

fn finger_on_plate(section: Section, name: &str) {
    let Some(rows) = reference(name) else { return };
    let travels: Vec<f64> = rows.iter().map(|r| r[0]).collect();
    for penalty in [Some(100.0), None] {
        for edge in [0.2, 0.1] {
            for (row, state) in rows.iter().zip(on_plate(section, edge, penalty, &travels)) {
                println!(
                    "d {:.1}: F {:.6} ({:+.3} %), a {:.4} ({:+.4}), p {:.5} {:.5}",
                    row[0],
                    state.force_n,
                    100.0 * (state.force_n / row[1] - 1.0),
                    state.half_width_mm,
                    state.half_width_mm - row[2],
                    state.pressure[0].pressure_mpa,
                    row[3],
                );
            }
        }
    }
}

#[test]
fn finger_on_a_plate_in_the_plane() {
    finger_on_plate(Section::Plane, "finger_F1_ps.csv");
}

#[test]
fn finger_on_a_plate_about_an_axis() {
    finger_on_plate(Section::Ring, "finger_F1_axi.csv");
}
