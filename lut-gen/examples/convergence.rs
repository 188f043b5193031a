//! Mesh convergence of the force: relative error of each mesh against one refined by 2.5,
//! over exponents, heights and balls. The figures of `docs/physics.md` come from
//! `cargo run --release -p lut-gen --example convergence`.

use lut_gen::solid::contact::Ball;
use lut_gen::solid::law::Hyperfoam;
use lut_gen::solid::model::{Curve, Indentation, Resolution, Specimen};
use lut_gen::solid::solve::SolveError;

/// alpha, height [mm], ball radius [mm]
const CASES: [(f64, f64, f64); 6] = [
    (1.0, 12.7, 4.0),
    (4.0, 12.7, 4.0),
    (10.526, 12.7, 6.0),
    (12.711, 19.05, 4.0),
    (24.0, 12.7, 4.0),
    (24.0, 5.0, 4.0),
];

const DEPTHS_MM: [f64; 8] = [0.1, 0.25, 0.5, 0.75, 1.0, 2.0, 3.0, 4.0];

fn solve(alpha: f64, height_mm: f64, radius_mm: f64, resolution: Resolution) -> Result<Curve, SolveError> {
    Indentation {
        law: Hyperfoam::one_term(1.0, alpha)?,
        specimen: Specimen::of_height(height_mm),
        ball: Ball { radius_mm },
        depth_mm: 4.0,
        resolution,
    }
    .solve_at(&DEPTHS_MM)
}

fn main() -> Result<(), SolveError> {
    println!("error [%] at depths {DEPTHS_MM:?} mm");
    for (alpha, height, radius) in CASES {
        println!("alpha {alpha}, height {height} mm, ball {radius} mm");
        let truth = solve(alpha, height, radius, Resolution::Refined(2.5))?;
        for (name, resolution) in [
            ("sizes x 2", Resolution::Refined(0.5)),
            ("sizes x 1.25", Resolution::Refined(0.8)),
            ("standard", Resolution::Standard),
            ("fine", Resolution::Fine),
        ] {
            let curve = solve(alpha, height, radius, resolution)?;
            let s = curve.stats;
            print!(
                "  {name:<13}{:>6} unknowns {:>4} corrections {:>4} factors {:>6.3} s, stated {:.2} |",
                s.unknowns,
                s.iterations,
                s.factorisations,
                s.seconds,
                100.0 * curve.discretisation
            );
            for (a, b) in curve.force_n.iter().zip(&truth.force_n) {
                print!(" {:+.2}", 100.0 * (a / b - 1.0));
            }
            println!();
        }
    }
    Ok(())
}
