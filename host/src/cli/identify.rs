//! `palpate identify`.

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::{Args, ValueEnum};
use miette::IntoDiagnostic;

use crate::diagnose::Models;
use crate::experiment::{self, Experiment};
use crate::extended::{self, ExtendedModel};
use crate::identify::newton::verdict::Standing;
use crate::identify::spec::{Extra, FitSpec, FittedLaw, Loss, Method, Own};
use crate::identify::{self, Identification};
use crate::report::number;
use crate::results::{Place, Provenance};
use crate::{infer, unseen};

use super::progress::Progress;
use super::{keep, many};

/// What to identify, and how to tell it.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Folder with experiment.toml; several make a table
    #[arg(required = true, value_name = "EXPERIMENT")]
    experiments: Vec<PathBuf>,
    /// Print one JSON object on standard output
    #[arg(long)]
    pub(super) json: bool,
    /// Folder of the results [default: a new one below out/identify; with --json none]
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
    /// Save what was identified as a model file, for --model and for `palpate lut --material`
    #[arg(long, value_name = "FILE", conflicts_with = "model")]
    save: Option<PathBuf>,
    /// Let --save replace a file
    #[arg(long, requires = "save")]
    force: bool,
    /// Fit mu and alpha with the effects of this model file (`palpate diagnose --model`) in the chain
    #[arg(long, value_name = "FILE", conflicts_with_all = ["report", "law", "terms", "relax", "free", "nu", "friction",
        "platen_friction", "own", "loss", "method"])]
    model: Option<PathBuf>,
    /// Fit the parameters of the model's effects as well
    #[arg(long, requires = "model")]
    free_effects: bool,
    /// Intervals of noise alone: effects that these runs cannot show do not widen them
    #[arg(long, conflicts_with = "model")]
    noise_only: bool,
    #[command(flatten)]
    fit: Fit,
}

