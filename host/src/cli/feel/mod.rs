//! `palpate feel`.

mod arguments;
mod board;
mod materials;
mod page;
mod plant;
mod told;

use std::path::PathBuf;

use miette::{IntoDiagnostic, miette};

pub use self::arguments::Arguments;
use self::arguments::{DEFAULT_FOLDER, DisplayWord};
use super::control_curve::magnets;
use super::progress::Progress;
use crate::feel::{self, Asked, Display, Felt};
use crate::link::Address;
use crate::ownership::OwnFolder;

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
    if let (Some(_), &[_, _, ..]) = (&arguments.record, arguments.displays()) {
        return Err(miette!(
            "--record is of one display; expected --display actuator, fluid or fluid-at-place beside it"
        ));
    }
    let constants = arguments.plant.constants()?;
    let (gains, actuator) = arguments.setting()?;
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
    let all = pressed(&asked, arguments.displays(), &progress)?;
    let Some(model) = model else {
        progress.end();
        return tell(&mut folder, arguments, (&all, &[]));
    };
    let asked = Asked { curves: materials::made_for(&wanted, &model)?, ..asked };
    let anew = pressed(&asked, arguments.displays(), &progress)?;
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
    let &[display] = arguments.displays() else { return Ok(()) };
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
