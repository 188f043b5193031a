//! `palpate control-curve`.

mod told;

use std::collections::BTreeMap;
use std::path::PathBuf;

use clap::Args;
use miette::{IntoDiagnostic, WrapErr, miette};
use serde_json::json;

use super::progress::Progress;
use crate::control::ControlCurve;
use crate::control::compose::{Links, compose};
use crate::control::study::{Asked, FluidBody, Study};
use crate::finger::Described;
use crate::finger::opposite::{Block, Opposite};
use crate::magnet::fluid::NamedFluid;
use crate::ownership::OwnFolder;
use crate::report::control as picture;

/// Folder of files where none is asked for.
const DEFAULT_FOLDER: &str = "out/control";

/// Currents that the magnet is computed at, up to the driver's largest.
const CURRENTS: usize = 16;

/// What coil and actuator must do under a finger's force so that materials are felt.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Foams of the thesis by name, or model files of `identify --save` and `diagnose`
    #[arg(value_name = "MATERIAL", required = true)]
    materials: Vec<String>,
    /// The magnet: a magnet.toml, or the name of one that comes with the program
    #[arg(long, value_name = "FILE", default_value = "ring")]
    magnet: String,
    /// The finger: a finger.toml, or the name of one that comes with the program
    #[arg(long, value_name = "FILE", default_value = "round")]
    finger: String,
    /// The fluid: a fluid.toml, or the name of one that the program knows
    #[arg(long, value_name = "FILE", default_value = "MRF-122EG")]
    fluid: String,
    /// How far the finger's bone goes, mm
    #[arg(long, value_name = "MM", default_value_t = 4.0)]
    travel_mm: f64,
    /// Height of the specimens, mm; of model files that hold several
    #[arg(long, value_name = "MM")]
    height_mm: Option<f64>,
    /// Length of the finger's elements, mm
    #[arg(long, value_name = "MM", default_value_t = 0.4)]
    element_mm: f64,
    /// Height and radius of the fluid under the finger, mm
    #[arg(long, value_name = "MM,MM", value_delimiter = ',', default_values_t = [25.4, 25.0])]
    fluid_mm: Vec<f64>,
    /// Strain at which the fluid yields, and Poisson's ratio below it (assumed)
    #[arg(long, value_name = "STRAIN,NU", value_delimiter = ',', default_values_t = [0.01, 0.45])]
    fluid_elastic: Vec<f64>,
    /// Largest current of the driver, A
    #[arg(long, value_name = "A", default_value_t = 2.5)]
    current: f64,
    /// Largest loop gain of the display: 1 latches
    #[arg(long, value_name = "GAIN", default_value_t = 0.8)]
    loop_gain: f64,
    /// Do not search the best curve of twelve knots that the cubic is compared with: minutes less
    #[arg(long)]
    quick: bool,
    /// Folder for the curves, the page and its pictures
    #[arg(long, value_name = "DIR", default_value = DEFAULT_FOLDER)]
    out: PathBuf,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
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
    check(arguments)?;
    let finger = crate::finger::located(&arguments.finger)?;
    let fluid = super::magnet::fluid::found(&arguments.fluid)?;
    let blocks = blocks(arguments)?;
    let mut folder = OwnFolder::open(&arguments.out, "--out", Some(DEFAULT_FOLDER)).into_diagnostic()?;
    let progress = Progress::new();
    progress.set("the magnet", 0, 0);
    let links = links(arguments, &fluid)?;
    let mut made = Vec::new();
    for block in blocks {
        let told = |what: &str, done: usize| progress.set(&format!("{}: {what}", block.name), done, 0);
        let study = asked(arguments, &finger, &block)?.study(&told);
        let study = study.into_diagnostic().wrap_err_with(|| format!("the control curve of {}", block.name))?;
        let curve = compose(&study, &links, (&block.name, &finger.title), &provenance(arguments));
        let curve = curve.into_diagnostic().wrap_err_with(|| format!("the control curve of {}", block.name))?;
        made.push(Made { block, study, curve, asked_mm: arguments.travel_mm });
    }
    progress.end();
    let files = write(&mut folder, &links, &made)?;
    if arguments.json {
        let materials: Vec<_> = made.iter().map(|made| told::summary(made, &links)).collect();
        let files: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
        outln!(
            "{}",
            json!({"magnet": links.magnet, "fluid": links.fluid, "finger": finger.title,
                            "most_yield_kPa": links.most_kpa(), "materials": materials, "files": files})
        );
        return Ok(());
    }
    for made in &made {
        told::print(made, &links);
    }
    outln!("{}", told::ABOUT_FLUIDS);
    if let Some(file) = files.first() {
        outln!("written {} and {} more files beside it", file.display(), files.len() - 1);
    }
    Ok(())
}

