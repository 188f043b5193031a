//! Makes experiments with hidden effects and says how long each took:
//! `cargo run --release -p tests --example hidden_cases -- D36 20 [FOLDER [SEED]]`; `all` instead of a number makes everything that can be hidden
//! once. With a folder they are written there, and the answers beside them, in `FOLDER/truth/`; seeds begin at 0 or at the one given.

use std::path::PathBuf;
use std::time::Instant;

use palpate::simulate::Solver;
use tests::hidden::{Case, Design, What};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let name = arguments.next().unwrap_or_else(|| "D36".to_owned());
    let count = arguments.next().unwrap_or_else(|| "10".to_owned());
    let folder = arguments.next().map(PathBuf::from);
    let first: u64 = arguments.next().map_or(Ok(0), |seed| seed.parse())?;
    let design = Design::named(&name).ok_or("the first argument is a design: D6, D18, D36, D60 or own")?;
    let solver = Solver::new();
    println!("| case | hidden | noise | runs | peak N | solves | s |\n|---|---|---|---|---|---|---|");
    let cases: Vec<Case> = if count == "all" {
        (first..).zip(What::all()).map(|(seed, what)| Case::new(design, seed).hiding(what)).collect()
    } else {
        (first..).take(count.parse()?).map(|seed| Case::new(design, seed)).collect()
    };
    for case in cases {
        let seed = case.seed;
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
