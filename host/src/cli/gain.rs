//! `palpate gain`.

use std::path::{Path, PathBuf};

use clap::Args;
use miette::{IntoDiagnostic, WrapErr, miette};

use crate::diagnose::Models;
use crate::experiment::section::{Document, Section};
use crate::experiment::{self, Experiment};
use crate::extended::ExtendedModel;
use crate::extended::display::{DisplayModel, Gain};
use crate::extended::gain::{self, Options};
use crate::extended::magnet::MagnetModel;
use crate::report::{self, number};

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
    /// Folder of an HTML report
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
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
    let text = experiment::text_of(&arguments.model)?;
    if DisplayModel::is_one(&text) {
        without_truth(arguments)?;
        return of_display(arguments, &experiment, &DisplayModel::parse(&arguments.model, &text)?);
    }
    if MagnetModel::is_one(&text) {
        without_truth(arguments)?;
        return of_magnet(arguments, &experiment, &MagnetModel::parse(&arguments.model, &text)?);
    }
    let model = ExtendedModel::read(&arguments.model)?;
    let mut options = Options::default();
    if let Some(file) = &arguments.truth {
        options.truth = Some(truth(file, &experiment, &model.material)?);
    }
    let progress = Progress::new();
    let found = gain::gain(&experiment, &model, &options, &Models::kept(), &|what: &str, done, total| {
        progress.set(what, done, total);
    });
    progress.end();
    let found = found.map_err(|cause| miette!("{cause}"))?;
    let written = written(arguments, || report::gain::page(&found))?;
    if arguments.json {
        let mut answer = found.json();
        answer["report"] = serde_json::json!(written);
        outln!("{answer}");
    } else {
        for line in found.lines() {
            outln!("{line}");
        }
        if let Some(file) = written {
            outln!("{:24} {file}", "report");
        }
    }
    Ok(())
}

/// Refuses a truth beside a model that is not of a material.
fn without_truth(arguments: &Arguments) -> miette::Result<()> {
    match &arguments.truth {
        Some(file) => Err(miette!(
            "--truth {}: {} is not the model of a material, whose modulus and exponent a truth is of; leave it out",
            file.display(),
            arguments.model.display()
        )),
        None => Ok(()),
    }
}

/// What a display's model gains: the error of its predictions beside that of the base law.
fn of_display(arguments: &Arguments, experiment: &Experiment, model: &DisplayModel) -> miette::Result<()> {
    let found = model.gain(experiment).map_err(|cause| miette!("{cause}"))?;
    let written = written(arguments, || report::display::gain::page(&found))?;
    if arguments.json {
        let channels: Vec<_> = found.iter().map(Gain::json).collect();
        outln!("{}", serde_json::json!({ "channels": channels, "report": written }));
        return Ok(());
    }
    for line in report::display::gain::lines(&found) {
        outln!("{line}");
    }
    if let Some(file) = written {
        outln!("{:16} {file}", "report");
    }
    Ok(())
}

/// Writes the page where one is wanted; its file.
fn written(arguments: &Arguments, page: impl FnOnce() -> report::Page) -> miette::Result<Option<String>> {
    let Some(folder) = &arguments.report else { return Ok(None) };
    let file = folder.join("report.html");
    let cannot = || format!("cannot write the report to {}", file.display());
    page().write(&file).into_diagnostic().wrap_err_with(cannot)?;
    Ok(Some(file.display().to_string()))
}

/// What a magnet's model gains: its predictions beside those of the magnet as drawn, whose zero is fitted to these readings.
fn of_magnet(arguments: &Arguments, experiment: &Experiment, model: &MagnetModel) -> miette::Result<()> {
    let found = model.gain(experiment).map_err(|cause| miette!("{cause}"))?;
    let written = written(arguments, || report::magnet::gain(&model.magnet, &found))?;
    if arguments.json {
        outln!("{}", serde_json::json!({ "magnet": found.json(), "report": written }));
        return Ok(());
    }
    outln!(
        "{:24} {} T rms as drawn with a zero fitted to these readings, {} T by the model as it is ({} readings)",
        model.magnet,
        number(found.fitted_base_t),
        number(found.model_t),
        found.readings
    );
    if let Some(file) = written {
        outln!("{:24} {file}", "report");
    }
    Ok(())
}

/// Modulus (MPa) and exponent of the specimen that the material is of, from the truth of a simulation.
fn truth(file: &Path, experiment: &Experiment, material: &str) -> miette::Result<(f64, f64)> {
    let text = experiment::text_of(file)?;
    let document = Document { file, text: &text };
    let root = document.table()?;
    let root = Section::new(document, "the file".to_owned(), 0..0, root.get_ref());
    let mut known = Vec::new();
    for (name, section) in root.named("specimen")? {
        if experiment.specimens.iter().any(|s| s.name == name && s.material == material) {
            let number = |key, range, expected| -> miette::Result<f64> {
                Ok(section.number(key, range, expected)?.ok_or_else(|| section.missing(key, expected))?)
            };
            return Ok((
                number("mu_MPa", 1e-6..=1e4, "a shear modulus")?,
                number("alpha", -50.0..=50.0, "an exponent")?,
            ));
        }
        known.push(name);
    }
    let place = file.display();
    Err(miette!(
        "{place} describes no specimen of {material}; expected one of the experiment's, found {}",
        known.join(", ")
    ))
}
