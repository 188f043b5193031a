//! `palpate finger`.

mod computed;
mod files;
mod identify;
mod told;

use std::path::PathBuf;

use clap::{Args, Subcommand};
use lut_gen::pad::body::section::Section;
use lut_gen::pad::hertz::FINGERTIP;
use miette::{IntoDiagnostic, WrapErr, miette};

use super::progress::Progress;
use super::range::within;
use crate::finger::opposite::Opposite;
use crate::finger::press::{Asked, Pressed};
use crate::finger::reading::{Reading, apart};
use crate::finger::{BUILT_IN, located, text_of};
use computed::{DEFAULT_FOLDER, Study, Two};

/// Most travels of a run.
const MOST_TRAVELS: usize = 200;

/// How much longer the elements of a check are.
const COARSER: f64 = 2.0;

/// A finger pressed on things.
#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub struct Arguments {
    #[command(subcommand)]
    task: Option<Task>,
    /// A finger.toml, or the name of a finger that comes with the program (`palpate finger list`)
    #[arg(value_name = "FILE", required = true)]
    finger: Option<String>,
    /// What it is pressed on: plate, a foam of the thesis (EVA, B1, ICF, A2), or a model file of `palpate identify --save`
    #[arg(long, value_name = "WHAT", default_value = "plate")]
    on: String,
    /// Height of the foam, mm; without it that of the thesis' or the model's specimen
    #[arg(long, value_name = "MM")]
    height_mm: Option<f64>,
    /// Radius of the foam, in the plane its half width, mm
    #[arg(long, value_name = "MM", default_value_t = 25.0)]
    radius_mm: f64,
    /// The foam's base slides instead of being bonded
    #[arg(long)]
    slides: bool,
    /// Travels of the bone, mm: FROM:TO:STEP, or a list with commas; without it to 2 mm on a plate and to 4 mm on a foam
    #[arg(long, value_name = "MM")]
    travel_mm: Option<String>,
    /// How fast the bone moves, mm/s; tells only where a layer or the foam relaxes
    #[arg(long, value_name = "MM/S", default_value_t = 2.0)]
    speed_mm_s: f64,
    /// Coefficient of friction between finger and what it is pressed on
    #[arg(long, value_name = "NUMBER", default_value_t = 0.0)]
    friction: f64,
    /// Length of the elements in the pad, mm, instead of the file's
    #[arg(long, value_name = "MM")]
    element_mm: Option<f64>,
    /// Ratio of the print's two radii: adds the contact of an elliptic print, and the force of a finger stretched by it
    #[arg(long, value_name = "NUMBER")]
    ratio: Option<f64>,
    /// Press again with elements twice as long, and say how far force and area are apart
    #[arg(long)]
    check: bool,
    /// Write every state for ParaView, not only the last
    #[arg(long)]
    vtu: bool,
    /// Folder for the page, the pictures, readings.csv and the state for ParaView
    #[arg(long, value_name = "DIR", default_value = DEFAULT_FOLDER)]
    out: PathBuf,
    /// Copy the finger's file to this one, to change it, and compute nothing
    #[arg(long, value_name = "FILE")]
    copy: Option<PathBuf>,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Subcommand)]
enum Task {
    /// Find the finger that makes the prints which were measured
    Identify(identify::Arguments),
}

impl Arguments {
    fn finger(&self) -> &str {
        self.finger.as_deref().unwrap_or("list")
    }
}

/// Presses a finger and shows what is read.
///
/// # Errors
/// A file with a mistake, a press without an equilibrium, a file that cannot be written.
pub fn run(arguments: &Arguments) -> miette::Result<()> {
    if let Some(Task::Identify(arguments)) = &arguments.task {
        return identify::run(arguments);
    }
    if arguments.finger() == "list" {
        list();
        return Ok(());
    }
    if let Some(copy) = &arguments.copy {
        return super::file::copy(copy, &text_of(arguments.finger())?.1);
    }
    let study = study(arguments)?;
    let files = files::write(&arguments.out, arguments.vtu, &study)?;
    if arguments.json {
        outln!("{}", told::summary(&study, &files));
        return Ok(());
    }
    told::print(&study);
    super::file::told(&files);
    Ok(())
}

