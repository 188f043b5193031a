//! `palpate demo`.

use std::path::PathBuf;
use std::sync::Mutex;

use clap::Args;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use miette::IntoDiagnostic;

use crate::control::Curves;
use crate::control::compose::Links;
use crate::demo::{self, Options, Stage};
use crate::extended::ExtendedModel;
use crate::link::Disturbance;

use super::progress::Progress;

/// How the demo goes.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Number of palpations
    #[arg(long, default_value_t = 20, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    palpations: u32,
    /// Rate of the probe, 1 to 4 mm/s
    #[arg(long, default_value_t = 2.0, value_parser = rate)]
    rate: f64,
    /// Seed of everything random
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Folder for report, logs and table
    #[arg(long, default_value = "out/demo", value_name = "DIR")]
    out: PathBuf,
    /// Use this table instead of computing one
    #[arg(long, value_name = "FILE")]
    table: Option<PathBuf>,
    /// Control curves of the display's coil, a file a foam, in the place of the program's
    #[arg(long, value_name = "FILE", num_args = 1.., conflicts_with = "table")]
    control: Vec<PathBuf>,
    /// Model file of `palpate diagnose --model`: its effects in table and foams, its material among these
    #[arg(long, value_name = "FILE", conflicts_with = "table")]
    model: Option<PathBuf>,
    /// Probability that the line flips a bit of a byte, to see that nothing is lost unnoticed
    #[arg(long, default_value_t = 0.0, value_name = "P", value_parser = probability)]
    line_noise: f64,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
}

fn rate(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(rate) if (1.0..=4.0).contains(&rate) => Ok(rate),
        _ => Err(format!("{text} is not a rate the board allows: 1 to 4 mm/s")),
    }
}

fn probability(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(p) if (0.0..=0.01).contains(&p) => Ok(p),
        _ => Err(format!("{text} is not a probability between 0 and 0.01")),
    }
}

/// Runs the demo and prints what it found.
///
/// # Errors
/// Whatever stops the demo.
pub fn run(arguments: &Arguments) -> miette::Result<()> {
    let control = Curves::read(&arguments.control).into_diagnostic()?;
    let model = arguments.model.as_deref().map(ExtendedModel::read).transpose()?;
    // before the magnet is computed for a folder that is not to be written to
    demo::folder(&arguments.out)?;
    let options = Options {
        palpations: arguments.palpations as usize,
        rate_mm_s: arguments.rate,
        seed: arguments.seed,
        out: arguments.out.clone(),
        table: arguments.table.clone(),
        model,
        line: Disturbance { flip: arguments.line_noise, ..Disturbance::default() },
        magnet: links(&control)?,
        control,
        ..Options::default()
    };
    let solves = Progress::new();
    let bar = Mutex::new(None);
    let summary = demo::run(&options, &|stage| show(&solves, &bar, &stage))?;
    if arguments.json {
        outln!("{}", summary.json());
    } else {
        outln!("{summary}");
    }
    Ok(())
}

/// Magnet and fluid of the curves' display, where the program knows them.
fn links(curves: &Curves) -> miette::Result<Option<Links>> {
    let (magnet, fluid) = curves.display().unwrap_or(("ring", "MRF-122EG"));
    let Ok(fluid) = super::magnet::fluid::found(fluid) else { return Ok(None) };
    Ok(super::control_curve::magnets::links(magnet, &fluid, f64::from(protocol::lut::CURRENT_MAX_A)).ok())
}

/// The bar of the upload or of the palpations; the name tells them apart.
type Bar = Mutex<Option<(&'static str, ProgressBar)>>;

fn show(solves: &Progress, bar: &Bar, stage: &Stage<'_>) {
    match *stage {
        Stage::Solving { what, done, total } => solves.set(what, done, total),
        Stage::Uploading { done, total } => set(bar, "upload to the board", "bytes", done, total, ""),
        Stage::Palpated { done, total, verdict } => set(bar, "palpations", "", done, total, verdict),
        Stage::Note(text) => match bar.lock().as_deref() {
            Ok(Some((_, bar))) => bar.println(text),
            _ => errln!("{text}"),
        },
    }
}

fn set(bar: &Bar, name: &'static str, unit: &str, done: usize, total: usize, text: &str) {
    let Ok(mut bar) = bar.lock() else { return };
    if bar.as_ref().is_none_or(|(shown, _)| *shown != name) {
        let fresh = ProgressBar::with_draw_target(Some(total as u64), ProgressDrawTarget::stderr());
        let template = format!("{name:32} [{{bar:30}}] {{pos:>3}}/{{len}} {unit}  {{msg}}");
        if let Ok(style) = ProgressStyle::with_template(&template) {
            fresh.set_style(style.progress_chars("=> "));
        }
        *bar = Some((name, fresh));
    }
    if let Some((_, bar)) = bar.as_ref() {
        bar.set_message(text.to_owned());
        bar.set_position(done as u64);
        if done >= total {
            bar.finish();
        }
    }
}
