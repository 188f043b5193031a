//! `palpate lut sweep` and `palpate lut merge`.

mod table;

use std::num::NonZero;
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::{Args, Subcommand};
use lut_gen::sweep::{self as sweeps, JournalHead, Shard};
use miette::IntoDiagnostic;
use serde_json::{Value, json};

use crate::report::number;
use crate::sweep::{Folder, SweepError, journals, read};

use super::file::save;
use super::progress::Countdown;
use table::{described, extent, failures, hex, print};
pub(super) use table::{explain, is_table};

/// Tables over any number of parameters.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Solve the points of a sweep; a run that was ended continues
    Sweep(SweepArguments),
    /// Make one table from the journals of all shards
    Merge(MergeArguments),
}

/// What to solve, and where to keep it.
#[derive(Debug, Args)]
pub struct SweepArguments {
    /// Description of the sweep: law, axes, motion (docs/experiment.md)
    #[arg(value_name = "SPEC.toml")]
    spec: PathBuf,
    /// Folder for the journal; shards may share it
    #[arg(long, value_name = "DIR", default_value = "out/sweep")]
    out: PathBuf,
    /// Solve part I of N only
    #[arg(long, value_name = "I/N", default_value_t = Shard::WHOLE)]
    shard: Shard,
    /// Points solved at once; as many as there are cores by default
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Solve points again that have failed
    #[arg(long)]
    retry_failed: bool,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
}

/// What to merge.
#[derive(Debug, Args)]
pub struct MergeArguments {
    /// Description of the sweep
    #[arg(value_name = "SPEC.toml")]
    spec: PathBuf,
    /// Folders with journals, or journals
    #[arg(value_name = "DIR", required = true)]
    folders: Vec<PathBuf>,
    /// File to write
    #[arg(short, long, value_name = "FILE", default_value = "out/sweep.lut")]
    out: PathBuf,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
}

/// Runs one of the two commands.
///
/// # Errors
/// A description with a mistake, files of another sweep, damaged or busy ones, points that nobody has solved.
pub fn run(command: &Command) -> miette::Result<()> {
    match command {
        Command::Sweep(arguments) => sweep(arguments),
        Command::Merge(arguments) => merge(arguments),
    }
}

fn sweep(arguments: &SweepArguments) -> miette::Result<()> {
    let spec = read(&arguments.spec)?;
    let engine = sweeps::engine(&spec);
    let head = JournalHead { spec: spec.clone(), engine, shard: arguments.shard };
    let Folder { mut keeper, done, cut } = Folder::open(&arguments.out, &head).into_diagnostic()?;
    if cut > 0 {
        errln!("{cut} bytes of a record that was not finished were cut off {}", keeper.path().display());
    }
    if !keeper.locked {
        errln!("{}: no locks on this file system; do not run one shard twice at a time", keeper.path().display());
    }
    let mine = (0..spec.jobs()).filter(|job| arguments.shard.holds(*job));
    let (before, jobs): (Vec<usize>, Vec<usize>) = mine.partition(|job| match done.get(job) {
        Some(solved) => *solved || !arguments.retry_failed,
        None => false,
    });
    let cores = std::thread::available_parallelism().map_or(1, NonZero::get);
    let threads = arguments.threads.map_or(cores, usize::from);
    let start = Instant::now();
    let mut countdown = Countdown::new(&spec.name, jobs.len());
    let mut failed: Vec<(usize, String)> = Vec::new();
    let solve = |point: &sweeps::Point| sweeps::solve_point(&spec, point);
    sweeps::run(&spec, &jobs, threads, &solve, |finished| {
        keeper.keep(&finished)?;
        if let Err(text) = finished.outcome {
            failed.push((finished.job, text));
        }
        countdown.step(failed.len());
        Ok::<(), SweepError>(())
    })
    .into_diagnostic()?;
    keeper.finish().into_diagnostic()?;
    countdown.end();
    failed.sort();
    let outcome = Outcome {
        head: &head,
        journal: keeper.path(),
        before: before.len(),
        failed_before: before.iter().filter(|job| done.get(job) == Some(&false)).count(),
        solved: jobs.len() - failed.len(),
        failed: &failed,
        seconds: start.elapsed().as_secs_f64(),
        threads,
    };
    if arguments.json {
        outln!("{}", outcome.json())
    } else {
        outcome.print(arguments)
    }
    Ok(())
}

/// What came of a run.
struct Outcome<'a> {
    head: &'a JournalHead,
    journal: &'a Path,
    before: usize,
    failed_before: usize,
    solved: usize,
    failed: &'a [(usize, String)],
    seconds: f64,
    threads: usize,
}

impl Outcome<'_> {
    fn json(&self) -> Value {
        json!({
            "journal": self.journal.display().to_string(), "identity": hex(&self.head.identity()),
            "engine": self.head.engine, "shard": self.head.shard.to_string(), "points": self.head.spec.jobs(),
            "before": self.before, "failed_before": self.failed_before, "solved": self.solved,
            "failed": failures(&self.head.spec, self.failed.iter().map(|(job, text)| (*job, text))),
            "seconds": self.seconds, "threads": self.threads,
        })
    }

    fn print(&self, arguments: &SweepArguments) {
        let spec = &self.head.spec;
        outln!("sweep       {}: {}", spec.name, extent(spec));
        outln!("shard       {}, {} points done before", self.head.shard, self.before);
        outln!("engine      {}", self.head.engine);
        let ended = self.solved + self.failed.len();
        let rate =
            if ended > 0 { format!(", {} a second", number(ended as f64 / self.seconds)) } else { String::new() };
        outln!("solved      {} in {:.1} s on {} threads{rate}", self.solved, self.seconds, self.threads);
        for (job, text) in self.failed {
            outln!("failed      point {job} ({}): {text}", spec.label(*job));
        }
        if self.failed_before > 0 {
            outln!("failed      {} points of earlier runs; --retry-failed solves them again", self.failed_before);
        }
        outln!("journal     {}", self.journal.display());
        outln!("next        palpate lut merge {} {}", arguments.spec.display(), arguments.out.display());
    }
}

fn merge(arguments: &MergeArguments) -> miette::Result<()> {
    let spec = read(&arguments.spec)?;
    let mut found = Vec::new();
    for folder in &arguments.folders {
        let here = journals(folder).into_diagnostic()?;
        if here.is_empty() {
            return Err(SweepError::Empty(folder.clone())).into_diagnostic();
        }
        found.extend(here.into_iter().map(|f| (f.path.display().to_string(), f.journal)));
    }
    for (name, journal) in found.iter().filter(|(_, journal)| journal.torn > 0) {
        errln!("{name}: {} bytes after its last whole record are left out", journal.torn);
    }
    let seconds: f64 = found.iter().map(|(_, journal)| journal.seconds).sum();
    let table = sweeps::merge(&spec, &found).map_err(SweepError::from).into_diagnostic()?;
    let bytes = table.bytes();
    save(&arguments.out, &bytes)?;
    if arguments.json {
        let mut answer = described(&table, &bytes);
        answer["file"] = json!(arguments.out.display().to_string());
        answer["solve_seconds"] = json!(seconds);
        outln!("{answer}");
    } else {
        print(&table, &bytes);
        outln!("solves      {} s in all, of {} journals", number(seconds), found.len());
        outln!("table       {}", arguments.out.display());
    }
    Ok(())
}
