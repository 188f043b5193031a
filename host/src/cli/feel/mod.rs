//! `palpate feel`.

mod board;
mod materials;
mod page;
mod plant;
mod told;

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use miette::{IntoDiagnostic, miette};
use protocol::message::{Actuator, Gains};

use self::plant::Plant;
use super::control_curve::magnets;
use super::gains;
use super::progress::Progress;
use crate::actuator::Actuator as Identified;
use crate::feel::{self, Asked, Display, Felt};
use crate::link::Address;
use crate::ownership::OwnFolder;
use crate::tune::setting::Setting;

/// Folder of files where none is asked for.
const DEFAULT_FOLDER: &str = "out/feel";

/// Materials, and the display that shows them to a simulated hand.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Foams whose curves come with the program, by name, or files of `palpate control-curve`; without any all of the former
    #[arg(value_name = "MATERIAL")]
    materials: Vec<String>,
    /// Which display is pressed
    #[arg(long, value_enum, default_value_t = DisplayWord::All)]
    display: DisplayWord,
    /// The board: sim (a simulated hand presses), or auto (the one on USB), tcp:HOST:PORT, serial:PATH: you press, and
    /// what is scored are its readings
    #[arg(long, default_value = "sim")]
    board: Address,
    /// The table that a real board has, for the numbers of its materials
    #[arg(long, value_name = "FILE")]
    table: Option<PathBuf>,
    /// The true display and hand: frozen, drawn:SEED, voice-coil, drawn-voice-coil:SEED, or a file of constants (`--copy` writes one)
    #[arg(long, default_value = "frozen")]
    plant: Plant,
    /// The actuator that the board is set for: an actuator.toml (`palpate actuator identify`), thesis or voice-coil; gains are
    /// searched for it unless --gains has some [default: the board's own; voice-coil for that plant]
    #[arg(long, value_name = "FILE")]
    actuator: Option<PathBuf>,
    /// The magnet that curves and display are made for: a magnet.toml, readings, or a name; curves are made for it anew
    #[arg(long, value_name = "FILE", default_value = "ring")]
    magnet: String,
    /// The extended model of a display (`palpate diagnose`, [channel.flux], [channel.fluid]): its magnet and fluid are what is
    /// pressed, with the curves for --magnet, and with curves that are made for them anew
    #[arg(long, value_name = "FILE")]
    model: Option<PathBuf>,
    /// The fluid: a fluid.toml, or the name of one that the program knows
    #[arg(long, value_name = "FILE", default_value = "MRF-122EG")]
    fluid: String,
    /// Gains of the position loop, as a board takes them [default: the board's]
    #[arg(long, value_name = "KP,KI,KD,N", value_parser = gains::of_a_board)]
    gains: Option<Gains>,
    /// Seed of tremor and noise
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Folder for the page, its pictures and the samples
    #[arg(long, value_name = "DIR", default_value = DEFAULT_FOLDER)]
    out: PathBuf,
    /// Copy the constants of --plant (frozen or voice-coil) to this new file, to change them, and press nothing
    #[arg(long, value_name = "FILE")]
    copy: Option<PathBuf>,
    /// Press each material three times slowly and three times fast on one --display, write what instruments beside it would have
    /// read to this folder, an experiment for `palpate diagnose`, and score nothing
    #[arg(long, value_name = "DIR", conflicts_with_all = ["copy", "model", "table"])]
    record: Option<PathBuf>,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum DisplayWord {
    /// The cap of the linear actuator
    Actuator,
    /// The fluid in the magnet's gap, its current by the finger's force
    Fluid,
    /// The same, its current by the finger's place
    FluidAtPlace,
    /// All, one after the other
    All,
}

