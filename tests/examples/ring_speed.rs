//! Seconds and errors of the ring electromagnet's curve of 16 currents over orders and sizes, as rows of a markdown table:
//! `cargo run --release -p tests --example ring_speed`.
//!
//! Errors are the largest of all currents beside the reference's table and `bench/versus-ngsolve/ring_A_fine.csv`. Seconds
//! are the least of so many curves (an argument, 3), without mesh and analysis of the matrix, which are apart.

use std::time::Instant;

use lut_gen::fem::triangle::Order;
use lut_gen::magnet::study::{State, Wanted};
use tests::magnets::{law, ring_a, rows};

const FINE: &str = include_str!("../../bench/versus-ngsolve/ring_A_fine.csv");
/// Order, sizes in fluid, core, winding and probe (mm), and what multiplies them all.
const SETTINGS: [(Order, [f64; 4], f64); 8] = [
    (Order::Second, [0.5, 0.5, 1.0, 0.5], 1.0),
    (Order::Second, [0.5, 0.5, 1.0, 0.5], 1.4),
    (Order::Second, [0.5, 2.0, 2.0, 0.5], 1.4),
    (Order::Third, [2.0, 5.0, 5.0, 1.0], 0.7),
    (Order::Third, [2.0, 5.0, 5.0, 1.0], 1.0),
    (Order::Third, [2.0, 5.0, 5.0, 1.0], 1.2),
    (Order::Third, [2.0, 5.0, 5.0, 1.0], 1.4),
    (Order::Third, [3.0, 5.0, 5.0, 1.0], 1.6),
];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let repeats: usize = std::env::args().nth(1).map_or(Ok(3), |n| n.parse())?;
    let shared = tests::shared();
    let table = rows(&std::fs::read_to_string(shared.join("reference/display/ring_A.csv"))?);
    let fine = rows(FINE);
    let mut design = ring_a(law(&std::fs::read_to_string(shared.join("data/bh_tables/1018_Steel.csv"))?)?, true);
    let currents: Vec<f64> = table.iter().map(|row| row[0]).collect();
    println!(
        "| this project | equations | Newton steps | mesh s | wall s | centre, table | linkage, table | centre, fine | linkage, fine |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    for (order, sizes, coarser) in SETTINGS {
        let [fluid, core, winding, probe] = sizes;
        for (region, size) in design.regions.iter_mut().zip([fluid, core, winding, winding, probe]) {
            region.size_mm = Some(size);
        }
        let wanted = Wanted { points: vec![[0.0, 17.0]], order, coarser, is_single: true, ..Wanted::default() };
        let (mut mesh, mut all) = (f64::INFINITY, f64::INFINITY);
        let timed = |currents: &[f64], least: &mut f64| {
            let start = Instant::now();
            let found = design.study(&wanted, currents, &mut |_| {});
            *least = least.min(start.elapsed().as_secs_f64());
            found
        };
        let mut study = timed(&currents, &mut all)?;
        for _ in 0..repeats {
            timed(&[], &mut mesh)?;
            study = timed(&currents, &mut all)?;
        }
        let off = |rows: &[Vec<f64>], column: usize, of: &dyn Fn(&State) -> f64| {
            let pairs = study.states.iter().zip(rows);
            pairs.map(|(state, row)| (of(state) / row[column] - 1.0).abs()).fold(0.0, f64::max)
        };
        let (centre, linkage) = (|s: &State| s.points[0].size_t(), |s: &State| s.linkage_wb[0].value);
        let steps: usize = study.states.iter().map(|state| state.steps).sum();
        println!(
            "| order {}, sizes {sizes:?} x {coarser} | {} | {steps} | {mesh:.2} | {:.2} | {:.1e} | {:.1e} | {:.1e} | {:.1e} |",
            if order == Order::Third { 3 } else { 2 },
            study.field.unknowns(),
            all - mesh,
            off(&table, 1, &centre),
            off(&table, 13, &linkage),
            off(&fine, 1, &centre),
            off(&fine, 2, &linkage),
        );
    }
    Ok(())
}
