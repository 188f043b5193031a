//! What `palpate trial run` and `palpate trial analyse` are asked.

use std::path::PathBuf;

use clap::Args;

use crate::link::Address;

/// One session of one subject.
#[derive(Debug, Args)]
#[command(
    after_help = "Answers are the numbers of the materials, each followed by Enter; q ends the session, and the same command goes on \
with it. What is shown stands nowhere on the screen."
)]
pub struct Run {
    /// The journal: a file that only grows, one line an answer. If it is there, its session goes on
    #[arg(value_name = "FILE")]
    pub(super) journal: PathBuf,
    /// Materials, 2 to 9, in the order of their keys: NAME, or NAME=ENTRY with the number of the board's library entry
    #[arg(long, num_args = 2.., required = true, value_name = "NAME[=ENTRY]")]
    pub(super) materials: Vec<String>,
    /// Presentations of each material
    #[arg(long, default_value_t = 5, value_name = "N")]
    pub(super) repeats: usize,
    /// Seed of the order and of the subjects' codes: keep it for all sessions of a study
    #[arg(long, default_value_t = 1)]
    pub(super) seed: u64,
    /// Number of the subject; only a code made from it and the seed is stored
    #[arg(long, default_value_t = 1, value_name = "NUMBER")]
    pub(super) subject: u32,
    /// Show the materials on a board: sim, auto, tcp:HOST:PORT or serial:PATH. Without it nothing is shown (dry run)
    #[arg(long, value_name = "BOARD")]
    pub(super) present: Option<Address>,
    /// Table that the board holds, for the names of its library; the simulated board is sent it (without, the demo's: computed first)
    #[arg(long, value_name = "FILE", requires = "present")]
    pub(super) table: Option<PathBuf>,
    /// Answers come from a simulated subject with this Weber fraction
    #[arg(long, value_name = "FRACTION")]
    pub(super) simulate: Option<f64>,
    /// Stiffness of a material for the simulated subject: NAME=VALUE, above 0, all in one unit
    #[arg(long, num_args = 1.., value_name = "NAME=VALUE", value_parser = stiffness)]
    pub(super) stiffness: Vec<(String, f64)>,
    /// Print one JSON object on standard output at the end
    #[arg(long)]
    pub(super) json: bool,
}

/// What is analysed, and with what.
#[derive(Debug, Args)]
pub struct Analyse {
    /// Journals of sessions, a CSV with the columns shown,answered,count, or thesis-table-8, thesis-table-9
    #[arg(required = true, value_name = "FILE")]
    pub(super) files: Vec<PathBuf>,
    /// Stiffness of a material: NAME=VALUE, above 0, all in one unit; without it from the control curves that come with the program
    #[arg(long, num_args = 1.., value_name = "NAME=VALUE", value_parser = stiffness)]
    pub(super) stiffness: Vec<(String, f64)>,
    /// Control curves of materials, as `palpate control-curve` writes them
    #[arg(long, num_args = 1.., value_name = "FILE")]
    pub(super) curve: Vec<PathBuf>,
    /// Weber fraction of the subject that the answers are compared with
    #[arg(long, default_value_t = 0.15, value_name = "FRACTION")]
    pub(super) weber: f64,
    /// The real materials were not touched in the test: their softness is known without error
    #[arg(long)]
    pub(super) known: bool,
    /// Share of right answers that a sample size is asked for; without it the share that was found
    #[arg(long, value_name = "SHARE")]
    pub(super) right: Option<f64>,
    /// Half the width of the interval that a sample size is asked for
    #[arg(long, default_value_t = 0.1, value_name = "SHARE")]
    pub(super) half_width: f64,
    /// Probability of finding a subject better than guessing that a sample size is asked for
    #[arg(long, default_value_t = 0.8, value_name = "SHARE")]
    pub(super) power: f64,
    /// Folder for the page and its pictures
    #[arg(long, value_name = "DIR", default_value = DEFAULT_FOLDER)]
    pub(super) out: PathBuf,
    /// Print one JSON object on standard output
    #[arg(long)]
    pub(super) json: bool,
}

/// Folder of files where none is asked for.
pub(super) const DEFAULT_FOLDER: &str = "out/trial";

fn stiffness(text: &str) -> Result<(String, f64), String> {
    let pair = text.rsplit_once('=').map(|(name, value)| (name.trim(), value.trim().parse::<f64>()));
    match pair {
        Some((name, Ok(value))) if !name.is_empty() && value > 0.0 && value.is_finite() => Ok((name.to_owned(), value)),
        _ => Err(format!("`{text}`: expected NAME=VALUE with a value above 0, such as A2=0.75")),
    }
}
