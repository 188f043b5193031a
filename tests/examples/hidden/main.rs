//! Scores the diagnosis on experiments with hidden effects: `cargo run --release -p tests --example hidden -- --cases 100`.
//!
//! Without `--design` all four designs are scored, with `--cases` of each (100 unless stated). `--only CODE` scores one code, or several with commas between them ("clean",
//! "matched", "mismatched", "pairs", "placebos", "deleted" or an effect) at all levels by turns, `--seed` moves the first seed, `--skip` leaves
//! out the first cases of each design, `--these 20003,20027` all but those seeds, `--verbose` tells every case on a line, `--json FILE` writes every case, `--folders FOLDER` every experiment, `--write` puts the tables into docs/hidden-effects.md.

mod arguments;
mod record;

use std::path::Path;
use std::time::Instant;

use arguments::Arguments;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use palpate::diagnose::Models;
use palpate::simulate::Solver;
use tests::document::replace_section;
use tests::hidden::Case;
use tests::score::{Scored, cores::on_all_cores, suite, table::Score};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments = Arguments::parse(std::env::args().skip(1))?;
    let start = Instant::now();
    let cases = cases(&arguments)?;
    let (solver, models) = (Solver::new(), Models::default());
    if let Some(folder) = &arguments.folders {
        for case in &cases {
            case.make(&solver)?.write(&folder.join(format!("{}-{}", case.design.name(), case.seed)))?;
        }
    }
    let bar = bar(cases.len())?;
    let mut scored: Vec<(usize, Scored)> = Vec::new();
    let mut failures: Vec<String> = Vec::new();
    let results = on_all_cores(&cases, |case| {
        let result = Scored::of(case, &solver, &models);
        bar.inc(1);
        if let (true, Ok(scored)) = (arguments.verbose, &result) {
            bar.suspend(|| println!("{}", scored.line()));
        }
        result
    });
    for (at, result) in results {
        match result {
            Ok(one) => scored.push((at, one)),
            Err(error) => failures.push(format!("{} {}: {error}", cases[at].design.name(), cases[at].seed)),
        }
    }
    bar.finish_and_clear();
    failures.iter().for_each(|line| eprintln!("{line}"));
    scored.sort_by_key(|(at, _)| *at);
    let scored: Vec<Scored> = scored.into_iter().map(|(_, one)| one).collect();
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
        let of = |code: &str| {
            suite::cases_of(code, *design, count, first).ok_or_else(|| format!("--only {code}: no such code"))
        };
        let suites = match &arguments.only {
            None => vec![suite::cases(*design, count, first)],
            Some(codes) => codes.split(',').map(of).collect::<Result<_, _>>()?,
        };
        let wanted = |case: &Case| arguments.these.is_empty() || arguments.these.contains(&case.seed);
        list.extend(suites.into_iter().flat_map(|suite| suite.into_iter().skip(arguments.skip)).filter(wanted));
    }
    Ok(list)
}

fn bar(steps: usize) -> Result<ProgressBar, Box<dyn std::error::Error>> {
    let bar = ProgressBar::with_draw_target(Some(steps as u64), ProgressDrawTarget::stderr());
    let style = ProgressStyle::with_template("cases [{bar:30}] {pos:>3}/{len}, {per_sec}, {eta} left")?;
    bar.set_style(style.progress_chars("=> "));
    Ok(bar)
}
