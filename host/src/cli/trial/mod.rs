//! `palpate trial`.

mod analyse;
mod present;
mod session;
mod told;

use std::path::PathBuf;

use clap::{Args, Subcommand};
use miette::miette;

use crate::link::Address;
use crate::trial::journal::{MOST_REPEATS, MOST_STIMULI};

/// Subject tests of a softness display.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    /// Present materials blindly in random order and take the answers; goes on where a session ended
    Run(Run),
    /// Confusion table with exact intervals, d', information, Weber fraction, sample size
    Analyse(Analyse),
}

/// One session of one subject.
#[derive(Debug, Args)]
#[command(
    after_help = "Answers are the numbers of the materials, each followed by Enter; q ends the session, and the same command goes on \
with it. What is shown stands nowhere on the screen."
)]
pub struct Run {
    /// The journal: a file that only grows, one line an answer. If it is there, its session goes on
    #[arg(value_name = "FILE")]
    journal: PathBuf,
    /// Materials, 2 to 9, in the order of their keys: NAME, or NAME=ENTRY with the number of the board's library entry
    #[arg(long, num_args = 2.., required = true, value_name = "NAME[=ENTRY]")]
    materials: Vec<String>,
    /// Presentations of each material
    #[arg(long, default_value_t = 5, value_name = "N")]
    repeats: usize,
    /// Seed of the order and of the subjects' codes: keep it for all sessions of a study
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Number of the subject; only a code made from it and the seed is stored
    #[arg(long, default_value_t = 1, value_name = "NUMBER")]
    subject: u32,
    /// Show the materials on a board: sim, auto, tcp:HOST:PORT or serial:PATH. Without it nothing is shown (dry run)
    #[arg(long, value_name = "BOARD")]
    present: Option<Address>,
    /// Table that the board holds, for the names of its library; the simulated board is sent it (without, the demo's: computed first)
    #[arg(long, value_name = "FILE", requires = "present")]
    table: Option<PathBuf>,
    /// Answers come from a simulated subject with this Weber fraction
    #[arg(long, value_name = "FRACTION")]
    simulate: Option<f64>,
    /// Stiffness of a material for the simulated subject: NAME=VALUE, above 0, all in one unit
    #[arg(long, num_args = 1.., value_name = "NAME=VALUE", value_parser = stiffness)]
    stiffness: Vec<(String, f64)>,
    /// Print one JSON object on standard output at the end
    #[arg(long)]
    json: bool,
}

/// What is analysed, and with what.
#[derive(Debug, Args)]
pub struct Analyse {
    /// Journals of sessions, a CSV with the columns shown,answered,count, or thesis-table-8, thesis-table-9
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Stiffness of a material: NAME=VALUE, above 0, all in one unit; without it from the control curves that come with the program
    #[arg(long, num_args = 1.., value_name = "NAME=VALUE", value_parser = stiffness)]
    stiffness: Vec<(String, f64)>,
    /// Control curves of materials, as `palpate control-curve` writes them
    #[arg(long, num_args = 1.., value_name = "FILE")]
    curve: Vec<PathBuf>,
    /// Weber fraction of the subject that the answers are compared with
    #[arg(long, default_value_t = 0.15, value_name = "FRACTION")]
    weber: f64,
    /// The real materials were not touched in the test: their softness is known without error
    #[arg(long)]
    known: bool,
    /// Share of right answers that a sample size is asked for; without it the share that was found
    #[arg(long, value_name = "SHARE")]
    right: Option<f64>,
    /// Half the width of the interval that a sample size is asked for
    #[arg(long, default_value_t = 0.1, value_name = "SHARE")]
    half_width: f64,
    /// Probability of finding a subject better than guessing that a sample size is asked for
    #[arg(long, default_value_t = 0.8, value_name = "SHARE")]
    power: f64,
    /// Folder for the page and its pictures
    #[arg(long, value_name = "DIR", default_value = DEFAULT_FOLDER)]
    out: PathBuf,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
}

/// Folder of files where none is asked for.
const DEFAULT_FOLDER: &str = "out/trial";

fn stiffness(text: &str) -> Result<(String, f64), String> {
    let pair = text.rsplit_once('=').map(|(name, value)| (name.trim(), value.trim().parse::<f64>()));
    match pair {
        Some((name, Ok(value))) if !name.is_empty() && value > 0.0 && value.is_finite() => Ok((name.to_owned(), value)),
        _ => Err(format!("`{text}`: expected NAME=VALUE with a value above 0, such as A2=0.75")),
    }
}

/// Refuses a number outside its range.
fn within(option: &str, value: f64, low: f64, high: f64) -> miette::Result<()> {
    if (low..=high).contains(&value) {
        return Ok(());
    }
    Err(miette!("{option} is {value}; expected {low} to {high}"))
}

/// Names and library entries of the materials.
fn materials(texts: &[String]) -> miette::Result<Vec<(String, Option<u8>)>> {
    if texts.len() > MOST_STIMULI {
        return Err(miette!("--materials names {} materials; expected 2 to {MOST_STIMULI}", texts.len()));
    }
    let mut all: Vec<(String, Option<u8>)> = Vec::new();
    for text in texts {
        let (name, entry) = match text.split_once('=') {
            None => (text.trim(), None),
            Some((name, entry)) => {
                let number = entry.trim().parse::<u8>();
                let number =
                    number.map_err(|_| miette!("--materials {text}: expected NAME=ENTRY with a number of 0 to 255"))?;
                (name.trim(), Some(number))
            }
        };
        if name.is_empty() || all.iter().any(|(known, _)| known == name) {
            return Err(miette!("--materials {text}: expected a name that is not empty and differs from the others"));
        }
        all.push((name.to_owned(), entry));
    }
    Ok(all)
}

/// Runs the command.
///
/// # Errors
/// A file with a mistake, an option out of range, a board that refuses, a file that cannot be written.
pub fn run(arguments: &Arguments) -> miette::Result<()> {
    match &arguments.what {
        What::Run(asked) => {
            if !(1..=MOST_REPEATS).contains(&asked.repeats) {
                return Err(miette!("--repeats is {}; expected 1 to {MOST_REPEATS}", asked.repeats));
            }
            if let Some(weber) = asked.simulate {
                within("--simulate", weber, 0.001, 10.0)?;
            }
            session::run(asked, &materials(&asked.materials)?)
        }
        What::Analyse(asked) => {
            within("--weber", asked.weber, 0.001, 10.0)?;
            within("--half-width", asked.half_width, 0.01, 0.5)?;
            within("--power", asked.power, 0.5, 0.999)?;
            if let Some(right) = asked.right {
                within("--right", right, 0.0, 1.0)?;
            }
            analyse::run(asked)
        }
    }
}
