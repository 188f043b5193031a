//! Measures the goals of the diagnosis on fresh cases, half of them ideal and half laboratory worlds:
//! `cargo run --release -p tests --example goals -- --cases 800 --seed 40000`.
//!
//! `--cases` is the number of all (80 unless stated), `--seed` the first of their seeds: choose one that was not
//! used before. A line a case, and the table at the end. 800 take about 90 minutes on two cores. `--only ideal` or
//! `--only laboratory` runs one half of them. `--keep FILE` keeps each case in a file, and goes on there: with the same
//! build only.

mod goals;
mod kept;

use std::path::Path;
use std::time::Instant;

use goals::{Counted, of_ideal, of_world, table};
use kept::Kept;
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
    let mut words: Vec<String> = std::env::args().skip(1).collect();
    let only = half(taken(&mut words, "--only")?.as_deref())?;
    let kept = Kept::open(taken(&mut words, "--keep")?.as_deref().map(Path::new))?;
    let (cases, first) = cases_and_seed(words.into_iter(), (80, 40_000))?;
    let start = Instant::now();
    let (solver, models) = (Solver::new(), Models::default());
    let yardstick = Yardstick { solver: &solver, models: &models };
    // as many of each design
    let each = (cases / 2).div_ceil(Design::ALL.len());
    let designs: &[Design] = if only == Some(Half::Laboratory) { &[] } else { &Design::ALL };
    let ideal: Vec<Case> = designs.iter().flat_map(|design| suite::cases(*design, each, first)).collect();
    let named: Vec<(String, &Case)> = ideal
        .iter()
        .enumerate()
        .map(|(i, case)| (format!("ideal {i} {} {}", case.design.name(), case.seed), case))
        .collect();
    let ideal = on_all_cores(&named, |(name, case)| {
        let counted = kept.of(name.clone(), || {
            let scored = Scored::of(case, &solver, &models)?;
            println!("{}", scored.line());
            Ok(Some(of_ideal(&scored)))
        });
        told(counted)
    });
    let worlds = if only == Some(Half::Ideal) { 0 } else { cases as u64 / 2 };
    let worlds: Vec<World> = (first..first + worlds).map(World::drawn).collect();
    let worlds = on_all_cores(&worlds, |world| {
        let counted = kept.of(format!("laboratory {} {}", world.design.name(), world.seed), || {
            let judged = judged(world, &yardstick)?;
            println!("{}", judged.as_ref().map_or_else(|| "no world".to_owned(), Judged::line));
            Ok(judged.as_ref().map(of_world))
        });
        told(counted)
    });
    let failed = [&ideal, &worlds].into_iter().flatten().filter(|(_, one)| one.is_none()).count();
    let [ideal, worlds] =
        [ideal, worlds].map(|half| -> Vec<Counted> { half.into_iter().filter_map(|(_, one)| one?).collect() });
    println!("{}", table(&ideal, &worlds));
    println!(
        "{} ideal cases and {} laboratory worlds, seeds from {first}, in {:.0} min on {} threads, {} of them kept from before; \
         {failed} could not be scored.",
        ideal.len(),
        worlds.len(),
        start.elapsed().as_secs_f64() / 60.0,
        rayon::current_num_threads(),
        kept.len(),
    );
    if failed == 0 { Ok(()) } else { Err(format!("{failed} could not be scored").into()) }
}

/// What counts, without an error that is told; `None` then.
fn told(counted: Result<Option<Counted>, ScoreError>) -> Option<Option<Counted>> {
    counted.inspect_err(|error| eprintln!("{error}")).ok()
}

/// Takes an option and its value out of the words.
fn taken(words: &mut Vec<String>, name: &str) -> Result<Option<String>, String> {
    let Some(at) = words.iter().position(|word| word == name) else { return Ok(None) };
    if at + 1 == words.len() {
        return Err(format!("{name} needs a value"));
    }
    let value = words.drain(at..=at + 1).next_back();
    Ok(value)
}

/// One half of the cases.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Half {
    Ideal,
    Laboratory,
}

fn half(name: Option<&str>) -> Result<Option<Half>, String> {
    match name {
        None => Ok(None),
        Some("ideal") => Ok(Some(Half::Ideal)),
        Some("laboratory") => Ok(Some(Half::Laboratory)),
        Some(other) => Err(format!("--only {other}: expected ideal or laboratory")),
    }
}

fn judged(world: &World, yardstick: &Yardstick<'_>) -> Result<Option<Judged>, ScoreError> {
    match world.make(yardstick)? {
        Some(made) => Judged::of(world, &made, yardstick).map(Some),
        None => Ok(None),
    }
}
