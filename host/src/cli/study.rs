//! `palpate study`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use lut_gen::solid::model::Resolution;
use miette::{IntoDiagnostic, WrapErr};

use crate::experiment;
use crate::identify::spec::Extra;
use crate::study::objective::Asked;
use crate::study::rivals::Parameters;
use crate::study::script::Press;
use crate::study::{self, Findings, Foam, StudyError, Subject};

use super::progress::Progress;

/// Which study, and of what.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Name of the study
    name: Name,
    /// Folder with experiment.toml [default: a simulated foam]
    experiment: Option<PathBuf>,
    /// Material of the experiment [default: its first]
    #[arg(long, value_name = "NAME", requires = "experiment")]
    material: Option<String>,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
    /// Folder of the HTML page and the SVG pictures [default: out/study; with --json none]
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
    /// Starts of the studies objective, terms and rivals [default: 8, 24 and 50]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1000))]
    starts: Option<u16>,
    /// Most evaluations of the study script, each a finite-element solve
    #[arg(long, value_name = "N", default_value_t = 300, value_parser = clap::value_parser!(u16).range(7..=5000))]
    evaluations: u16,
    /// Parameters of the material in the study rivals: 2 of one term, or 4 of two
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = parameters)]
    parameters: u8,
    /// Terms of the foam in the study objective, 1 or 2
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..=2))]
    terms: u8,
    /// Free besides in the study objective, separated by commas
    #[arg(long, value_name = "PARAMETER", value_delimiter = ',')]
    free: Vec<FreeWord>,
    /// Prony terms of the study curve, 0 to 2; with any the holds are fitted as well
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u8).range(0..=2))]
    relax: u8,
    #[command(flatten)]
    foam: Simulated,
}

