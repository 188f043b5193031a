//! Six parameters of liver from noise seeds: `cargo run --release -p tests --example liver -- FROM TO [direct]`.
//!
//! Solves and answers are kept in `target/liver`, so that a study goes on where it ended. With `direct` every fit solves for itself, as
//! `palpate identify` does; otherwise all fits share the solves of one table.

use std::io::Write;
use std::path::Path;
use std::sync::Arc;

use palpate::experiment::Experiment;
use palpate::identify::newton::condition::{Condition, Source};
use palpate::identify::newton::table::Table;
use palpate::identify::{identify, identify_from};
use palpate::simulate::Solver;
use rayon::prelude::*;
use tests::liver::judge::profiles;
use tests::liver::table::table;
use tests::liver::{TRUTH, experiment};
use tests::tissue::{recovered, six};

const KEPT: &str = "target/liver";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let mut whole = |otherwise: u64| arguments.next().map_or(Ok(otherwise), |text| text.parse());
    let (from, to) = (whole(0)?, whole(100)?);
    let direct = std::env::args().any(|word| word == "direct");
    let kept = Path::new(KEPT);
    std::fs::create_dir_all(kept)?;
    let solver = Solver::new();
    let (table, worst) =
        table(&experiment(0, &solver)?, &kept.join("solves.txt"), &|count| eprintln!("{count} solves"))?;
    println!("table within {:.3} % of the peak force at solves it does not hold", 100.0 * worst);
    let answers = kept.join(if direct { "direct.txt" } else { "table.txt" });
    let known = std::fs::read_to_string(&answers).unwrap_or_default();
    let is_known = |seed: u64| known.lines().any(|line| line.split(' ').next() == Some(&seed.to_string()));
    let left: Vec<u64> = (from..to).filter(|seed| !is_known(*seed)).collect();
    for part in left.chunks(if direct { 1 } else { 4 }) {
        let made: Vec<(u64, Experiment)> = part
            .iter()
            .map(|seed| Ok((*seed, experiment(*seed, &solver)?)))
            .collect::<Result<_, Box<dyn std::error::Error>>>()?;
        let lines: Vec<String> =
            made.par_iter().map(|(seed, experiment)| answer(*seed, experiment, &table, direct)).collect();
        let mut file = std::fs::OpenOptions::new().create(true).append(true).open(&answers)?;
        for line in &lines {
            print!("{line}");
            file.write_all(line.as_bytes())?;
        }
    }
    summary(&std::fs::read_to_string(&answers)?, from..to);
    Ok(())
}

/// One line a parameter: seed, outcome, name, value, interval, standing, interval of the judge, whether it identifies, solves, seconds.
fn answer(seed: u64, experiment: &Experiment, table: &Arc<Table>, direct: bool) -> String {
    let source = |_: &Condition| Source::Table(table.clone());
    let found = if direct {
        identify(experiment, &six(), &|_, _, _| {}).map(|mut all| all.swap_remove(0))
    } else {
        identify_from(experiment, "specimen", &six(), &source)
    };
    let found = match found {
        Ok(found) => found,
        Err(cause) => return format!("{seed} failed {cause}\n"),
    };
    let judged = profiles(experiment, table);
    let lines = recovered(&found, &TRUTH).into_iter().zip(&judged).map(|(p, profile)| {
        let standing = p.standing.map_or("none", |standing| standing.word());
        format!(
            "{seed} {} {} {:.6e} {:.6e} {:.6e} {standing} {:.6e} {:.6e} {} {} {:.1}\n",
            found.outcome.word(),
            p.name,
            p.value,
            p.interval.0,
            p.interval.1,
            profile.interval.0,
            profile.interval.1,
            profile.identifies(),
            found.fe_solves,
            found.seconds
        )
    });
    lines.collect()
}

/// The table of all answers.
fn summary(text: &str, seeds: std::ops::Range<u64>) {
    let rows: Vec<Vec<&str>> = text
        .lines()
        .map(|line| line.split(' ').collect::<Vec<_>>())
        .filter(|row| row.len() == 12 && row[0].parse().is_ok_and(|seed| seeds.contains(&seed)))
        .collect();
    let number = |row: &[&str], at: usize| row[at].parse::<f64>().unwrap_or(f64::NAN);
    let holds = |row: &[&str], low: usize, truth: f64| (number(row, low)..=number(row, low + 1)).contains(&truth);
    println!(
        "| | holds | judge's holds | identified | in combination | not identifiable | judge identifies | agree | median interval |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    let (mut held, mut all) = (0, 0);
    for (name, truth) in TRUTH.named() {
        let own: Vec<&Vec<&str>> = rows.iter().filter(|row| row[2] == name).collect();
        let count = |of: &dyn Fn(&[&str]) -> bool| own.iter().filter(|row| of(row)).count();
        let standing = |word: &'static str| count(&|row| row[6] == word);
        let mut widths: Vec<f64> = own.iter().map(|row| (number(row, 5) - number(row, 4)) / truth).collect();
        widths.sort_by(f64::total_cmp);
        let holding = count(&|row| holds(row, 4, truth));
        (held, all) = (held + holding, all + own.len());
        println!(
            "| {name} | {holding} | {} | {} | {} | {} | {} | {} | {:.3} of the truth |",
            count(&|row| holds(row, 7, truth)),
            standing("identified"),
            standing("in-combination"),
            standing("not-identifiable"),
            count(&|row| row[9] == "true"),
            count(&|row| (row[9] == "true") == (row[6] == "identified")),
            widths.get(widths.len() / 2).copied().unwrap_or(f64::NAN)
        );
    }
    println!(
        "pooled: {held} of {all} intervals hold the truth, {:.1} %",
        100.0 * held as f64 / f64::from(u32::try_from(all).unwrap_or(1).max(1))
    );
    for outcome in ["fitted", "outside-grid"] {
        println!("{outcome}: {}", rows.iter().filter(|row| row[2] == "alpha" && row[1] == outcome).count());
    }
}
