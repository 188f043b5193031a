//! What `palpate feel` is asked.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use miette::miette;
use protocol::message::{Actuator, Gains};

use super::plant::Plant;
use crate::actuator::Actuator as Identified;
use crate::cli::gains;
use crate::feel::Display;
use crate::link::Address;
use crate::tune::setting::Setting;

/// Folder of files where none is asked for.
pub(super) const DEFAULT_FOLDER: &str = "out/feel";

/// Materials, and the display that shows them to a simulated hand.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Foams whose curves come with the program, by name, or files of `palpate control-curve`; without any all of the former
    #[arg(value_name = "MATERIAL")]
    pub(super) materials: Vec<String>,
    /// Which display is pressed
    #[arg(long, value_enum, default_value_t = DisplayWord::All)]
    pub(super) display: DisplayWord,
    /// The board: sim (a simulated hand presses), or auto (the one on USB), tcp:HOST:PORT, serial:PATH: you press, and
    /// what is scored are its readings
    #[arg(long, default_value = "sim")]
    pub(super) board: Address,
    /// The table that a real board has, for the numbers of its materials
    #[arg(long, value_name = "FILE")]
    pub(super) table: Option<PathBuf>,
    /// The true display and hand: frozen, drawn:SEED, voice-coil, drawn-voice-coil:SEED, or a file of constants (`--copy` writes one)
    #[arg(long, default_value = "frozen")]
    pub(super) plant: Plant,
    /// The actuator that the board is set for: an actuator.toml (`palpate actuator identify`), thesis or voice-coil; gains are
    /// searched for it unless --gains has some [default: the board's own; voice-coil for that plant]
    #[arg(long, value_name = "FILE")]
    pub(super) actuator: Option<PathBuf>,
    /// The magnet that curves and display are made for: a magnet.toml, readings, or a name; curves are made for it anew
    #[arg(long, value_name = "FILE", default_value = "ring")]
    pub(super) magnet: String,
    /// The extended model of a display (`palpate diagnose`, [channel.flux], [channel.fluid]): its magnet and fluid are what is
    /// pressed, with the curves for --magnet, and with curves that are made for them anew
    #[arg(long, value_name = "FILE")]
    pub(super) model: Option<PathBuf>,
    /// The fluid: a fluid.toml, or the name of one that the program knows
    #[arg(long, value_name = "FILE", default_value = "MRF-122EG")]
    pub(super) fluid: String,
    /// Gains of the position loop, as a board takes them [default: the board's]
    #[arg(long, value_name = "KP,KI,KD,N", value_parser = gains::of_a_board)]
    pub(super) gains: Option<Gains>,
    /// Seed of tremor and noise
    #[arg(long, default_value_t = 1)]
    pub(super) seed: u64,
    /// Folder for the page, its pictures and the samples
    #[arg(long, value_name = "DIR", default_value = DEFAULT_FOLDER)]
    pub(super) out: PathBuf,
    /// Copy the constants of --plant (frozen or voice-coil) to this new file, to change them, and press nothing
    #[arg(long, value_name = "FILE")]
    pub(super) copy: Option<PathBuf>,
    /// Press each material three times slowly and three times fast on one --display, write what instruments beside it would have
    /// read to this folder, an experiment for `palpate diagnose`, and score nothing
    #[arg(long, value_name = "DIR", conflicts_with_all = ["copy", "model", "table"])]
    pub(super) record: Option<PathBuf>,
    /// Print one JSON object on standard output
    #[arg(long)]
    pub(super) json: bool,
}

/// Which display is pressed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum DisplayWord {
    /// The cap of the linear actuator
    Actuator,
    /// The fluid in the magnet's gap, its current by the finger's force
    Fluid,
    /// The same, its current by the finger's place
    FluidAtPlace,
    /// All, one after the other
    All,
}

impl Arguments {
    /// A model of magnet and fluid changes nothing of the actuator.
    pub fn displays(&self) -> &'static [Display] {
        match self.display {
            DisplayWord::All if self.model.is_some() => &[Display::Fluid, Display::FluidAtPlace],
            DisplayWord::Actuator => &[Display::Actuator],
            DisplayWord::Fluid => &[Display::Fluid],
            DisplayWord::FluidAtPlace => &[Display::FluidAtPlace],
            DisplayWord::All => &[Display::Actuator, Display::Fluid, Display::FluidAtPlace],
        }
    }

    /// What the board is set to: gains, and what it is told of its actuator.
    pub fn setting(&self) -> miette::Result<(Option<Gains>, Option<Actuator>)> {
        let gains = self.gains.clone();
        let own = || self.plant.has_voice_coil().then(|| PathBuf::from("voice-coil"));
        let word = self.actuator.clone().or_else(own);
        let Some(word) = word else { return Ok((gains, None)) };
        let setting = Setting::of(&Identified::named(&word)?, gains).map_err(|error| {
            miette!(
                help =
                    "`palpate tune --actuator FILE` finds gains under other limits; give them with --gains KP,KI,KD,N",
                "no gains for the actuator {}: {error}",
                word.display()
            )
        })?;
        Ok((Some(setting.gains), Some(setting.actuator)))
    }
}