/// What is fitted, and how.
#[derive(Debug, Args)]
#[command(next_help_heading = "What is fitted")]
struct Fit {
    /// Law [default: what the specimens declare]
    #[arg(long, value_name = "LAW")]
    law: Option<LawWord>,
    /// Terms of the law, 1 or 2 [default: what the specimens declare]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..=2))]
    terms: Option<u8>,
    /// Prony terms, 0 to 2; with any the hold after the ramp is fitted as well
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u8).range(0..=2))]
    relax: u8,
    /// Free besides the law's own parameters, separated by commas
    #[arg(long, value_name = "PARAMETER", value_delimiter = ',')]
    free: Vec<ExtraWord>,
    /// Poisson's ratio of the hyperfoam where it is not free
    #[arg(long, default_value_t = 0.0, value_parser = poisson)]
    nu: f64,
    /// Coefficient of friction between ball and specimen where it is not free
    #[arg(long, default_value_t = 0.0, value_parser = friction)]
    friction: f64,
    /// Coefficient of friction between platens and specimen where it is not free
    #[arg(long, default_value_t = 0.0, value_parser = friction)]
    platen_friction: f64,
    /// Parameters that every specimen has for itself, separated by commas
    #[arg(long, value_name = "PARAMETER", value_delimiter = ',')]
    own: Vec<OwnWord>,
    /// How a difference between measured and modelled force counts
    #[arg(long, value_name = "LOSS", default_value = "huber")]
    loss: LossWord,
    /// Search
    #[arg(long, value_name = "METHOD", default_value = "gauss-newton")]
    method: MethodWord,
    /// Longest that one material's fit may take, in seconds; the best so far is told when it is over
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    budget_s: Option<f64>,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum LawWord {
    Hyperfoam,
    Ogden,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum ExtraWord {
    Nu,
    Friction,
    PlatenFriction,
    Height,
    BallRadius,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum OwnWord {
    Mu,
    Alpha,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum LossWord {
    Squares,
    Huber,
    /// Eq. 14 of the thesis
    Absolute,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum MethodWord {
    GaussNewton,
    /// MultiStart of the thesis: a grid, and a simplex from each candidate
    Simplex,
}

fn poisson(text: &str) -> Result<f64, String> {
    let nu: f64 = text.parse().map_err(|_| "expected a number from -0.9 to 0.49".to_owned())?;
    if (-0.9..=0.49).contains(&nu) { Ok(nu) } else { Err("expected a number from -0.9 to 0.49".to_owned()) }
}

fn friction(text: &str) -> Result<f64, String> {
    let friction: f64 = text.parse().map_err(|_| "expected a number from 0 to 1".to_owned())?;
    if (0.0..=1.0).contains(&friction) { Ok(friction) } else { Err("expected a number from 0 to 1".to_owned()) }
}

fn seconds(text: &str) -> Result<f64, String> {
    let told = || "expected a positive number of seconds".to_owned();
    let seconds: f64 = text.parse().map_err(|_| told())?;
    if seconds > 0.0 && seconds.is_finite() { Ok(seconds) } else { Err(told()) }
}

impl Arguments {
    fn spec(&self) -> FitSpec {
        let fit = &self.fit;
        FitSpec {
            law: fit.law.map(|law| match law {
                LawWord::Hyperfoam => FittedLaw::Hyperfoam,
                LawWord::Ogden => FittedLaw::Ogden,
            }),
            terms: fit.terms.map(usize::from),
            relaxation: usize::from(fit.relax),
            free: fit
                .free
                .iter()
                .map(|extra| match extra {
                    ExtraWord::Nu => Extra::Nu,
                    ExtraWord::Friction => Extra::Friction,
                    ExtraWord::PlatenFriction => Extra::PlatenFriction,
                    ExtraWord::Height => Extra::Height,
                    ExtraWord::BallRadius => Extra::BallRadius,
                })
                .collect(),
            nu: fit.nu,
            friction: fit.friction,
            platen_friction: fit.platen_friction,
            own: fit
                .own
                .iter()
                .map(|own| match own {
                    OwnWord::Mu => Own::Mu,
                    OwnWord::Alpha => Own::Alpha,
                })
                .collect(),
            loss: match fit.loss {
                LossWord::Squares => Loss::Squares,
                LossWord::Huber => Loss::Huber,
                LossWord::Absolute => Loss::Absolute,
            },
            method: match fit.method {
                MethodWord::GaussNewton => Method::GaussNewton,
                MethodWord::Simplex => Method::Simplex,
            },
            budget_s: fit.budget_s,
            ..FitSpec::default()
        }
    }
}

/// An experiment that was identified.
pub(super) struct Fitted {
    pub experiment: Experiment,
    pub found: Vec<Identification>,
    pub provenance: Provenance,
    /// Wall time with reading, s.
    pub seconds: f64,
}

impl Fitted {
    /// The answer; `report` is where its page is.
    pub fn json(&self, report: Option<&str>) -> serde_json::Value {
        identify::json(&self.experiment, &self.found, report)
    }
}

impl Arguments {
    /// Where the results go, if anywhere.
    pub(super) fn place(&self) -> Option<Place> {
        keep::place(self.report.as_ref(), self.json, "out/identify")
    }

    /// Reads and fits one experiment; what the reader should know goes to standard error.
    pub(super) fn fitted(&self, path: &Path) -> miette::Result<Fitted> {
        let start = Instant::now();
        let experiment = experiment::read(path)?;
        let provenance = Provenance::of_experiment(path, &experiment, &[]);
        let progress = Progress::new();
        let tell = |what: &str, done, total| progress.set(what, done, total);
        let mut found = identify::identify(&experiment, &self.spec(), &tell)?;
        if !self.noise_only {
            let models = Models::kept();
            for one in &mut found {
                let told = |done, total| progress.set("effects that these runs may not show", done, total);
                unseen::widen(&experiment, one, &models, &told).map_err(|cause| miette::miette!("{cause}"))?;
            }
        }
        progress.end();
        for message in found.iter().flat_map(|one| &one.messages) {
            errln!("{message}");
        }
        Ok(Fitted { experiment, found, provenance, seconds: start.elapsed().as_secs_f64() })
    }
}

/// Reads, fits, tells, and then keeps what was found.
///
/// # Errors
/// Bad input, a failing solve, or results that cannot be kept: these were told before.
pub fn run(arguments: &Arguments) -> miette::Result<()> {
    match (&arguments.model, arguments.experiments.as_slice()) {
        (Some(file), [path]) => with_model(arguments, path, file),
        (None, [path]) => one(arguments, path),
        (Some(_), _) => Err(miette::miette!("--model takes one experiment at a time")),
        (None, _) if arguments.save.is_some() => Err(miette::miette!("--save takes one experiment at a time")),
        (None, several) => many::run(arguments, several),
    }
}

fn one(arguments: &Arguments, path: &Path) -> miette::Result<()> {
    let fitted = arguments.fitted(path)?;
    let Fitted { experiment, found, provenance, seconds } = &fitted;
    if !arguments.json {
        if found.is_empty() {
            outln!("outcome          nothing to identify: no run indents, compresses or pulls a soft specimen");
        }
        found.iter().for_each(print);
    }
    let folder = arguments.place().map(|place| keep::identified(&place, experiment, found, provenance, *seconds));
    let report = folder.as_ref().and_then(|made| made.as_ref().ok()).map(|made| made.path().join("report.html"));
    let report = report.map(|file| file.display().to_string());
    if arguments.json {
        outln!("{}", fitted.json(report.as_deref()));
    }
    let saved = arguments
        .save
        .as_ref()
        .map(|file| keep::models(experiment, found, (file, arguments.force), arguments.fit.friction));
    let folder = folder.transpose()?;
    if let Some(folder) = &folder {
        keep::rest(folder, experiment, found, provenance)?.iter().for_each(|note| errln!("{note}"));
        if !arguments.json {
            outln!("results          {}", folder.path().display());
            outln!("report           {}", report.unwrap_or_default());
        }
    }
    let (files, notes) = saved.transpose()?.unwrap_or_default();
    notes.iter().for_each(|note| errln!("{note}"));
    if !arguments.json {
        files.iter().for_each(|file| outln!("model            {}", file.display()));
    }
    Ok(())
}

/// Fits with an extended model, and tells.
fn with_model(arguments: &Arguments, path: &Path, file: &Path) -> miette::Result<()> {
    let experiment = experiment::read(path)?;
    let model = ExtendedModel::read(file)?;
    let progress = Progress::new();
    let tell = |what: &str, done, total| progress.set(what, done, total);
    let found = extended::identify::identify(&experiment, &model, arguments.free_effects, &Models::kept(), &tell);
    progress.end();
    let found = found.into_diagnostic()?;
    for message in &found.messages {
        errln!("{message}");
    }
    if arguments.json {
        outln!("{}", found.json(&experiment, &file.display().to_string()));
        return Ok(());
    }
    outln!("material         {}", found.material);
    outln!("outcome          {}", found.outcome.word());
    print_parameters("", &found.parameters);
    for effect in &found.effects {
        let owner = effect.owner.as_ref().map_or(String::new(), |name| format!(" of {name}"));
        outln!("effect           {} ({}){owner}", effect.code, effect.form);
        print_parameters("  ", &effect.parameters);
    }
    if found.rmse_n.is_finite() {
        let (left, noise) = (number(found.rmse_n), number(found.noise_n));
        outln!("residual         {left} N rms, noise {noise} N a sample ({})", found.noise_from);
    }
    outln!("solves           {} in {:.1} s", found.fe_solves, found.seconds);
    Ok(())
}

fn print_parameters(indent: &str, parameters: &[extended::identify::Parameter]) {
    let width = 16 - indent.len();
    for p in parameters {
        let interval =
            p.interval.map_or(String::new(), |(low, high)| format!("  95 %: {} to {}", number(low), number(high)));
        let from = if p.fixed { "  from the file" } else { "" };
        outln!("{indent}{:width$} {:10}{interval}{from}", p.name, number(p.value));
    }
}

fn print(found: &Identification) {
    outln!("material         {}", found.material);
    outln!("outcome          {}", found.outcome.word());
    let Some(fit) = &found.fit else { return };
    for parameter in &fit.parameters {
        let standing = match (&parameter.verdict, parameter.at_bound, parameter.derived) {
            (_, true, _) => "on a bound",
            (_, _, true) => "follows from the others",
            (Some(verdict), ..) => match verdict.standing {
                Standing::Identified => "identified",
                Standing::InCombination => "only in combination",
                Standing::NotIdentifiable => "not identifiable",
            },
            (None, ..) => "",
        };
        outln!(
            "{:16} {:10}  95 %: {} to {}  {standing}",
            parameter.name,
            number(parameter.value),
            number(parameter.interval95.low),
            number(parameter.interval95.high),
        );
    }
    for parameter in &fit.parameters {
        let told = parameter.unseen.as_ref().and_then(|u| infer::unseen::sentence(&parameter.name, u.times, &u.by));
        if let Some(told) = told {
            outln!("interval         {told}");
        }
    }
    outln!("residual         {} N rms, noise {} N", number(fit.rmse_n), number(fit.noise.sigma_n));
    if let Some(check) = found.direct_check {
        outln!("check            force model within {} % of a solve at the end", number(100.0 * check));
    }
    outln!("solves           {} in {:.1} s", found.fe_solves, found.seconds);
}