fn list() {
    outln!("Fingers that come with the program; `palpate finger NAME --copy my.toml` writes one to change it.");
    for finger in BUILT_IN {
        let title = located(finger.name).map(|finger| finger.title).unwrap_or_default();
        outln!("  {:10} {title}", finger.name);
    }
}

/// What the options ask for.
fn asked(arguments: &Arguments) -> miette::Result<Asked> {
    let mut finger = located(arguments.finger())?;
    let on = Opposite::located(&arguments.on, arguments.height_mm)?;
    if let Some(edge) = arguments.element_mm {
        within("--element-mm", edge, 0.02..=5.0, "")?;
        finger.finger.edge_mm = edge;
    }
    within("--radius-mm", arguments.radius_mm, 1.0..=200.0, "")?;
    within("--speed-mm-s", arguments.speed_mm_s, 1e-3..=1e3, "")?;
    within("--friction", arguments.friction, 0.0..=2.0, "")?;
    if let Some(ratio) = arguments.ratio {
        within("--ratio", ratio, 0.5..=2.0, "")?;
    }
    let usual = if on == Opposite::Plate { "0.25:2:0.25" } else { "0.5:4:0.5" };
    let text = arguments.travel_mm.as_deref().unwrap_or(usual);
    let travels_mm = super::series::numbers("--travel-mm", text, ("travels", "mm"), MOST_TRAVELS)?;
    if travels_mm.first().is_none_or(|first| *first <= 0.0) || travels_mm.windows(2).any(|w| w[1] <= w[0]) {
        return Err(miette!("--travel-mm is {text}; expected numbers that rise from more than 0"));
    }
    let (speed_mm_s, friction) = (arguments.speed_mm_s, arguments.friction);
    Ok(Asked { finger, on, travels_mm, speed_mm_s, friction, radius_mm: arguments.radius_mm, slides: arguments.slides })
}

fn study(arguments: &Arguments) -> miette::Result<Study> {
    let asked = asked(arguments)?;
    let progress = Progress::new();
    let press = |asked: &Asked, coarser: f64, what: &str| -> miette::Result<(Pressed, Vec<Reading>)> {
        let total = asked.travels_mm.len();
        progress.set(what, 0, total);
        let pressed = asked.press(coarser, &mut |done| progress.set(what, done, total));
        let pressed = pressed
            .into_diagnostic()
            .wrap_err_with(|| format!("{} on {}, {what}", asked.finger.title, asked.on.name()))?;
        let readings = pressed.states.iter().map(|state| Reading::of(&pressed, state)).collect();
        Ok((pressed, readings))
    };
    let done = press(&asked, 1.0, "the press").and_then(|(pressed, readings)| {
        let apart = match arguments.check {
            true => {
                let (_, coarse) = press(&asked, COARSER, "elements twice as long")?;
                Some(readings.iter().zip(&coarse).map(|(fine, coarse)| apart(fine, coarse)).collect())
            }
            false => None,
        };
        let two = match arguments.ratio {
            Some(ratio) => Some(two(&asked, &readings, ratio, &press)?),
            None => None,
        };
        let hertz = |r: &Reading| FINGERTIP.force_n(asked.on.elastic(), r.travel_mm);
        let sphere_n = (pressed.section == Section::Ring).then(|| readings.iter().map(hertz).collect());
        Ok((pressed, readings, apart, sphere_n, two))
    });
    progress.end();
    let (pressed, readings, apart, sphere_n, two) = done?;
    Ok(Study { asked, pressed, readings, apart, sphere_n, two })
}

/// A press and its readings.
type PressOf<'a> = &'a dyn Fn(&Asked, f64, &str) -> miette::Result<(Pressed, Vec<Reading>)>;

