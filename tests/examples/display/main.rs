//! Scores the diagnosis of the display on hidden flaws: `cargo run --release -p tests --example display -- --cases 100`.
//!
//! `--cases` of each plan (100 unless stated), `--plan short|full|finger` one plan only, `--seed` moves the first seed, `--only NAME` hides
//! one effect (or `clean`) at all levels by turns, `--verbose` tells every case on a line, `--write` puts the tables into
//! docs/display-diagnosis.md.

use std::path::Path;
use std::time::Instant;

use tests::display::{Case, LEVELS, Plan, Scored, Tally, suite};
use tests::document::replace_section;

/// Seeds begin far from those that the diagnosis was developed on.
const FIRST_SEED: u64 = 70_000;

struct Arguments {
    cases: usize,
    plans: Vec<Plan>,
    seed: u64,
    only: Option<String>,
    verbose: bool,
    write: bool,
}

fn arguments(mut words: impl Iterator<Item = String>) -> Result<Arguments, String> {
    let mut out = Arguments {
        cases: 100,
        plans: vec![Plan::Short, Plan::Full, Plan::Finger],
        seed: FIRST_SEED,
        only: None,
        verbose: false,
        write: false,
    };
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or(format!("{word} needs a value"));
        match word.as_str() {
            "--cases" => out.cases = number(&value()?)?,
            "--seed" => out.seed = number(&value()?)? as u64,
            "--plan" => {
                out.plans = match value()?.as_str() {
                    "short" => vec![Plan::Short],
                    "full" => vec![Plan::Full],
                    "finger" => vec![Plan::Finger],
                    other => return Err(format!("--plan {other}: expected short, full or finger")),
                }
            }
            "--only" => out.only = Some(value()?),
            "--verbose" => out.verbose = true,
            "--write" => out.write = true,
            other => return Err(format!("unknown argument {other}")),
        }
    }
    Ok(out)
}

fn number(text: &str) -> Result<usize, String> {
    text.parse().map_err(|_| format!("{text} is not a whole number"))
}

fn cases(arguments: &Arguments, plan: Plan) -> Result<Vec<Case>, String> {
    let Some(only) = &arguments.only else {
        return Ok(suite(plan, arguments.cases, arguments.seed));
    };
    let seeds = (0..arguments.cases).map(|i| (i, Case::clean(plan, arguments.seed + i as u64)));
    if only == "clean" {
        return Ok(seeds.map(|(_, case)| case).collect());
    }
    let all: Vec<&'static str> = plan.hidden().iter().chain(plan.outside()).copied().collect();
    let name = *all.iter().find(|name| *name == only).ok_or(format!("--only {only}: no such effect"))?;
    Ok(seeds.map(|(i, case)| case.hiding(&[name], i % LEVELS)).collect())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments = arguments(std::env::args().skip(1))?;
    let start = Instant::now();
    let mut scored = Vec::new();
    for plan in &arguments.plans {
        for case in cases(&arguments, *plan)? {
            let one = Scored::of(&case)?;
            if arguments.verbose {
                println!("{}", one.line());
            }
            scored.push(one);
        }
    }
    let mut text = Tally { list: &scored }.markdown();
    let minutes = start.elapsed().as_secs_f64() / 60.0;
    text.push_str(&format!("{} cases in {minutes:.0} min, seeds from {}.\n", scored.len(), arguments.seed));
    println!("{text}");
    if arguments.write {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/display-diagnosis.md");
        let document = std::fs::read_to_string(&path)?;
        std::fs::write(&path, replace_section(&document, "score", &text)?)?;
    }
    Ok(())
}