fn check(arguments: &Arguments) -> miette::Result<()> {
    let within = |name: &str, value: f64, (least, most): (f64, f64), unit: &str| {
        let good = (least..=most).contains(&value);
        good.then_some(()).ok_or_else(|| miette!("--{name} is {value}; expected {least} to {most} {unit}"))
    };
    within("travel-mm", arguments.travel_mm, (0.5, 8.0), "mm")?;
    within("element-mm", arguments.element_mm, (0.1, 1.0), "mm")?;
    within("current", arguments.current, (0.1, f64::from(protocol::lut::CURRENT_MAX_A)), "A")?;
    within("loop-gain", arguments.loop_gain, (0.1, 0.95), "")?;
    for (name, list) in [("fluid-mm", &arguments.fluid_mm), ("fluid-elastic", &arguments.fluid_elastic)] {
        if list.len() != 2 {
            return Err(miette!("--{name} has {} numbers; expected two with a comma", list.len()));
        }
    }
    for (value, what) in arguments.fluid_mm.iter().zip(["height", "radius"]) {
        within(&format!("fluid-mm ({what})"), *value, (2.0, 100.0), "mm")?;
    }
    within("fluid-elastic (strain)", arguments.fluid_elastic[0], (1e-3, 0.2), "")?;
    within("fluid-elastic (nu)", arguments.fluid_elastic[1], (0.0, 0.499), "")
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

/// The magnet's field at currents up to the driver's.
fn links(arguments: &Arguments, fluid: &NamedFluid) -> miette::Result<Links> {
    let asked = &arguments.magnet;
    let (magnet, _) = super::magnet::magnet(asked, &BTreeMap::new())?;
    let currents: Vec<f64> = (1..=CURRENTS).map(|i| arguments.current * i as f64 / CURRENTS as f64).collect();
    let study = magnet.design.study(&magnet.wanted(), &currents, &mut |_| {});
    let study = study.into_diagnostic().wrap_err_with(|| format!("the field of \"{}\"", magnet.title))?;
    let flux = magnet.flux_curve(&study.states).ok_or_else(|| {
        miette!("{asked} has no flux density over current; expected a coil, and `control` naming a point or probe")
    })?;
    let (magnet, fluid, law) = (asked.clone(), fluid.title.clone(), fluid.fluid.clone());
    Ok(Links { magnet, flux, fluid, law, most_a: arguments.current })
}

fn asked(arguments: &Arguments, finger: &Described, block: &Block) -> miette::Result<Asked> {
    let material = block.material().into_diagnostic().wrap_err_with(|| format!("the material {}", block.name))?;
    let mut own = finger.finger.clone();
    own.edge_mm = arguments.element_mm;
    Ok(Asked {
        section: finger.section,
        finger: own,
        material,
        height_mm: block.height_mm,
        fluid: FluidBody {
            height_mm: arguments.fluid_mm[0],
            radius_mm: arguments.fluid_mm[1],
            yield_strain: arguments.fluid_elastic[0],
            nu: arguments.fluid_elastic[1],
        },
        most_mm: arguments.travel_mm,
        best: !arguments.quick,
        most_gain: arguments.loop_gain,
    })
}

/// How a curve was made, without what its file says already.
fn provenance(arguments: &Arguments) -> String {
    format!(
        "palpate {} control-curve: travel {} mm, elements {} mm, fluid {} mm high and {} mm of radius, yield \
         strain {} and nu {}, loop gain at most {}",
        env!("CARGO_PKG_VERSION"),
        arguments.travel_mm,
        arguments.element_mm,
        arguments.fluid_mm[0],
        arguments.fluid_mm[1],
        arguments.fluid_elastic[0],
        arguments.fluid_elastic[1],
        arguments.loop_gain,
    )
}

fn write(folder: &mut OwnFolder, links: &Links, made: &[Made]) -> miette::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    let mut page = crate::report::Page::new("Control curves", &told::subtitle(links));
    page.paragraph(told::ABOUT_FLUIDS);
    page.figure(
        &picture::currents(&curves(made)).svg(),
        "Current of the coil over the finger's force, computed (Fig. 61).",
    );
    for made in made {
        page.section(&made.block.name);
        told::sentences(made, links).iter().for_each(|line| page.paragraph(line));
        for (figure, caption) in picture::figures(&made.study, &made.curve) {
            page.figure(&figure.svg(), caption);
        }
    }
    files.push(folder.write("control.html", page.html().as_bytes()).into_diagnostic()?);
    for made in made {
        let name = format!("{}.csv", file_name(&made.block.name));
        files.push(folder.write(&name, made.curve.to_csv().into_diagnostic()?.as_bytes()).into_diagnostic()?);
        for (figure, _) in picture::figures(&made.study, &made.curve) {
            let name = format!("{}-{}.svg", file_name(&made.block.name), file_name(&figure.y.label));
            files.push(folder.write(&name, figure.svg().as_bytes()).into_diagnostic()?);
        }
    }
    Ok(files)
}

fn curves(made: &[Made]) -> Vec<&ControlCurve> {
    made.iter().map(|made| &made.curve).collect()
}

/// Letters and digits of a name, small, with dashes for all else.
fn file_name(name: &str) -> String {
    let words = name.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
    words.collect::<Vec<_>>().join("-").to_ascii_lowercase()
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
