//! `palpate feel`.

mod board;
mod told;

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use firmware::pid::{GAIN_CEILING, gains_are_usable};
use miette::{IntoDiagnostic, miette};
use protocol::message::{Actuator, Gains};

use super::control_curve::magnets;
use super::progress::Progress;
use crate::actuator::Actuator as Identified;
use crate::control::ControlCurve;
use crate::control::compose::Links;
use crate::experiment::ExperimentError;
use crate::feel::{self, Asked, Display, Felt};
use crate::link::Address;
use crate::ownership::{OwnFolder, file_name};
use crate::plant::Constants;
use crate::report::{Page, feel as picture};
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
    #[arg(long, value_name = "PLANT", default_value = "frozen")]
    plant: String,
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
    #[arg(long, value_name = "KP,KI,KD,N", value_parser = gains)]
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
        return super::file::copy(copy, copied(&arguments.plant)?);
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
    let constants = constants(&arguments.plant)?;
    let (gains, actuator) = setting(arguments)?;
    let wanted = materials(&arguments.materials)?;
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
        curves: made_for(&wanted, &links)?,
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
    let asked = Asked { curves: made_for(&wanted, &model)?, ..asked };
    let anew = pressed(&asked, displays(arguments), &progress)?;
    progress.end();
    tell(&mut folder, arguments, (&anew, &all))
}

/// Curves for a magnet.
fn made_for(curves: &[ControlCurve], links: &Links) -> miette::Result<Vec<ControlCurve>> {
    let made = |curve: &ControlCurve| {
        let made = curve.for_magnet(links);
        made.map_err(|error| miette!("{} with the magnet {}: {error}", curve.material, links.magnet))
    };
    curves.iter().map(made).collect()
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
    let files = write(folder, arguments, (all, before))?;
    if arguments.json {
        outln!("{}", told::summary(arguments.plant.as_str(), arguments.magnet.as_str(), (all, before), &files));
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

/// The constants that come with the program under a name.
fn copied(plant: &str) -> miette::Result<&'static str> {
    match plant {
        "frozen" => Ok(Constants::FROZEN),
        "voice-coil" => Ok(Constants::VOICE_COIL),
        _ => Err(miette!(
            "--copy with --plant {plant}; expected frozen or voice-coil, whose files come with the program"
        )),
    }
}

/// What the board is set to: gains, and what it is told of its actuator.
fn setting(arguments: &Arguments) -> miette::Result<(Option<Gains>, Option<Actuator>)> {
    let gains = arguments.gains.clone();
    let has_coil = arguments.plant == "voice-coil" || arguments.plant.starts_with("drawn-voice-coil:");
    let word = arguments.actuator.clone().or_else(|| has_coil.then(|| PathBuf::from("voice-coil")));
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

/// Gains as text.
fn gains(text: &str) -> Result<Gains, String> {
    let numbers: Result<Vec<f32>, _> = text.split(',').map(|number| number.trim().parse()).collect();
    let Ok(&[kp, ki, kd, n]) = numbers.as_deref() else {
        return Err("expected four numbers with commas, KP,KI,KD,N".to_owned());
    };
    let gains = Gains { kp, ki, kd, n };
    if !gains_are_usable(&gains) {
        let Gains { kp, ki, kd, n } = GAIN_CEILING;
        return Err(format!("no board takes these; expected 0 to {kp}, {ki} and {kd}, and N more than 0 to {n}"));
    }
    Ok(gains)
}

fn constants(plant: &str) -> miette::Result<Constants> {
    if plant == "frozen" {
        return Ok(Constants::frozen()?);
    }
    if plant == "voice-coil" {
        return Ok(Constants::voice_coil()?);
    }
    let draw = |seed: &str, word: &str, drawn: fn(u64) -> Result<Constants, ExperimentError>| {
        let seed = seed.parse().map_err(|_| miette!("--plant is {plant}; expected {word}: with a whole number"))?;
        Ok(drawn(seed)?)
    };
    match plant.split_once(':') {
        Some((word @ "drawn", seed)) => return draw(seed, word, Constants::drawn),
        Some((word @ "drawn-voice-coil", seed)) => return draw(seed, word, Constants::voice_coil_drawn),
        _ => {}
    }
    let file = Path::new(plant);
    if !file.is_file() {
        return Err(miette!(
            "--plant is {plant}: no such file; expected frozen, drawn:SEED, voice-coil, drawn-voice-coil:SEED, or a file of constants"
        ));
    }
    Ok(Constants::read(file)?)
}

fn materials(asked: &[String]) -> miette::Result<Vec<ControlCurve>> {
    if asked.is_empty() {
        return Ok(ControlCurve::all_built_in().collect());
    }
    let mut curves = Vec::<ControlCurve>::new();
    for asked in asked {
        let curve = match ControlCurve::built_in(asked).filter(|_| !Path::new(asked).is_file()) {
            Some(curve) => curve,
            None if Path::new(asked).is_file() => ControlCurve::read(Path::new(asked)).into_diagnostic()?,
            None => {
                let known: Vec<String> = ControlCurve::all_built_in().map(|curve| curve.material).collect();
                return Err(miette!(
                    "no file {asked}, and no curve of this name comes with the program; known are {}; `palpate control-curve` \
                     makes others",
                    known.join(", ")
                ));
            }
        };
        if curves.iter().any(|other| other.material == curve.material) {
            return Err(miette!("{} is asked for twice; expected each material once", curve.material));
        }
        curves.push(curve);
    }
    Ok(curves)
}

fn write(
    folder: &mut OwnFolder,
    arguments: &Arguments,
    (all, before): (&[Felt], &[Felt]),
) -> miette::Result<Vec<PathBuf>> {
    let is_read = all.iter().any(|felt| felt.is_read);
    let subtitle = if is_read { told::READ[0].to_owned() } else { told::subtitle(&arguments.plant, &arguments.magnet) };
    let mut page = Page::new("What is felt", &subtitle);
    page.table(&told::HEAD, &told::rows(all));
    page.list(&told::notes(all).map(str::to_owned));
    if !before.is_empty() {
        page.section("What curves for the model gain");
        page.table(&told::GAIN, &told::gains(before, all));
    }
    let mut files = Vec::new();
    for felt in all {
        let name = format!("{}-{}", file_name(&felt.curve.material), told::word(felt.display));
        page.section(&format!("{}, {}", felt.curve.material, told::name(felt.display)));
        for (what, figure, caption) in picture::figures(felt) {
            let svg = figure.svg();
            page.figure(&svg, caption);
            files.push(folder.write(&format!("{name}-{what}.svg"), svg.as_bytes()).into_diagnostic()?);
        }
        files.push(folder.write(&format!("{name}.csv"), told::csv(felt).as_bytes()).into_diagnostic()?);
    }
    files.insert(0, folder.write("feel.html", page.html().as_bytes()).into_diagnostic()?);
    Ok(files)
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
            (
                "EVA --plant drawn-voice-coil:x",
                "--plant is drawn-voice-coil:x; expected drawn-voice-coil: with a whole number",
            ),
            ("EVA --actuator x.toml", "x.toml"),
            ("--copy x.toml --plant drawn:1", "--copy with --plant drawn:1; expected frozen or voice-coil"),
            (
                "EVA --display actuator --model m.toml",
                "--model is m.toml: magnet and fluid of a model change nothing of",
            ),
            ("EVA --plant drawn:x", "--plant is drawn:x; expected drawn: with a whole number"),
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
