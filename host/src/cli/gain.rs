//! `palpate gain`.

use std::path::PathBuf;

use clap::Args;
use miette::miette;

use crate::diagnose::Models;
use crate::experiment::{self, Experiment};
use crate::extended::ExtendedModel;
use crate::extended::gain::{self, Options};
use crate::simulate;

use super::progress::Progress;

/// What an extended model gains on a board.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Folder with experiment.toml
    experiment: PathBuf,
    /// Model file of `palpate diagnose --model`
    #[arg(long, value_name = "FILE")]
    model: PathBuf,
    /// What is true of a simulated experiment (`palpate simulate --truth`): errors are then relative to it
    #[arg(long, value_name = "FILE")]
    truth: Option<PathBuf>,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
}

/// Reads, makes tables, palpates, tells.
///
/// # Errors
/// Bad input, a failing solve.
pub fn run(arguments: &Arguments) -> miette::Result<()> {
    let experiment = experiment::read(&arguments.experiment)?;
    let model = ExtendedModel::read(&arguments.model)?;
    let mut options = Options::default();
    if let Some(file) = &arguments.truth {
        options.truth = Some(truth(&simulate::read(file)?, &experiment, &model.material)?);
    }
    let progress = Progress::new();
    let found = gain::gain(&experiment, &model, &options, &Models::default(), &|what: &str, done, total| {
        progress.set(what, done, total);
    });
    progress.end();
    let found = found.map_err(|cause| miette!("{cause}"))?;
    if arguments.json {
        println!("{}", found.json());
    } else {
        for line in found.lines() {
            println!("{line}");
        }
    }
    Ok(())
}

/// Modulus and exponent of the specimen that the material is of.
fn truth(spec: &simulate::Spec, experiment: &Experiment, material: &str) -> miette::Result<(f64, f64)> {
    let own = experiment.specimens.iter().filter(|s| s.material == material);
    let found = own.filter_map(|s| spec.specimen(&s.name)).next();
    let known: Vec<&str> = spec.specimens.iter().map(|s| s.name.as_str()).collect();
    let found = found.ok_or_else(|| {
        miette!(
            "--truth describes no specimen of {material}; expected one of the experiment's, found {}",
            known.join(", ")
        )
    })?;
    Ok((found.mu_mpa, found.alpha))
}
