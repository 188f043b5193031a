//! A thousand palpations of the demo at each rate: are the errors that the board states those it makes?
//!
//! `cargo run --release -p tests --example palpations [FIRST-SEED]` writes a section of docs/board.md; exits 1 if the demo's own rate misses
//! what is asked of it. Ten demos of a hundred palpations a rate, each with a seed of its own, through `palpate::demo::run`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use palpate::demo::{self, Options, Palpated};
use rayon::prelude::*;
use tests::document::{replace_section, table};
use tests::stated::{Comparison, Stated};

type Failure = Box<dyn std::error::Error + Send + Sync>;

/// Demos a rate, and palpations of each.
const DEMOS: u64 = 10;
const PALPATIONS: usize = 100;

/// First seed unless another is given.
const SEED: u64 = 7001;

const HEAD: [&str; 8] =
    ["rate", "foam", "palpations", "parameter", "within two errors", "stated error, median", "scatter", "bias"];

fn main() -> Result<ExitCode, Failure> {
    let seed = match std::env::args().nth(1) {
        Some(word) => word.parse().map_err(|_| format!("first seed: `{word}` is no whole number"))?,
        None => SEED,
    };
    let folder = tempfile::tempdir()?;
    let lut = folder.path().join("table.lut");
    std::fs::write(&lut, demo::demo_table(&|_| {})?)?;
    let (mut rows, mut met) = (Vec::new(), true);
    for rate_mm_s in [1.0, 2.0, 4.0] {
        let palpated = palpate(&lut, folder.path(), rate_mm_s, seed)?;
        let pooled = compare(&palpated, rate_mm_s, &mut rows);
        if rate_mm_s == Options::default().rate_mm_s {
            met = pooled.len() == 2 && pooled.iter().all(Comparison::accepted);
        }
    }
    let verdict = if met { "met" } else { "MISSED" };
    let text = format!(
        "{}\nAsked of the demo's rate, {} mm/s, all foams: 93 to 97 %, and an error of at most 1.5 times the scatter: {verdict}. Seeds {seed} to {}.\n",
        table(&HEAD, &rows),
        Options::default().rate_mm_s,
        seed + DEMOS - 1
    );
    println!("{text}");
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/board.md");
    std::fs::write(&path, replace_section(&std::fs::read_to_string(&path)?, "stated errors", &text)?)?;
    Ok(if met { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

fn palpate(lut: &Path, folder: &Path, rate_mm_s: f64, seed: u64) -> Result<Vec<Palpated>, Failure> {
    let demos: Result<Vec<Vec<Palpated>>, Failure> = (seed..seed + DEMOS)
        .into_par_iter()
        .map(|seed| {
            let out: PathBuf = folder.join(format!("{rate_mm_s}-{seed}"));
            let table = Some(lut.to_path_buf());
            let options = Options { palpations: PALPATIONS, rate_mm_s, seed, out, table, ..Options::default() };
            let summary = demo::run(&options, &|_| {})?;
            std::fs::remove_dir_all(&options.out)?;
            Ok(summary.palpated)
        })
        .collect();
    Ok(demos?.into_iter().flatten().collect())
}

/// Adds the rows of a rate, foam by foam and together; returns those together, mu and alpha.
fn compare(palpated: &[Palpated], rate_mm_s: f64, rows: &mut Vec<Vec<String>>) -> Vec<Comparison> {
    let mut names: Vec<&str> = palpated.iter().map(|p| p.truth.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    let mut pooled = Vec::new();
    for foam in names.into_iter().map(Some).chain([None]) {
        let of_foam = palpated.iter().filter(|p| foam.is_none_or(|name| name == p.truth));
        let all = of_foam.clone().count();
        let stated: Vec<[Stated; 2]> = of_foam.filter_map(Stated::of).collect();
        for (i, parameter) in ["mu", "alpha"].into_iter().enumerate() {
            let list: Vec<Stated> = stated.iter().map(|both| both[i]).collect();
            let Some(c) = Comparison::of(&list) else { continue };
            if foam.is_none() {
                pooled.push(c);
            }
            rows.push(vec![
                format!("{rate_mm_s} mm/s"),
                foam.unwrap_or("**all**").into(),
                format!("{} of {all}", c.count),
                parameter.into(),
                format!("{:.1} %", 100.0 * c.within_two),
                format!("{:.1} %, {:.2} of the scatter", 100.0 * c.error, c.ratio()),
                format!("{:.1} %", 100.0 * c.scatter),
                format!("{:+.1} %", 100.0 * c.bias),
            ]);
        }
    }
    pooled
}
