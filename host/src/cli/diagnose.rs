//! `palpate diagnose`.

use std::path::PathBuf;

use clap::Args;

use crate::diagnose::{self, Diagnosis, Models, Verdict};
use crate::experiment;
use crate::report::number;

use super::progress::Progress;

/// What to diagnose, and how to tell it.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Folder with experiment.toml
    experiment: PathBuf,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
}

/// Reads, diagnoses, tells.
///
/// # Errors
/// Bad input, or a force model that fails.
pub fn run(arguments: &Arguments) -> miette::Result<()> {
    let experiment = experiment::read(&arguments.experiment)?;
    let progress = Progress::new();
    let models = Models::default();
    let found = diagnose::diagnose(&experiment, &models, &|what: &str, done, total| progress.set(what, done, total));
    progress.end();
    let found = found.map_err(|cause| miette::miette!("{cause}"))?;
    if arguments.json {
        match found.first() {
            Some(first) if found.len() == 1 => println!("{}", diagnose::answer::json(first, None)),
            _ => {
                let all: Vec<_> = found.iter().map(|one| diagnose::answer::json(one, None)).collect();
                println!("{}", serde_json::json!({ "materials": all }));
            }
        }
        return Ok(());
    }
    for one in &found {
        print(one);
    }
    Ok(())
}

fn print(found: &Diagnosis) {
    println!("material         {}", found.material);
    println!("verdict          {}", found.verdict.word());
    if let Some(reason) = &found.refusal {
        println!("because          {reason}");
    }
    for finding in &found.findings {
        let twins = if finding.ambiguous_with.is_empty() {
            String::new()
        } else {
            format!("  or {}", finding.ambiguous_with.join(", "))
        };
        println!("effect           {}{twins}", finding.code);
        for (name, value, (low, high)) in &finding.parameters {
            println!("  {name:16} {:10}  95 %: {} to {}", number(*value), number(*low), number(*high));
        }
    }
    if !found.shows_in.is_empty() {
        println!("shows in         {}", found.shows_in.join(", "));
    }
    println!("blind to         {}", found.blind_to.join(", "));
    let Some(evidence) = &found.evidence else { return };
    if let Some(held_out) = &evidence.held_out
        && found.verdict != Verdict::Unknown
    {
        println!(
            "held out         {} N before, {} N after",
            number(held_out.rmse_before_n),
            number(held_out.rmse_after_n)
        );
    }
    println!("solves           {} in {:.1} s", evidence.solves, found.seconds);
}
