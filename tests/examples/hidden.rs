//! Makes experiments with hidden effects and says how long each took:
//! `cargo run --release -p tests --example hidden -- D36 20 [FOLDER]`. With a folder they are written there, and the answers
//! beside them, in `FOLDER/truth/`.

use std::path::PathBuf;
use std::time::Instant;

use palpate::simulate::Solver;
use tests::hidden::{Case, Design};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let name = arguments.next().unwrap_or_else(|| "D36".to_owned());
    let count: u64 = arguments.next().map_or(Ok(10), |text| text.parse())?;
    let folder = arguments.next().map(PathBuf::from);
    let known = Design::ALL.into_iter().find(|design| design.name() == name);
    let design = known.ok_or("the first argument is a design: D6, D18, D36 or D60")?;
    let solver = Solver::new();
    println!("| case | hidden | noise | runs | peak N | solves | s |\n|---|---|---|---|---|---|---|");
    for seed in 0..count {
        let case = Case::new(design, seed);
        let truth = case.truth();
        let started = Instant::now();
        let made = match case.make(&solver) {
            Ok(made) => made,
            Err(error) => {
                println!("| {name}-{seed} | {:?} | failed: {error} |", truth.what);
                continue;
            }
        };
        let peak = made.runs.iter().flat_map(|run| &run.exact_n).copied().fold(0.0, f64::max);
        println!(
            "| {name}-{seed} | {:?} | {:?} | {} | {peak:.3} | {} | {:.2} |",
            truth.what,
            truth.noise,
            made.runs.len(),
            made.solves,
            started.elapsed().as_secs_f64()
        );
        if let Some(folder) = &folder {
            made.write(&folder.join(format!("{name}-{seed}")))?;
            std::fs::create_dir_all(folder.join("truth"))?;
            std::fs::write(folder.join("truth").join(format!("{name}-{seed}.toml")), made.truth_toml())?;
        }
    }
    Ok(())
}
