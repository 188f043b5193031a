//! The finger pad against other people's solvers (`shared/reference/display/README.md`, sections 2
//! and 3), closed forms, and itself on other meshes.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod closed;
mod contact;
mod control;
mod finger;
mod mesh;
mod yielding;

use std::path::PathBuf;

use lut_gen::pad::body::Body;
use lut_gen::pad::body::block::Block;
use lut_gen::pad::law::foam::Foam;
use lut_gen::pad::law::material::Material;
use lut_gen::pad::press::Press;
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

/// The thesis' softest foam (mu 0.0137 MPa, alpha 14.8, nu 0), 25.4 mm high, on a slippery base.
fn foam(top_mm: f64, edge_mm: f64) -> Body {
    let block = Block {
        height_mm: 25.4,
        radius_mm: 25.0,
        top_mm,
        bonded: false,
        material: Material::Foam(Foam::one_term(0.0137, 14.8, 0.0).unwrap()),
        edge_mm,
        fine_mm: 7.0,
    };
    block.body().unwrap()
}

fn timed(press: &Press, travels: &[f64]) -> Vec<State> {
    let start = std::time::Instant::now();
    let states = press.solve(travels).unwrap();
    let steps = states.iter().map(|s| s.steps).sum::<usize>();
    let unknowns = press.model().unwrap().unknowns();
    println!("{unknowns} unknowns, {steps} factorisations, {:.2} s", start.elapsed().as_secs_f64());
    states
}
