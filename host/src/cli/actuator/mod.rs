//! `palpate actuator`.

mod told;

use std::path::PathBuf;

use clap::{Args, Subcommand};
use miette::{IntoDiagnostic, miette};
use serde_json::Value;

use super::progress::Progress;
use crate::ownership::OwnFolder;
use crate::report::Page;
use crate::report::response as picture;
use crate::response::file;
use crate::response::identified::{Identified, identify};
use crate::response::law::Structure;
use crate::response::push::{PushFit, Pushed, push};
use crate::response::recording::{Columns, Recorded, read};

/// Folder of files where none is asked for.
const DEFAULT_FOLDER: &str = "out/actuator";
/// What an order is written as.
const ORDERS: &str = "auto, spindle, lag, spindle-lag, mass or mass-lag";

/// The display's actuator.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    /// Find order, gain, delay, rate limit, friction and backlash in a recording
    Identify(Identify),
}

/// A recording of command and position, or of position and force of an actuator that is pushed.
#[derive(Debug, Args)]
pub struct Identify {
    /// CSV with a header: time, command (V) and position (mm), such as a recording of `palpate log`; or time, position and force (N)
    #[arg(value_name = "LOG")]
    log: PathBuf,
    /// Columns that are not found by their names: time=NAME, command=NAME, position=NAME, force=NAME, beside=NAME (a signal that the
    /// force of a pushed actuator may follow, such as a pressure)
    #[arg(long, value_name = "KEY=NAME", num_args = 1.., value_parser = column)]
    columns: Vec<(String, String)>,
    /// The law, instead of the one that the recording asks for: spindle, lag, spindle-lag, mass, mass-lag
    #[arg(long, value_name = "LAW", default_value = "auto")]
    law: String,
    /// Largest command of the driver, V, for actuator.toml
    #[arg(long, value_name = "V", default_value_t = 5.0)]
    command_limit: f64,
    /// Folder for actuator.toml, the page and its pictures
    #[arg(long, value_name = "DIR", default_value = DEFAULT_FOLDER)]
    out: PathBuf,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
}

fn column(text: &str) -> Result<(String, String), String> {
    const KEYS: [&str; 5] = ["time", "command", "position", "force", "beside"];
    let pair = text.split_once('=').filter(|(key, name)| KEYS.contains(key) && !name.is_empty());
    let (key, name) = pair.ok_or_else(|| format!("`{text}`: expected KEY=NAME with a key of {}", KEYS.join(", ")))?;
    Ok((key.to_owned(), name.to_owned()))
}

/// Runs the command.
///
/// # Errors
/// A recording with a mistake, an option out of range, a file that cannot be written.
pub fn run(arguments: &Arguments) -> miette::Result<()> {
    let What::Identify(asked) = &arguments.what;
    let structures = structures(&asked.law)?;
    if !(asked.command_limit > 0.0 && asked.command_limit <= 1e4) {
        return Err(miette!("--command-limit is {}; expected more than 0 and at most 10000 V", asked.command_limit));
    }
    let named = |key: &str| asked.columns.iter().find(|(of, _)| of == key).map(|(_, name)| name.clone());
    let columns = Columns {
        time: named("time"),
        command: named("command"),
        position: named("position"),
        force: named("force"),
        beside: named("beside"),
    };
    match read(&asked.log, &columns)? {
        Recorded::Commanded(record, column) => {
            let progress = Progress::new();
            let found = identify(&record, &structures, &|done| progress.set("orders", done, structures.len()));
            progress.end();
            let found = found.ok_or_else(|| miette!("{}: no law follows the command", asked.log.display()))?;
            commanded(asked, &found, &column)
        }
        Recorded::Pushed(record) => {
            let fit = push(&record).ok_or_else(|| miette!("{}: the shaft does not move", asked.log.display()))?;
            pushed(asked, &record, &fit)
        }
    }
}

fn structures(text: &str) -> miette::Result<Vec<Structure>> {
    if text == "auto" {
        return Ok(Structure::ALL.to_vec());
    }
    let found = Structure::ALL.into_iter().find(|structure| structure.code() == text);
    found.map(|structure| vec![structure]).ok_or_else(|| miette!("--law is {text}; expected {ORDERS}"))
}

fn commanded(asked: &Identify, found: &Identified, column: &str) -> miette::Result<()> {
    let log = asked.log.display().to_string();
    let title = asked.log.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    let source = format!("palpate actuator identify {log}; command from column {column}");
    let toml = file::text(found, &title, &source, asked.command_limit);
    let figures: Vec<String> = picture::figures(found).into_iter().map(|(figure, _)| figure.svg()).collect();
    let names = ["position.svg", "residual.svg", "correlation.svg", "loop.svg"];
    let files = write(asked, Some(&toml), &picture::page(found, &log), &names, &figures)?;
    let value = told::commanded_json(found, &log, column, &files);
    told(asked, &value, &files, || told::commanded(found))
}

fn pushed(asked: &Identify, record: &Pushed, fit: &PushFit) -> miette::Result<()> {
    let log = asked.log.display().to_string();
    let figures: Vec<String> =
        picture::pushed_figures(record, fit).into_iter().map(|(figure, _)| figure.svg()).collect();
    let names = ["loop.svg", "force.svg", "residual.svg", "correlation.svg"];
    let files = write(asked, None, &picture::pushed_page(record, fit, &log), &names, &figures)?;
    let value = told::pushed_json(fit, &log, &files);
    told(asked, &value, &files, || told::pushed(fit))
}

fn told(asked: &Identify, value: &Value, files: &[PathBuf], lines: impl Fn() -> Vec<String>) -> miette::Result<()> {
    if asked.json {
        outln!("{value}");
        return Ok(());
    }
    for line in lines() {
        outln!("{line}");
    }
    crate::cli::file::told(files);
    Ok(())
}

fn write(
    asked: &Identify,
    toml: Option<&str>,
    page: &Page,
    names: &[&str],
    figures: &[String],
) -> miette::Result<Vec<PathBuf>> {
    let mut folder = OwnFolder::open(&asked.out, "--out", Some(DEFAULT_FOLDER)).into_diagnostic()?;
    let mut files = Vec::new();
    if let Some(toml) = toml {
        files.push(folder.write("actuator.toml", toml.as_bytes()).into_diagnostic()?);
    }
    files.push(folder.write("actuator.html", page.html().as_bytes()).into_diagnostic()?);
    for (name, figure) in names.iter().zip(figures) {
        files.push(folder.write(name, figure.as_bytes()).into_diagnostic()?);
    }
    Ok(files)
}