/// Presses, scores and tells.
///
/// # Errors
/// A file with a mistake, a magnet that shows none of the materials, a file that cannot be written.
pub fn run(arguments: &Arguments) -> miette::Result<()> {
    if let Some(copy) = &arguments.copy {
        return super::file::copy(copy, arguments.plant.text()?);
    }
    if let (Some(record), true) = (&arguments.record, arguments.board != Address::Simulated) {
        return Err(miette!(
            "--record is {}: a real board's presses are known by their own readings only; expected --board sim",
            record.display()
        ));
    }
    if arguments.board != Address::Simulated {
        let mut folder = OwnFolder::open(&arguments.out, "--out", Some(DEFAULT_FOLDER)).into_diagnostic()?;
        return tell(&mut folder, arguments, (&board::felt(arguments)?, &[]));
    }
    if let Some(model) = arguments.model.as_ref().filter(|_| arguments.display == DisplayWord::Actuator) {
        return Err(miette!(
            "--model is {}: magnet and fluid of a model change nothing of the actuator; expected another --display",
            model.display()
        ));
    }
    if let (Some(_), &[_, _, ..]) = (&arguments.record, displays(arguments)) {
        return Err(miette!(
            "--record is of one display; expected --display actuator, fluid or fluid-at-place beside it"
        ));
    }
    let constants = arguments.plant.constants()?;
    let (gains, actuator) = setting(arguments)?;
    let wanted = materials::found(&arguments.materials)?;
    let fluid = super::magnet::fluid::found(&arguments.fluid)?;
    let mut folder = match &arguments.record {
        Some(record) => OwnFolder::open(record, "--record", None),
        None => OwnFolder::open(&arguments.out, "--out", Some(DEFAULT_FOLDER)),
    }
    .into_diagnostic()?;
    let progress = Progress::new();
    progress.set("the magnet", 0, 0);
    let most_a = f64::from(protocol::lut::CURRENT_MAX_A);
    let links = magnets::links(&arguments.magnet, &fluid, most_a)?;
    let model = arguments.model.as_ref().map(|model| magnets::modelled(model, &links)).transpose()?;
    let asked = Asked {
        curves: materials::made_for(&wanted, &links)?,
        flux: model.as_ref().unwrap_or(&links).flux.clone(),
        law: model.as_ref().unwrap_or(&links).law.clone(),
        constants,
        gains,
        actuator,
        seed: arguments.seed,
    };
    if arguments.record.is_some() {
        folder.check("experiment.toml").into_diagnostic()?;
        return recorded(&mut folder, arguments, &asked, &progress);
    }
    let all = pressed(&asked, displays(arguments), &progress)?;
    let Some(model) = model else {
        progress.end();
        return tell(&mut folder, arguments, (&all, &[]));
    };
    let asked = Asked { curves: materials::made_for(&wanted, &model)?, ..asked };
    let anew = pressed(&asked, displays(arguments), &progress)?;
    progress.end();
    tell(&mut folder, arguments, (&anew, &all))
}

fn pressed(asked: &Asked, displays: &[Display], progress: &Progress) -> miette::Result<Vec<Felt>> {
    let mut all = Vec::new();
    for display in displays {
        let (what, total) = (told::name(*display), 2 * asked.curves.len());
        all.extend(feel::run(asked, *display, &mut |done| progress.set(what, done, total)).into_diagnostic()?);
    }
    Ok(all)
}

/// Writes presses as an experiment.
fn recorded(folder: &mut OwnFolder, arguments: &Arguments, asked: &Asked, progress: &Progress) -> miette::Result<()> {
    let &[display] = displays(arguments) else { return Ok(()) };
    let (what, total) = (told::name(display), feel::record::PRESSES * asked.curves.len());
    let files = feel::record::presses(asked, display, &mut |done| progress.set(what, done, total)).into_diagnostic()?;
    progress.end();
    files.iter().try_for_each(|(name, _)| folder.check(name)).into_diagnostic()?;
    let written = files.iter().map(|(name, text)| folder.write(name, text.as_bytes()));
    let written: Vec<PathBuf> = written.collect::<std::io::Result<_>>().into_diagnostic()?;
    if arguments.json {
        outln!("{}", serde_json::json!({ "files": crate::cli::file::names(&written) }));
        return Ok(());
    }
    crate::cli::file::told(&written);
    Ok(())
}

