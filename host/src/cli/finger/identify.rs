//! `palpate finger identify`: the finger that makes the prints which were measured.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use miette::{IntoDiagnostic, WrapErr};
use serde_json::{Value, json};

use crate::cli::progress::Progress;
use crate::finger::prints::{self, Fit, Free, Print};
use crate::finger::text_of;
use crate::ownership::OwnFolder;
use crate::report::{Page, finger as picture, number};

/// Folder of files where none is asked for.
const DEFAULT_FOLDER: &str = "out/prints";

/// A trend of the misfit that chance makes more seldom is told.
const SELDOM: f64 = 0.01;

/// Prints that were measured, and the finger to begin from.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Folder with experiment.toml, whose runs with test = "print" hold force_N and area_mm2, or force_N, a_mm and b_mm
    #[arg(value_name = "EXPERIMENT")]
    experiment: PathBuf,
    /// The finger to begin from: a finger.toml, or the name of one that comes with the program
    #[arg(long, value_name = "FILE", default_value = "round")]
    finger: String,
    /// What of the finger is free, with commas: the moduli of both layers, all lengths, the skin's moduli beside the tissue's
    #[arg(long, value_name = "NUMBER,..", value_delimiter = ',', default_values = ["stiffness"])]
    free: Vec<FreeWord>,
    /// Save the finger that was found to this new file, for --finger
    #[arg(long, value_name = "FILE")]
    save: Option<PathBuf>,
    /// Folder for the page and its picture
    #[arg(long, value_name = "DIR", default_value = DEFAULT_FOLDER)]
    out: PathBuf,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum FreeWord {
    Stiffness,
    Size,
    Skin,
}

impl From<FreeWord> for Free {
    fn from(word: FreeWord) -> Self {
        match word {
            FreeWord::Stiffness => Free::Stiffness,
            FreeWord::Size => Free::Size,
            FreeWord::Skin => Free::Skin,
        }
    }
}

/// Fits, tells, and writes.
///
/// # Errors
/// An experiment or finger with a mistake, too few prints, a press without equilibrium, a file that cannot be written.
pub(super) fn run(arguments: &Arguments) -> miette::Result<()> {
    let experiment = crate::experiment::read(&arguments.experiment)?;
    let prints = prints::of(&experiment).into_diagnostic()?;
    let (file, text) = text_of(&arguments.finger)?;
    let mut free: Vec<Free> = arguments.free.iter().map(|word| Free::from(*word)).collect();
    free.sort_unstable();
    free.dedup();
    let progress = Progress::new();
    let fit = prints::fit((&file, &text), &prints, &free, &|done| progress.set("presses on a plate", done, 0));
    progress.end();
    let fit = fit.into_diagnostic().wrap_err_with(|| format!("prints of {}", arguments.experiment.display()))?;
    if let Some(save) = &arguments.save {
        let own = prints::scaled(&file, &text, fit.scale)?;
        crate::cli::file::copy(save, &format!("# {}\n{own}", head(&arguments.experiment, &arguments.finger, &fit)))?;
    }
    let lines = sentences(&prints, &fit);
    let files = write(arguments, &prints, &fit, &lines)?;
    if arguments.json {
        outln!("{}", summary(&prints, &fit, &lines, &files));
        return Ok(());
    }
    lines.iter().for_each(|line| outln!("{line}"));
    outln!("written {} and {} beside it", files[0].display(), files[1].display());
    Ok(())
}

/// How a finger was found, in one line.
fn head(experiment: &Path, finger: &str, fit: &Fit) -> String {
    let of = |own: &prints::Fitted| format!("{} x {}", own.of.name(), number(own.factor));
    let factors = fit.fitted.iter().map(of).collect::<Vec<_>>().join(", ");
    let experiment = experiment.display().to_string().replace(char::is_control, " ");
    format!("palpate finger identify {experiment}: {} with {factors}", finger.replace(char::is_control, " "))
}

/// The answer first, then what it rests on.
fn sentences(prints: &[Print], fit: &Fit) -> Vec<String> {
    let mut lines = Vec::new();
    for own in &fit.fitted {
        let (low, high) = own.interval;
        let told = if own.is_told { "" } else { ": the prints do not tell it" };
        lines.push(format!(
            "{} {} times that of the file, 95 % from {} to {}{told}.",
            match own.of {
                Free::Stiffness => "Moduli are",
                Free::Size => "Lengths are",
                Free::Skin => "The skin's moduli beside those of the tissue are",
            },
            number(own.factor),
            number(low),
            number(high)
        ));
    }
    lines.push(format!(
        "Radii of {} prints differ by {} mm (root mean square) from the fitted finger's, and by {} mm from those of the finger \
         as it is.",
        prints.len(),
        number(fit.after_mm),
        number(fit.before_mm)
    ));
    lines.push(format!(
        "All edges are read {} mm farther out than the finger's ({} mm either way are allowed for).",
        number(fit.shift_mm),
        number(prints::EDGE_MM)
    ));
    let (slope, chance) = fit.trend;
    if chance < SELDOM {
        lines.push(format!(
            "What is left goes with the force: {} mm for every factor of e, and chance makes that in {} of 100 cases. Noise is \
             not all: the finger is of another kind (free size or skin), or the edges are read otherwise.",
            number(slope),
            number(100.0 * chance)
        ));
    }
    if fit.beyond > 0 {
        let count = fit.beyond;
        lines.push(format!(
            "{count} prints lie beyond what the finger could be pressed to: there its curve is extrapolated."
        ));
    }
    if let Some(ratio) = prints::ratio(prints) {
        lines.push(format!(
            "The prints' radii are {} times one another; a finger about an axis has round prints, and circles of their areas are compared.",
            number(ratio)
        ));
    }
    lines
}

fn write(arguments: &Arguments, prints: &[Print], fit: &Fit, lines: &[String]) -> miette::Result<Vec<PathBuf>> {
    let mut folder = OwnFolder::open(&arguments.out, "--out", Some(DEFAULT_FOLDER)).into_diagnostic()?;
    let figure = picture::prints(prints, fit).svg();
    let mut page = Page::new("Prints of a finger", &arguments.experiment.display().to_string());
    lines.iter().for_each(|line| page.paragraph(line));
    page.figure(&figure, "Area of the print over force: measured, and simulated by finite elements.");
    Ok(vec![
        folder.write("prints.html", page.html().as_bytes()).into_diagnostic()?,
        folder.write("prints.svg", figure.as_bytes()).into_diagnostic()?,
    ])
}

fn summary(prints: &[Print], fit: &Fit, lines: &[String], files: &[PathBuf]) -> Value {
    let fitted = fit.fitted.iter().map(|own| {
        json!({"of": own.of.name(), "factor": own.factor, "low95": own.interval.0, "high95": own.interval.1,
               "told": own.is_told})
    });
    let rows = prints.iter().zip(fit.area_mm2.iter().zip(&fit.area_before_mm2)).map(|(print, (after, before))| {
        json!({"force_N": print.force_n, "area_mm2": print.area_mm2, "radii_mm": print.radii_mm,
               "simulated_mm2": after, "simulated_before_mm2": before})
    });
    let files = crate::cli::file::names(files);
    json!({"parameters": fitted.collect::<Vec<_>>(), "rms_before_mm": fit.before_mm, "rms_after_mm": fit.after_mm,
           "trend": {"mm_per_ln_force": fit.trend.0, "probability": fit.trend.1}, "beyond": fit.beyond, "edge_shift_mm": fit.shift_mm,
           "prints": rows.collect::<Vec<_>>(), "remarks": lines, "files": files})
}
