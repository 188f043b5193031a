//! `palpate control-curve`.

pub(super) mod magnets;
mod reach;
pub(super) mod recipe;
mod told;

use std::path::PathBuf;

use clap::{Args, Subcommand};
use miette::{IntoDiagnostic, miette};
use serde_json::json;

use super::progress::Progress;
use crate::control::ControlCurve;
use crate::control::compose::Links;
use crate::control::study::Study;
use crate::finger::opposite::{Block, Opposite};
use crate::ownership::{OwnFolder, file_name};
use crate::report::control as picture;
use recipe::Recipe;

/// Folder of files where none is asked for.
const DEFAULT_FOLDER: &str = "out/control";

/// What coil and actuator must do under a finger's force so that materials are felt.
#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub struct Arguments {
    #[command(subcommand)]
    task: Option<Task>,
    /// Foams of the thesis by name, or model files of `identify --save` and `diagnose`
    #[arg(value_name = "MATERIAL", required = true)]
    materials: Vec<String>,
    /// Height of the specimens, mm; of model files that hold several
    #[arg(long, value_name = "MM")]
    height_mm: Option<f64>,
    #[command(flatten)]
    recipe: Recipe,
    /// Folder for the curves, the page and its pictures
    #[arg(long, value_name = "DIR", default_value = DEFAULT_FOLDER)]
    out: PathBuf,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Subcommand)]
enum Task {
    /// Tell which materials magnets can show, and make their curves for another magnet
    Reach(reach::Arguments),
}

/// A material with its study and its curve.
#[derive(Debug)]
pub(super) struct Made {
    block: Block,
    study: Study,
    curve: ControlCurve,
    /// Travel that was asked for, mm.
    asked_mm: f64,
}

/// Searches and shows the curves.
///
/// # Errors
/// A file with a mistake, a number out of range, a press without equilibrium, a file that cannot be written.
pub fn run(arguments: &Arguments) -> miette::Result<()> {
    if let Some(Task::Reach(arguments)) = &arguments.task {
        return reach::run(arguments);
    }
    arguments.recipe.check()?;
    let blocks = blocks(arguments)?;
    let progress = Progress::new();
    progress.set("the magnet", 0, 0);
    let recipe = arguments.recipe.opened()?;
    let mut folder = OwnFolder::open(&arguments.out, "--out", Some(DEFAULT_FOLDER)).into_diagnostic()?;
    let mut made = Vec::new();
    for block in blocks {
        let told = |what: &str, done: usize| progress.set(&format!("{}: {what}", block.name), done, 0);
        let (study, curve) = recipe.make(&block, &told)?;
        made.push(Made { block, study, curve, asked_mm: arguments.recipe.travel_mm });
    }
    progress.end();
    let links = &recipe.links;
    let files = write(&mut folder, links, &made)?;
    if arguments.json {
        let materials: Vec<_> = made.iter().map(|made| told::summary(made, links)).collect();
        let files = crate::cli::file::names(&files);
        outln!(
            "{}",
            json!({"magnet": links.magnet, "fluid": links.fluid, "finger": recipe.finger.title,
                            "most_yield_kPa": links.most_kpa(), "materials": materials, "files": files})
        );
        return Ok(());
    }
    for made in &made {
        told::print(made, links);
    }
    outln!("{}", magnets::ABOUT_FLUIDS);
    crate::cli::file::told(&files);
    Ok(())
}

/// The materials, every one a foam of the thesis or a model file.
fn blocks(arguments: &Arguments) -> miette::Result<Vec<Block>> {
    let mut blocks = Vec::<Block>::new();
    for asked in &arguments.materials {
        let Opposite::Block(block) = Opposite::located(asked, arguments.height_mm)? else {
            return Err(miette!("{asked} is rigid; expected a foam of the thesis or a model file"));
        };
        if blocks.iter().any(|other| other.name == block.name) {
            return Err(miette!("{} is asked for twice; expected each material once", block.name));
        }
        blocks.push(block);
    }
    Ok(blocks)
}

fn write(folder: &mut OwnFolder, links: &Links, made: &[Made]) -> miette::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    let mut page = crate::report::Page::new("Control curves", &told::subtitle(links));
    page.paragraph(magnets::ABOUT_FLUIDS);
    page.figure(
        &picture::currents(&curves(made)).svg(),
        "Current of the coil over the finger's force, computed (Fig. 61).",
    );
    let mut pictures = Vec::new();
    for made in made {
        page.section(&made.block.name);
        told::sentences(made, links).iter().for_each(|line| page.paragraph(line));
        let mut drawn = Vec::new();
        for (figure, caption) in picture::figures(&made.study, &made.curve) {
            let svg = figure.svg();
            page.figure(&svg, caption);
            drawn.push((format!("{}-{}.svg", file_name(&made.block.name), file_name(&figure.y.label)), svg));
        }
        pictures.push(drawn);
    }
    files.push(folder.write("control.html", page.html().as_bytes()).into_diagnostic()?);
    for (made, drawn) in made.iter().zip(&pictures) {
        let name = format!("{}.csv", file_name(&made.block.name));
        files.push(folder.write(&name, made.curve.to_csv().into_diagnostic()?.as_bytes()).into_diagnostic()?);
        for (name, svg) in drawn {
            files.push(folder.write(name, svg.as_bytes()).into_diagnostic()?);
        }
    }
    Ok(files)
}

fn curves(made: &[Made]) -> Vec<&ControlCurve> {
    made.iter().map(|made| &made.curve).collect()
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

    fn told(words: &str) -> String {
        let words = std::iter::once("control-curve").chain(words.split_whitespace());
        run(&Line::parse_from(words).arguments).unwrap_err().to_string()
    }

    #[test]
    fn what_cannot_be_asked_is_refused_before_anything_is_computed() {
        for (words, expected) in [
            ("ICF --travel-mm 9", "--travel-mm is 9; expected 0.5 to 8 mm"),
            ("ICF --loop-gain 1", "--loop-gain is 1; expected 0.1 to 0.95"),
            ("ICF --current 3", "--current is 3; expected 0.1 to 2.5 A"),
            ("ICF --fluid-mm 20", "--fluid-mm has 1 numbers; expected two with a comma"),
            ("ICF --fluid-elastic 0.01,0.5", "--fluid-elastic (nu) is 0.5; expected 0 to 0.499"),
            ("plate", "plate is rigid; expected a foam of the thesis or a model file"),
            ("ICF icf", "ICF is asked for twice; expected each material once"),
            ("ICF --fluid water", "no file water, and no fluid of this name; known are"),
            ("ICF --finger thumb", "no finger of this name; known are round, thesis"),
        ] {
            let text = told(words);
            assert!(text.contains(expected), "{words}: {text}");
        }
    }

    #[test]
    fn a_file_is_named_after_its_material() {
        assert_eq!(file_name("My foam / 2"), "my-foam-2");
    }
}
