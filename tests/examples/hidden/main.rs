//! Scores the diagnosis on experiments with hidden effects: `cargo run --release -p tests --example hidden -- --cases 100`.
//!
//! Without `--design` all four designs are scored, with `--cases` of each (100 unless stated). `--only CODE` scores one code ("clean",
//! "matched", "mismatched", "pair", "placebo" or an effect) at all levels by turns, `--seed` moves the first seed, `--verbose` tells
//! every case on a line, `--json FILE` writes every case, `--write` puts the tables into docs/hidden-effects.md.

mod arguments;
mod record;

use std::path::Path;
use std::sync::Mutex;
use std::time::Instant;

use arguments::Arguments;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use palpate::diagnose::Models;
use palpate::simulate::Solver;
use rayon::prelude::*;
use tests::document::replace_section;
use tests::hidden::Case;
use tests::score::{Scored, suite, table::Score};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments = Arguments::parse(std::env::args().skip(1))?;
    let start = Instant::now();
    let cases = cases(&arguments)?;
    let (solver, models) = (Solver::new(), Models::default());
    let bar = bar(cases.len())?;
    let failures: Mutex<Vec<String>> = Mutex::default();
    let one = |case: &Case| {
        let scored = Scored::of(case, &solver, &models);
        bar.inc(1);
        match scored {
            Ok(scored) => {
                if arguments.verbose {
                    bar.suspend(|| println!("{}", scored.line()));
                }
                Some(scored)
            }
            Err(error) => {
                let line = format!("{} {}: {error}", case.design.name(), case.seed);
                bar.suspend(|| eprintln!("{line}"));
                failures.lock().unwrap_or_else(std::sync::PoisonError::into_inner).push(line);
                None
            }
        }
    };
    let scored: Vec<Scored> = cases.par_iter().filter_map(one).collect();
    bar.finish_and_clear();
    let failures = failures.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    let mut text = Score { list: &scored }.markdown();
    text.push_str(&format!(
        "\n{} cases in {:.0} min on {} threads, seeds from {}; {} could not be scored.\n",
        scored.len(),
        start.elapsed().as_secs_f64() / 60.0,
        rayon::current_num_threads(),
        arguments.first_seed,
        failures.len(),
    ));
    println!("{text}");
    if let Some(path) = &arguments.json {
        std::fs::write(path, serde_json::to_string_pretty(&record::records(&scored))?)?;
    }
    if arguments.write {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/hidden-effects.md");
        let document = std::fs::read_to_string(&path)?;
        std::fs::write(&path, replace_section(&document, "score", &text)?)?;
    }
    if failures.is_empty() { Ok(()) } else { Err(format!("{} cases could not be scored", failures.len()).into()) }
}

fn cases(arguments: &Arguments) -> Result<Vec<Case>, String> {
    let mut list = Vec::new();
    for design in &arguments.designs {
        let (count, first) = (arguments.cases, arguments.first_seed);
        list.extend(match &arguments.only {
            None => suite::cases(*design, count, first),
            Some(code) => {
                suite::cases_of(code, *design, count, first).ok_or_else(|| format!("--only {code}: no such code"))?
            }
        });
    }
    Ok(list)
}

fn bar(steps: usize) -> Result<ProgressBar, Box<dyn std::error::Error>> {
    let bar = ProgressBar::with_draw_target(Some(steps as u64), ProgressDrawTarget::stderr());
    let style = ProgressStyle::with_template("cases [{bar:30}] {pos:>3}/{len}, {per_sec}, {eta} left")?;
    bar.set_style(style.progress_chars("=> "));
    Ok(bar)
}
