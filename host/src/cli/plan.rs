//! `palpate plan`.

use std::path::PathBuf;

use clap::Args;

use crate::diagnose::plan::Proposal;
use crate::diagnose::{self, Diagnosis, Models};
use crate::experiment;
use crate::report::number;

use super::progress::Progress;

/// What to plan for, and how to tell it.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Folder with experiment.toml
    experiment: PathBuf,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
}

/// Reads, diagnoses, and ranks the runs that could be made next.
///
/// # Errors
/// Bad input, or a force model that fails.
pub fn run(arguments: &Arguments) -> miette::Result<()> {
    let experiment = experiment::read(&arguments.experiment)?;
    let progress = Progress::new();
    let found = diagnose::diagnose(&experiment, &Models::kept(), &|what: &str, done, total| {
        progress.set(what, done, total);
    });
    progress.end();
    let found = found.map_err(|cause| miette::miette!("{cause}"))?;
    if arguments.json {
        let each: Vec<serde_json::Value> = found.iter().map(diagnose::answer::plan).collect();
        match each.as_slice() {
            [only] => outln!("{only}"),
            all => outln!("{}", serde_json::json!({ "materials": all })),
        }
        return Ok(());
    }
    if found.is_empty() {
        outln!("nothing to plan for: the experiment holds no run that indents a soft specimen");
    }
    for one in &found {
        print(one);
    }
    Ok(())
}

fn print(found: &Diagnosis) {
    outln!("material         {}", found.material);
    outln!("verdict          {}", found.verdict.word());
    if let Some(refusal) = &found.refusal {
        outln!("because          {refusal}");
    }
    for finding in &found.findings {
        let rivals: String = finding.ambiguous_with.iter().map(|code| format!(" or {code}")).collect();
        outln!("effect           {}{rivals}", finding.code);
    }
    if found.proposals.is_empty() {
        outln!("next run         none that this tool can compute would decide or show anything more");
    }
    for (rank, proposal) in found.proposals.iter().enumerate() {
        print_proposal(rank + 1, proposal);
    }
    for text in &found.cancelling {
        outln!("cannot exclude   {text}");
    }
}

fn print_proposal(rank: usize, proposal: &Proposal) {
    outln!("{rank}. {}", proposal.what);
    outln!("   would tell    {} ({} standard deviations)", proposal.decides.join(", "), number(proposal.distance));
}
