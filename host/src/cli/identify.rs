//! `palpate identify`.

use std::path::PathBuf;

use clap::Args;
use miette::{IntoDiagnostic, WrapErr};

use crate::experiment;
use crate::identify::{self, Identification};
use crate::report::{self, number};

use super::progress::Progress;

/// What to identify, and how to tell it.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Folder with experiment.toml
    experiment: PathBuf,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
    /// Folder of the HTML report with figures [default: out/identify; with --json none]
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
}

/// Reads, fits, reports.
///
/// # Errors
/// Bad input, a failing solve, or a report that cannot be written.
pub fn run(arguments: &Arguments) -> miette::Result<()> {
    let experiment = experiment::read(&arguments.experiment)?;
    let progress = Progress::new();
    let found = identify::identify(&experiment, &|what: &str, done, total| {
        progress.set(what, done, total);
    })?;
    for message in found.iter().flat_map(|one| &one.messages) {
        eprintln!("{message}");
    }
    let mut written = None;
    // People get the figures without asking; scripts say where they want them.
    let folder = arguments.report.clone().or_else(|| (!arguments.json).then(|| PathBuf::from("out/identify")));
    if found.is_empty() && !arguments.json {
        println!("outcome          nothing to identify: the experiment holds no indentation run into a soft specimen");
    }
    if let Some(folder) = &folder {
        let file = folder.join("report.html");
        report::identification::page(&experiment, &found)
            .write(&file)
            .into_diagnostic()
            .wrap_err_with(|| format!("cannot write the report to {}", file.display()))?;
        written = Some(file.display().to_string());
    }
    if arguments.json {
        println!("{}", identify::json(&experiment, &found, written.as_deref()));
    } else {
        for one in &found {
            print(one);
        }
        if let Some(file) = written {
            println!("report           {file}");
        }
    }
    Ok(())
}

fn print(found: &Identification) {
    println!("material         {}", found.material);
    println!("outcome          {}", found.outcome.word());
    let Some(fit) = &found.fit else { return };
    for parameter in &fit.parameters {
        println!(
            "{:16} {:10}  95 %: {} to {}{}",
            parameter.name,
            number(parameter.value),
            number(parameter.interval95.low),
            number(parameter.interval95.high),
            if parameter.at_bound { "  (on a bound)" } else { "" }
        );
    }
    println!("residual         {} N rms, noise {} N", number(fit.rmse_n), number(fit.noise.sigma_n));
    if let Some(check) = found.direct_check {
        println!("direct solve     within {} % of the model", number(100.0 * check));
    }
    println!("solves           {} in {:.1} s", found.fe_solves, found.seconds);
}
