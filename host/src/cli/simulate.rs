//! `palpate simulate`.

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use miette::{IntoDiagnostic, miette};
use serde_json::{Value, json};

use crate::experiment;
use crate::extended::{ExtendedModel, truth};
use crate::report::number;
use crate::simulate::effect::Setting;
use crate::simulate::{self, Effect, SimulatedExperiment, Solver, display};

use super::progress::Progress;

/// An experiment folder from a model with hidden effects.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Specification (TOML); print one with --example
    #[arg(required_unless_present_any = ["example", "example_display"])]
    spec: Option<PathBuf>,
    /// Folder for experiment.toml and one CSV a run
    #[arg(long, value_name = "FOLDER", required_unless_present_any = ["example", "example_display"])]
    out: Option<PathBuf>,
    /// Model file of `palpate diagnose --model`: its material for every foam of the specification, and its effects
    #[arg(long, value_name = "FILE")]
    model: Option<PathBuf>,
    /// Write what is true into a file, which must not lie in the folder
    #[arg(long, value_name = "FILE")]
    truth: Option<PathBuf>,
    /// Seed instead of the specification's
    #[arg(long, value_name = "NUMBER")]
    seed: Option<u64>,
    /// Print a commented specification and end
    #[arg(long)]
    example: bool,
    /// Print a commented specification of a display experiment and end
    #[arg(long)]
    example_display: bool,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
}

/// Reads, simulates, writes.
///
/// # Errors
/// Bad input, a failing solve, a folder that cannot be written.
pub fn run(arguments: &Arguments) -> miette::Result<()> {
    if arguments.example {
        crate::print::out(format_args!("{}", simulate::EXAMPLE));
        return Ok(());
    }
    if arguments.example_display {
        crate::print::out(format_args!("{}", display::EXAMPLE));
        return Ok(());
    }
    let (Some(file), Some(folder)) = (&arguments.spec, &arguments.out) else {
        return Err(miette!("a specification and --out FOLDER are needed"));
    };
    if let Some(truth) = &arguments.truth
        && std::path::absolute(truth).into_diagnostic()?.starts_with(std::path::absolute(folder).into_diagnostic()?)
    {
        return Err(miette!(
            "--truth {} lies in the folder {}; expected a place outside of it",
            truth.display(),
            folder.display()
        ));
    }
    let text = experiment::text_of(file)?;
    // Before anything is solved for a place that is not to be written to.
    let check_places = || -> miette::Result<()> {
        simulate::check_folder(folder).into_diagnostic()?;
        match &arguments.truth {
            Some(truth) => crate::ownership::check_file(truth, TRUTH.as_bytes(), "--truth").into_diagnostic(),
            None => Ok(()),
        }
    };
    if display::is_display(&text) {
        let spec = display::parse(file, &text)?;
        check_places()?;
        return run_display(arguments, spec, &text, folder);
    }
    let started = Instant::now();
    let mut spec = simulate::parse(file, &text)?;
    check_places()?;
    if let Some(file) = &arguments.model {
        let model = ExtendedModel::read(file)?;
        for sentence in truth::apply(&model, &mut spec).into_diagnostic()? {
            errln!("{sentence}");
        }
    }
    spec.seed = arguments.seed.unwrap_or(spec.seed);
    let progress = Progress::new();
    let solver = Solver::new();
    let made = simulate::simulate(&spec, &solver, &|what, done, total| progress.set(what, done, total));
    progress.end();
    let made = made.into_diagnostic()?;
    made.write(folder).into_diagnostic()?;
    if let Some(truth) = &arguments.truth {
        save_truth(truth, &made.truth_toml())?;
    }
    let seconds = started.elapsed().as_secs_f64();
    if arguments.json {
        outln!("{}", summary(&made, folder.display().to_string(), seconds));
    } else {
        print(&made, &folder.display().to_string(), seconds);
    }
    Ok(())
}

/// First line of a file that says what is true: it tells such a file from any other, which is not replaced.
const TRUTH: &str = "# What is true in an experiment of palpate simulate.\n";

fn save_truth(file: &Path, text: &str) -> miette::Result<()> {
    crate::ownership::write_file(file, format!("{TRUTH}{text}").as_bytes(), "--truth").into_diagnostic()
}

/// Writes an experiment with a display.
fn run_display(arguments: &Arguments, mut spec: display::DisplaySpec, text: &str, folder: &Path) -> miette::Result<()> {
    spec.seed = arguments.seed.unwrap_or(spec.seed);
    spec.write(folder).into_diagnostic()?;
    if let Some(truth) = &arguments.truth {
        save_truth(truth, text)?;
    }
    let runs: usize = spec.runs.iter().map(|run| run.replicates).sum();
    let codes: Vec<&str> = spec.effects.iter().map(|effect| effect.code()).collect();
    let folder = folder.display().to_string();
    if arguments.json {
        outln!("{}", json!({ "folder": folder, "name": spec.name, "seed": spec.seed, "runs": runs, "effects": codes }));
    } else {
        outln!("experiment       {}, seed {}", spec.name, spec.seed);
        outln!("runs             {runs} of a display");
        outln!("effects          {}", if codes.is_empty() { "none".to_owned() } else { codes.join(", ") });
        outln!("folder           {folder}");
    }
    Ok(())
}

/// What was made, for scripts.
fn summary(made: &SimulatedExperiment, folder: String, seconds: f64) -> Value {
    let effects: Vec<Value> = made.truth.effects.iter().map(effect).collect();
    json!({
        "folder": folder,
        "name": made.name,
        "seed": made.truth.seed,
        "runs": made.runs.len(),
        "samples": made.runs.iter().map(|run| run.time_s.len()).sum::<usize>(),
        "peak_N": peak_n(made),
        "effects": effects,
        "fe_solves": made.solves,
        "seconds": seconds,
    })
}

fn effect(effect: &Effect) -> Value {
    let value = |setting: Setting| match setting {
        Setting::Number(number) => json!(number),
        Setting::Word(word) => json!(word),
    };
    let parameters: serde_json::Map<String, Value> =
        effect.parameters().into_iter().map(|(key, setting)| (key, value(setting))).collect();
    json!({ "code": effect.code(), "parameters": parameters })
}

fn peak_n(made: &SimulatedExperiment) -> f64 {
    made.runs.iter().flat_map(|run| &run.force_n).copied().fold(0.0, f64::max)
}

fn print(made: &SimulatedExperiment, folder: &str, seconds: f64) {
    let samples: usize = made.runs.iter().map(|run| run.time_s.len()).sum();
    outln!("experiment       {}, seed {}", made.name, made.truth.seed);
    outln!("runs             {} with {samples} samples; largest force {} N", made.runs.len(), number(peak_n(made)));
    for effect in &made.truth.effects {
        let shown = |(key, setting): (String, Setting)| match setting {
            Setting::Number(value) => format!("{key} {}", number(value)),
            Setting::Word(word) => format!("{key} {word}"),
        };
        let parameters: Vec<String> = effect.parameters().into_iter().map(shown).collect();
        outln!("effect           {}: {}", effect.code(), parameters.join(", "));
    }
    if made.truth.effects.is_empty() {
        outln!("effect           none: the truth is what the folder declares");
    }
    outln!("solves           {} in {seconds:.1} s", made.solves);
    outln!("folder           {folder}");
}
