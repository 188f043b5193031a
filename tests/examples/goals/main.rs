//! Measures the goals of the diagnosis on fresh cases, half of them ideal and half laboratory worlds:
//! `cargo run --release -p tests --example goals -- --cases 800 --seed 40000`.
//!
//! `--cases` is the number of all (80 unless stated), `--seed` the first of their seeds: choose one that was not
//! used before. A line a case, and the table at the end. 800 take about 90 minutes on two cores. `--only ideal` or
//! `--only laboratory` runs one half of them.

mod goals;

use std::time::Instant;

use goals::{Counted, of_ideal, of_world, table};
use palpate::diagnose::Models;
use palpate::simulate::Solver;
use tests::arguments::cases_and_seed;
use tests::hidden::{Case, Design};
use tests::laboratory::World;
use tests::laboratory::score::Scored as Judged;
use tests::score::cores::on_all_cores;
use tests::score::share::Yardstick;
use tests::score::{ScoreError, Scored, suite};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (words, only) = half(std::env::args().skip(1).collect())?;
    let (cases, first) = cases_and_seed(words.into_iter(), (80, 40_000))?;
    let start = Instant::now();
    let (solver, models) = (Solver::new(), Models::default());
    let yardstick = Yardstick { solver: &solver, models: &models };
    // as many of each design
    let each = (cases / 2).div_ceil(Design::ALL.len());
    let designs: &[Design] = if only == Some(Half::Laboratory) { &[] } else { &Design::ALL };
    let ideal: Vec<Case> = designs.iter().flat_map(|design| suite::cases(*design, each, first)).collect();
    let ideal = on_all_cores(&ideal, |case| {
        let scored = Scored::of(case, &solver, &models);
        told(scored.as_ref().map(Scored::line));
        scored
    });
    let worlds = if only == Some(Half::Ideal) { 0 } else { cases as u64 / 2 };
    let worlds: Vec<World> = (first..first + worlds).map(World::drawn).collect();
    let worlds = on_all_cores(&worlds, |world| {
        let judged = judged(world, &yardstick);
        told(judged.as_ref().map(|one| one.as_ref().map_or_else(|| "no world".to_owned(), Judged::line)));
        judged
    });
    let failed =
        ideal.iter().filter(|(_, one)| one.is_err()).count() + worlds.iter().filter(|(_, w)| w.is_err()).count();
    let ideal: Vec<Counted> = ideal.iter().filter_map(|(_, one)| one.as_ref().ok()).map(of_ideal).collect();
    let worlds: Vec<Counted> = worlds.iter().filter_map(|(_, one)| one.as_ref().ok()?.as_ref()).map(of_world).collect();
    println!("{}", table(&ideal, &worlds));
    println!(
        "{} ideal cases and {} laboratory worlds, seeds from {first}, in {:.0} min on {} threads; {failed} could not be scored.",
        ideal.len(),
        worlds.len(),
        start.elapsed().as_secs_f64() / 60.0,
        rayon::current_num_threads(),
    );
    if failed == 0 { Ok(()) } else { Err(format!("{failed} could not be scored").into()) }
}

/// One half of the cases.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Half {
    Ideal,
    Laboratory,
}

/// Takes `--only` out of the words.
fn half(mut words: Vec<String>) -> Result<(Vec<String>, Option<Half>), String> {
    let Some(at) = words.iter().position(|word| word == "--only") else { return Ok((words, None)) };
    let only = match words.get(at + 1).map(String::as_str) {
        Some("ideal") => Half::Ideal,
        Some("laboratory") => Half::Laboratory,
        _ => return Err("--only: expected ideal or laboratory".into()),
    };
    words.drain(at..=at + 1);
    Ok((words, Some(only)))
}

fn judged(world: &World, yardstick: &Yardstick<'_>) -> Result<Option<Judged>, ScoreError> {
    match world.make(yardstick)? {
        Some(made) => Judged::of(world, &made, yardstick).map(Some),
        None => Ok(None),
    }
}

/// One line a case, so that nothing is lost when the run is.
fn told(line: Result<String, &ScoreError>) {
    match line {
        Ok(line) => println!("{line}"),
        Err(error) => eprintln!("{error}"),
    }
}
