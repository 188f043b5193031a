//! The explicit method against the implicit one as the rate falls: the table of `docs/physics.md` comes from
//! `cargo run --release -p lut-gen --example dynamics`.

use std::error::Error;
use std::time::Instant;

use lut_gen::solid::contact::{Ball, Interface};
use lut_gen::solid::dynamics::{Explicit, Press, Pressed};
use lut_gen::solid::law::Hyperfoam;
use lut_gen::solid::model::{Resolution, Simulation, Specimen};
use lut_gen::solid::solve::{Motion, Station};

/// Rate (mm/s), factor on the mass of a foam of 100 kg/m^3, damping (1/s).
const RUNS: [(f64, f64, f64); 8] = [
    (8000.0, 1.0, 0.0),
    (4000.0, 1.0, 0.0),
    (2000.0, 1.0, 0.0),
    (1000.0, 1.0, 0.0),
    (500.0, 1.0, 0.0),
    (250.0, 1.0, 0.0),
    (250.0, 1.0, 4000.0),
    (2.0, 15_625.0, 0.0),
];

/// The thesis' EVA under a ball of 4 mm.
fn eva(depth_mm: f64, resolution: Resolution) -> Result<Simulation, Box<dyn Error>> {
    Ok(Simulation {
        material: Hyperfoam::one_term(0.22, 10.526)?.into(),
        specimen: Specimen::of_height(12.7),
        ball: Ball { radius_mm: 4.0 },
        interface: Interface::default(),
        motion: Motion::ramp(depth_mm, 1.0),
        resolution,
    })
}

/// Difference to the implicit force at the last station, and its root mean square beyond a depth.
fn difference(pressed: &Pressed, stations: &[Station], from_mm: f64) -> (f64, f64) {
    let late: Vec<f64> = (stations.iter().filter(|s| s.depth_mm >= from_mm))
        .map(|s| pressed.force_at(s.depth_mm) / s.force_n - 1.0)
        .collect();
    let square = late.iter().map(|x| x * x).sum::<f64>() / late.len().max(1) as f64;
    (late.last().copied().unwrap_or(f64::NAN), square.sqrt())
}

fn row(quiet: &Simulation, stations: &[Station], run: (f64, f64, f64)) -> Result<(), Box<dyn Error>> {
    let start = Instant::now();
    let (rate_mm_s, mass_scaling, damping_per_s) = run;
    let explicit = Explicit { mass_scaling, damping_per_s, ..Explicit::of_density(100.0) };
    let depth_mm = quiet.depth_mm();
    let simulation = Simulation { motion: Motion::ramp(depth_mm, rate_mm_s), ..quiet.clone() };
    let press = Press { simulation, smooth: 0.5, explicit };
    let pressed = press.solve()?;
    let inertia = pressed.inertia();
    let (last, rms) = difference(&pressed, stations, inertia.from_mm);
    println!(
        "| {depth_mm} | {rate_mm_s} | {mass_scaling} | {damping_per_s} | {} | {:+.2} | {:.2} | {:.2} | {:.2} | {:.3} | {} |",
        pressed.steps,
        100.0 * last,
        100.0 * rms,
        100.0 * inertia.kinetic,
        100.0 * inertia.force,
        100.0 * inertia.balance,
        if inertia.quasi_static() { "yes" } else { "no" },
    );
    eprintln!("{:.2} s, step {:.2e} s, {inertia}", start.elapsed().as_secs_f64(), pressed.smallest_step_s);
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    println!(
        "| depth (mm) | rate (mm/s) | mass x | damping (1/s) | steps | difference at the end (%) | rms (%) | kinetic / strain energy (%) | inertia / force (%) | imbalance (%) | quasi-static |\n|---|---|---|---|---|---|---|---|---|---|---|"
    );
    let coarse = eva(2.0, Resolution::Refined(0.5))?;
    let stations = coarse.solve()?.stations;
    for run in RUNS {
        row(&coarse, &stations, run)?;
    }
    let standard = eva(4.0, Resolution::Standard)?;
    row(&standard, &standard.solve()?.stations, (500.0, 1.0, 0.0))
}