/// Writes and prints what was felt, and what of it was felt with the curves before, if there are any.
fn tell(folder: &mut OwnFolder, arguments: &Arguments, (all, before): (&[Felt], &[Felt])) -> miette::Result<()> {
    let files = page::write(folder, arguments, (all, before))?;
    if arguments.json {
        outln!("{}", told::summary(&arguments.plant, arguments.magnet.as_str(), (all, before), &files));
        return Ok(());
    }
    told::print(all);
    told::print_gain(before, all);
    crate::cli::file::told(&files);
    Ok(())
}

/// A model of magnet and fluid changes nothing of the actuator.
fn displays(arguments: &Arguments) -> &'static [Display] {
    match arguments.display {
        DisplayWord::All if arguments.model.is_some() => &[Display::Fluid, Display::FluidAtPlace],
        DisplayWord::Actuator => &[Display::Actuator],
        DisplayWord::Fluid => &[Display::Fluid],
        DisplayWord::FluidAtPlace => &[Display::FluidAtPlace],
        DisplayWord::All => &[Display::Actuator, Display::Fluid, Display::FluidAtPlace],
    }
}

/// What the board is set to: gains, and what it is told of its actuator.
fn setting(arguments: &Arguments) -> miette::Result<(Option<Gains>, Option<Actuator>)> {
    let gains = arguments.gains.clone();
    let own = || arguments.plant.has_voice_coil().then(|| PathBuf::from("voice-coil"));
    let word = arguments.actuator.clone().or_else(own);
    let Some(word) = word else { return Ok((gains, None)) };
    let setting = Setting::of(&Identified::named(&word)?, gains).map_err(|error| {
        miette!(
            help = "`palpate tune --actuator FILE` finds gains under other limits; give them with --gains KP,KI,KD,N",
            "no gains for the actuator {}: {error}",
            word.display()
        )
    })?;
    Ok((Some(setting.gains), Some(setting.actuator)))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use clap::Parser;

    use super::*;

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        arguments: Arguments,
    }

    fn arguments(words: &str) -> Arguments {
        Line::parse_from(std::iter::once("feel").chain(words.split_whitespace())).arguments
    }

    #[test]
    fn what_cannot_be_felt_is_told() {
        for (words, expected) in [
            ("cork", "no file cork, and no curve of this name comes with the program; known are A2, B1, EVA, ICF"),
            ("ICF icf", "ICF is asked for twice"),
            ("EVA --plant x.toml", "--plant is x.toml: no such file; expected frozen, drawn:SEED, voice-coil"),
            ("EVA --actuator x.toml", "x.toml"),
            ("--copy x.toml --plant drawn:1", "--copy with --plant drawn:1; expected frozen or voice-coil"),
            (
                "EVA --display actuator --model m.toml",
                "--model is m.toml: magnet and fluid of a model change nothing of",
            ),
            ("EVA --record r", "--record is of one display; expected --display actuator, fluid or fluid-at-place"),
        ] {
            let text = run(&arguments(words)).unwrap_err().to_string();
            assert!(text.contains(expected), "{words}: {text}");
        }
    }

    #[test]
    fn a_run_leaves_page_pictures_and_samples() {
        let folder = tempfile::tempdir().unwrap();
        let mut asked = arguments("EVA --display all --magnet table-6");
        asked.out = folder.path().join("feel");
        run(&asked).unwrap();
        for name in ["feel.html", "eva-actuator-force.svg", "eva-fluid-force.svg", "eva-actuator.csv", "eva-fluid.csv"]
        {
            let text = std::fs::read_to_string(asked.out.join(name)).unwrap();
            assert!(!text.contains("NaN") && text.len() > 200, "{name}");
        }
    }
}