/// The simulated foam.
#[derive(Debug, Args)]
#[command(next_help_heading = "The simulated foam")]
struct Simulated {
    /// Foam of the thesis (Table 1)
    #[arg(long, value_name = "FOAM", default_value = "eva", conflicts_with = "experiment")]
    foam: FoamWord,
    /// Its shear modulus, MPa [default: the foam's]
    #[arg(long, value_name = "MPA", conflicts_with = "experiment")]
    mu: Option<f64>,
    /// Its exponent [default: the foam's]
    #[arg(long, conflicts_with = "experiment")]
    alpha: Option<f64>,
    /// Radii of the balls, mm, separated by commas
    #[arg(long, value_name = "MM", value_delimiter = ',', default_values_t = [4.0, 6.0], conflicts_with = "experiment")]
    balls_mm: Vec<f64>,
    /// Noise of a sample, percent of the largest force
    #[arg(long, value_name = "PERCENT", default_value_t = 1.0, conflicts_with = "experiment")]
    noise: f64,
    /// Seed of the noise, and of random starts
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Name {
    /// Map of Eq. 14 with the paths of all starts (Fig. 9; --terms 2: Fig. 10; --free nu or friction: Fig. 13)
    Objective,
    /// Parameters against depth for each ball, and where the trends meet (Fig. 11)
    Depth,
    /// Measured against predicted, also across balls, with residuals (Figs. 12, 14)
    Curve,
    /// Two terms fitted to a foam of one: the kinds of equivalent optimum (Table 2)
    Terms,
    /// Rival optimisers on one problem: evaluations, time, success from random starts (Fig. 89)
    Rivals,
    /// The printed script of appendix C on a simulated liver; it takes no experiment
    Script,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum FreeWord {
    Nu,
    Friction,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum FoamWord {
    Eva,
    B1,
}

impl Simulated {
    fn foam(&self) -> Result<Foam, StudyError> {
        let mut foam = match self.foam {
            FoamWord::Eva => Foam::eva(),
            FoamWord::B1 => Foam::b1(),
        };
        foam.mu_mpa = within("--mu", self.mu.unwrap_or(foam.mu_mpa), (1e-6, 1e3), "must lie in 1e-6..=1000 MPa")?;
        foam.alpha = within("--alpha", self.alpha.unwrap_or(foam.alpha), (1.0, 24.0), "must lie in 1..=24")?;
        foam.noise = within("--noise", self.noise, (0.0, 50.0), "must lie in 0..=50 percent")? / 100.0;
        foam.seed = self.seed;
        for radius_mm in &self.balls_mm {
            within("--balls-mm", *radius_mm, (1.0, 8.0), "must lie in 1..=8 mm")?;
        }
        // A little above the equator of the smallest ball, and no deeper than the thesis went.
        let smallest_mm = self.balls_mm.iter().copied().fold(f64::INFINITY, f64::min);
        foam.depth_mm = foam.depth_mm.min(0.975 * smallest_mm);
        foam.balls_mm.clone_from(&self.balls_mm);
        Ok(foam)
    }
}

fn parameters(text: &str) -> Result<u8, String> {
    match text {
        "2" => Ok(2),
        "4" => Ok(4),
        _ => Err("expected 2 or 4".to_owned()),
    }
}

fn within(
    parameter: &'static str,
    value: f64,
    (low, high): (f64, f64),
    expected: &'static str,
) -> Result<f64, StudyError> {
    if (low..=high).contains(&value) { Ok(value) } else { Err(StudyError::Parameter { parameter, value, expected }) }
}

/// Reads or simulates, studies, tells.
///
/// # Errors
/// Bad input, a failing solve, or a report that cannot be written.
pub fn run(arguments: &Arguments) -> miette::Result<()> {
    if matches!(arguments.name, Name::Script) {
        return script(arguments);
    }
    let subject = match &arguments.experiment {
        Some(folder) => Subject::measured(experiment::read(folder)?, arguments.material.as_deref())?,
        None => Subject::simulated(arguments.foam.foam()?)?,
    };
    let progress = Progress::new();
    let told = |what: &str, done: usize, total: usize| progress.set(what, done, total);
    let findings = match arguments.name {
        Name::Objective => {
            let extra = |word: &FreeWord| match word {
                FreeWord::Nu => Extra::Nu,
                FreeWord::Friction => Extra::Friction,
            };
            let usual = Asked::default();
            let asked = Asked {
                terms: arguments.terms.into(),
                free: arguments.free.iter().map(extra).collect(),
                starts: arguments.starts.map_or(usual.starts, usize::from),
                ..usual
            };
            study::objective::study(&subject, &asked, &told)
        }
        Name::Depth => study::depth::study(&subject, arguments.foam.seed, &told),
        Name::Curve => study::curve::study(&subject, arguments.relax.into(), &told),
        Name::Terms => {
            let effort = study::terms::Effort {
                starts: arguments.starts.map_or(24, usize::from),
                resolution: Resolution::Standard,
            };
            study::terms::study(&subject, &effort, &told)
        }
        Name::Rivals => {
            let starts = arguments.starts.map_or(50, usize::from);
            let parameters = if arguments.parameters == 4 { Parameters::Four } else { Parameters::Two };
            study::rivals::study(&subject, parameters, starts, arguments.foam.seed, &told)
        }
        Name::Script => return script(arguments),
    };
    progress.end();
    tell(&findings?, arguments)
}

/// The study that has a recording of its own.
fn script(arguments: &Arguments) -> miette::Result<()> {
    if arguments.experiment.is_some() {
        return Err(StudyError::OwnRecording { study: "script" }.into());
    }
    let noise = within("--noise", arguments.foam.noise, (0.0, 50.0), "must lie in 0..=50 percent")?;
    let press = Press { noise: noise / 100.0, seed: arguments.foam.seed, ..Press::default() };
    let progress = Progress::new();
    let told = |what: &str, done: usize, total: usize| progress.set(what, done, total);
    let findings = study::script::study(press, arguments.evaluations.into(), &told);
    progress.end();
    tell(&findings?, arguments)
}

fn tell(findings: &Findings, arguments: &Arguments) -> miette::Result<()> {
    let folder = arguments.report.clone().or_else(|| (!arguments.json).then(|| PathBuf::from(study::DEFAULT_FOLDER)));
    // The answer is printed also where the report cannot be written.
    let written = folder.map(|folder| {
        findings
            .write(&folder)
            .into_diagnostic()
            .wrap_err_with(|| format!("cannot write the report to {}", folder.display()))
    });
    let (report, failed) = match written.transpose() {
        Ok(report) => (report, Ok(())),
        Err(error) => (None, Err(error)),
    };
    if arguments.json {
        outln!("{}", findings.answer(report.as_deref()));
        return failed;
    }
    outln!("{}\n{}\n", findings.title, findings.subject);
    for table in &findings.tables {
        outln!("{}", table.text());
    }
    for sentence in &findings.answer {
        outln!("{sentence}");
    }
    if let Some(page) = report {
        outln!("\nreport   {}", page.display());
    }
    failed
}
