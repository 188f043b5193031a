//! Force of the round finger on a fluid of constant yield stress, over its travel: `host/plants/fluid-force.csv`.
//!
//! `cargo run --release -p lut-gen --example fluid_force > host/plants/fluid-force.csv`

use lut_gen::pad::body::block::Block;
use lut_gen::pad::body::finger::Finger;
use lut_gen::pad::body::section::Section;
use lut_gen::pad::control::curve::Curve;
use lut_gen::pad::control::search::Display;
use lut_gen::pad::error::PadError;
use lut_gen::pad::law::material::Material;
use lut_gen::pad::law::plastic::Plastic;
use rayon::prelude::*;

/// Shear yield stresses, kPa.
const YIELDS_KPA: [f64; 8] = [0.2, 0.4, 0.8, 1.6, 3.2, 6.4, 12.8, 25.6];
/// Travels, mm: even steps.
const STEP_MM: f64 = 0.25;
const TRAVELS: usize = 16;
/// Strain at which a fluid yields and Poisson's ratio below it, as `palpate control-curve` assumes them.
const YIELD_STRAIN: f64 = 0.01;
const NU: f64 = 0.45;

fn main() -> Result<(), PadError> {
    println!("# Largest force of the round finger on a fluid of constant shear yield stress, simulated:");
    println!("# cargo run --release -p lut-gen --example fluid_force");
    println!("yield_kPa,travel_mm,force_N");
    let curves: Vec<Vec<f64>> = YIELDS_KPA.par_iter().map(|kpa| forces(*kpa)).collect::<Result<_, _>>()?;
    for (kpa, forces) in YIELDS_KPA.iter().zip(curves) {
        for (i, force_n) in forces.iter().enumerate() {
            println!("{kpa},{},{force_n:.6}", STEP_MM * (i + 1) as f64);
        }
    }
    Ok(())
}

/// As far down as there is an equilibrium: a weak fluid closes round the finger.
fn forces(kpa: f64) -> Result<Vec<f64>, PadError> {
    let mpa = 1e-3 * kpa * 3.0_f64.sqrt();
    let finger = Finger { edge_mm: 0.4, ..Finger::round()? };
    let material = Material::Plastic(Plastic::new(mpa / YIELD_STRAIN, NU)?);
    let block = Block {
        height_mm: 25.4,
        radius_mm: 25.0,
        top_mm: -finger.height_mm,
        bonded: false,
        material,
        edge_mm: 0.52,
        fine_mm: 7.0,
    };
    let (section, block) = (Section::Ring, block.body()?);
    let display = Display { section, finger: finger.body()?, block, least_mpa: mpa, step_mm: 0.25, area_weight: 1.0 };
    let constant = Curve::Knots(vec![(1e-9, mpa), (100.0, mpa)]);
    for travels in (2..=TRAVELS).rev() {
        let places: Vec<f64> = (1..=travels).map(|i| STEP_MM * i as f64).collect();
        match display.felt(&constant, &places) {
            Ok(felt) => return Ok(felt.force_n),
            Err(PadError::Stuck { .. }) => {}
            Err(error) => return Err(error),
        }
    }
    Ok(Vec::new())
}