/// The contact with two radii, and the force of the finger that is stretched to them.
fn two(asked: &Asked, readings: &[Reading], ratio: f64, press: PressOf<'_>) -> miette::Result<Two> {
    let prints = readings.iter().map(|r| r.print(ratio)).collect::<Result<_, _>>().into_diagnostic()?;
    let mut wide = asked.clone();
    wide.finger.finger = asked.finger.finger.stretched(ratio);
    let (_, stretched) = press(&wide, 1.0, "the stretched finger")?;
    let stretched = stretched.iter().zip(readings).map(|(wide, own)| wide.force_n / own.force_n).collect();
    Ok(Two { ratio, prints, stretched })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::panic)]
    use clap::Parser;

    use super::*;

    #[derive(Debug, Parser)]
    struct Line {
        #[command(flatten)]
        arguments: Arguments,
    }

    fn arguments(words: &[&str]) -> Arguments {
        Line::try_parse_from(std::iter::once("finger").chain(words.iter().copied())).unwrap().arguments
    }

    fn told(words: &[&str]) -> String {
        let error = run(&arguments(words)).unwrap_err();
        error.chain().map(ToString::to_string).collect::<Vec<_>>().join(": ")
    }

    #[test]
    fn a_run_leaves_page_pictures_readings_and_state() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("finger");
        let words = ["round", "--on", "ICF", "--travel-mm", "1,2", "--element-mm", "0.5", "--check", "--ratio", "1.2"];
        let mut asked = arguments(&words);
        asked.out = out.clone();
        run(&asked).unwrap();
        let pictures =
            ["map.svg", "force.svg", "area.svg", "area_force.svg", "pressure.svg", "histogram.svg", "mises.svg"];
        for name in pictures.into_iter().chain(["finger.html", "readings.csv", "state_001.vtu"]) {
            let text = std::fs::read_to_string(out.join(name)).unwrap_or_else(|e| panic!("{name}: {e}"));
            assert!(!text.contains("NaN") && !text.contains("inf "), "{name}");
            assert_eq!(text.matches("<svg").count(), text.matches("</svg>").count(), "{name}");
        }
        assert!(!out.join("state_000.vtu").exists(), "only the last travel has a state");
        let csv = std::fs::read_to_string(out.join("readings.csv")).unwrap();
        assert_eq!(csv.lines().count(), 3);
        assert!(csv.starts_with("travel_mm,force_N,radius_mm,"), "{csv}");
    }

    /// What the summary says of both kinds of press.
    #[test]
    fn the_summary_has_a_row_a_travel_and_the_sphere() {
        let words = ["round", "--travel-mm", "0.5,1", "--element-mm", "0.4", "--ratio", "1.2", "--check"];
        let study = study(&arguments(&words)).unwrap();
        let json = told::summary(&study, &[]);
        let rows = json["travels"].as_array().unwrap();
        assert_eq!(rows.len(), 2);
        let ratio = rows[1]["hertz_over_finger"].as_f64().unwrap();
        // 4/3 x 0.16827 MPa x sqrt(5 mm) over the reference's 0.3615 N at 1 mm
        assert!((ratio / (0.50168 / 0.3615) - 1.0).abs() < 0.02, "{ratio}");
        assert!(rows[1]["two_radii"]["force_over_round"].as_f64().unwrap() > 1.0);
        assert!(rows[1]["error"]["force"].as_f64().unwrap() < 0.02 && rows[1]["mises"].is_null());
        let lines = told::remarks(&study);
        assert!(lines.iter().any(|line| line.contains("Hertz' fingertip") && line.contains("126.2 kPa")), "{lines:?}");
    }

    #[test]
    fn a_copy_is_written_once_and_is_the_same_finger() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("mine.toml");
        let name = file.to_str().unwrap();
        run(&arguments(&["thesis", "--copy", name])).unwrap();
        assert_eq!(crate::finger::read(&file).unwrap().finger, located("thesis").unwrap().finger);
        assert!(told(&["round", "--copy", name]).contains("is there already"));
    }

    #[test]
    fn bad_words_are_told_with_what_was_expected() {
        assert!(told(&["thumb"]).contains("known are round, thesis"));
        assert!(told(&["round", "--on", "cheese"]).contains("expected plate, EVA, B1, ICF, A2, or a model file"));
        assert!(told(&["round", "--travel-mm", "1:2"]).contains("FROM:TO:STEP"));
        assert!(told(&["round", "--travel-mm", "2,1"]).contains("expected numbers that rise from more than 0"));
        assert!(told(&["round", "--friction", "3"]).contains("--friction is 3; expected 0 to 2"));
        assert!(told(&["round", "--ratio", "9"]).contains("--ratio is 9; expected 0.5 to 2"));
        assert!(told(&["round", "--element-mm", "0"]).contains("--element-mm is 0; expected 0.02 to 5"));
        let stuck = told(&["round", "--travel-mm", "5.5", "--element-mm", "1"]);
        assert!(stuck.contains("no equilibrium after") && stuck.contains("on a rigid plate, the press"), "{stuck}");
    }
}
