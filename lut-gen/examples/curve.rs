//! One force curve, or the thesis' table, for benchmarks: bench/versus-calculix measures it.
//!
//! `curve alpha=10.526 mu=0.22 height=12.7 ball=4 depth=4 refinement=1 repeat=1` prints the number of unknowns and
//! "depth_mm force_n" at 16 even depths, the base sliding; `curve table` solves the 30 x 30 x 200 table of
//! the ball and prints its number of solves.

use lut_gen::solid::contact::Ball;
use lut_gen::solid::law::Hyperfoam;
use lut_gen::solid::model::{Indentation, Resolution, Specimen};
use lut_gen::solid::solve::Base;
use lut_gen::table::{ForceGrid, GridSpec};

/// Depths printed.
const STOPS: usize = 16;

struct Settings {
    table: bool,
    alpha: f64,
    mu: f64,
    height: f64,
    ball: f64,
    depth: f64,
    refinement: f64,
    repeat: f64,
}

fn settings() -> Result<Settings, String> {
    let mut s = Settings {
        table: false,
        alpha: 10.526,
        mu: 0.22,
        height: 12.7,
        ball: 4.0,
        depth: 4.0,
        refinement: 1.0,
        repeat: 1.0,
    };
    for argument in std::env::args().skip(1) {
        if argument == "table" {
            s.table = true;
            continue;
        }
        let (key, value) = argument.split_once('=').ok_or_else(|| format!("{argument:?} is not key=value"))?;
        let place = match key {
            "alpha" => &mut s.alpha,
            "mu" => &mut s.mu,
            "height" => &mut s.height,
            "ball" => &mut s.ball,
            "depth" => &mut s.depth,
            "refinement" => &mut s.refinement,
            "repeat" => &mut s.repeat,
            _ => return Err(format!("{key:?} is no setting")),
        };
        *place = value.parse().map_err(|_| format!("{key} = {value:?} is not a number"))?;
    }
    Ok(s)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let s = settings()?;
    let ball = Ball { radius_mm: s.ball };
    let specimen = Specimen { base: Base::Sliding, ..Specimen::of_height(s.height) };
    if s.table {
        let grid = ForceGrid::build(&GridSpec::thesis(specimen, ball), &|_, _| ())?;
        println!("{} solves, {} curves", grid.solves, grid.spec.mu_mpa.len() * grid.spec.alpha.len());
        return Ok(());
    }
    let problem = Indentation {
        law: Hyperfoam::one_term(s.mu, s.alpha)?,
        specimen,
        ball,
        depth_mm: s.depth,
        resolution: Resolution::Refined(s.refinement),
    };
    let depths: Vec<f64> = (1..=STOPS).map(|i| s.depth * i as f64 / STOPS as f64).collect();
    let mut curve = problem.solve_at(&depths)?;
    for _ in 1..s.repeat as usize {
        curve = problem.solve_at(&depths)?;
    }
    println!("unknowns {}", curve.stats.unknowns);
    for (d, f) in curve.depth_mm.iter().zip(&curve.force_n) {
        println!("{d:.6} {f:.6}");
    }
    Ok(())
}
