//! What `palpate tour` is asked.

use std::path::PathBuf;

use clap::Args;
use clap::builder::PossibleValuesParser;

use crate::link::Address;
use crate::tour::BOUNDINGS;

/// Folder where none is asked for.
pub(super) const DEFAULT_FOLDER: &str = "out/tour";

/// Where to go, in which order, and how to press there.
#[derive(Debug, Args)]
pub struct Arguments {
    /// The stops [default: the thesis' four foams and three tissues]
    #[arg(value_name = "TOUR.toml")]
    pub(super) tour: Option<PathBuf>,
    /// The board: sim, auto (the one on USB), tcp:HOST:PORT or serial:PATH; at a real one you are told where to go
    #[arg(long, default_value = "sim")]
    pub(super) board: Address,
    /// Rate of the probe, mm/s
    #[arg(long, default_value_t = 2.0, value_name = "MM_PER_S")]
    pub(super) rate: f64,
    /// Depth after contact, mm
    #[arg(long, default_value_t = 4.0, value_name = "MM")]
    pub(super) depth: f64,
    /// About so many presses in all, in the proportion of the file's visits [default: as often as the file says]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(super) presses: Option<u32>,
    /// Seed of the order: the same at every rate
    #[arg(long, default_value_t = 1)]
    pub(super) seed: u64,
    /// White noise of the simulated load cell, as a part of each specimen's largest force
    #[arg(long, default_value_t = 0.01, value_name = "PART")]
    pub(super) noise: f64,
    /// How the Kalman filter keeps its estimates within the region
    #[arg(long, default_value = "penalty", value_parser = PossibleValuesParser::new(BOUNDINGS.map(|(word, _)| word)))]
    pub(super) bounding: String,
    /// The board's table; the simulated one is sent it [default: the demo's, computed first]
    #[arg(long, value_name = "FILE")]
    pub(super) table: Option<PathBuf>,
    /// Folder for the page, its pictures and the presses
    #[arg(long, value_name = "DIR", default_value = DEFAULT_FOLDER)]
    pub(super) out: PathBuf,
    /// Copy the thesis' stops to this new file, to change them, and press nothing
    #[arg(long, value_name = "FILE")]
    pub(super) copy: Option<PathBuf>,
    /// Print one JSON object on standard output
    #[arg(long)]
    pub(super) json: bool,
}
