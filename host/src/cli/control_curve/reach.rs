//! `palpate control-curve reach`: which materials magnets can show.

use std::path::{Path, PathBuf};

use clap::Args;
use miette::{IntoDiagnostic, miette};
use serde_json::json;

use super::magnets;
use crate::cli::progress::Progress;
use crate::cli::range::within;
use crate::control::compose::Links;
use crate::control::{ControlCurve, CurveError};
use crate::ownership::{OwnFolder, file_name};
use crate::report::{control as picture, number};

/// Folder of files where none is asked for.
const DEFAULT_FOLDER: &str = "out/reach";

/// Curves that exist, and magnets.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Files of `palpate control-curve`; without any the curves that come with the program
    #[arg(value_name = "CURVE")]
    curves: Vec<PathBuf>,
    /// A magnet.toml, readings (.csv with current_A and flux_T), or the name of one that comes with the program; more than
    /// once for more
    #[arg(long, value_name = "FILE", default_values_t = ["ring".to_owned(), "ring-strong".to_owned(), "table-6".to_owned()])]
    magnet: Vec<String>,
    /// The fluid: a fluid.toml, or the name of one that the program knows
    #[arg(long, value_name = "FILE", default_value = "MRF-122EG")]
    fluid: String,
    /// Largest current of the driver, A
    #[arg(long, value_name = "A", default_value_t = 2.5)]
    current: f64,
    /// Folder for the page, its pictures and the curves for every magnet
    #[arg(long, value_name = "DIR", default_value = DEFAULT_FOLDER)]
    out: PathBuf,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
}

/// A magnet, and what it makes of every curve; `None` of one of which it makes nothing.
struct Reach {
    links: Links,
    curves: Vec<Option<ControlCurve>>,
}

/// Tells and writes what magnets can show.
///
/// # Errors
/// A file with a mistake, a number out of range, a file that cannot be written.
pub(super) fn run(arguments: &Arguments) -> miette::Result<()> {
    within("--current", arguments.current, 0.1..=f64::from(protocol::lut::CURRENT_MAX_A), "A")?;
    let wanted = wanted(&arguments.curves)?;
    let fluid = crate::cli::magnet::fluid::found(&arguments.fluid)?;
    let mut folder = OwnFolder::open(&arguments.out, "--out", Some(DEFAULT_FOLDER)).into_diagnostic()?;
    let progress = Progress::new();
    let mut all = Vec::<Reach>::new();
    for (done, asked) in arguments.magnet.iter().enumerate() {
        if all.iter().any(|other| file_name(&other.links.magnet) == file_name(asked)) {
            return Err(miette!("--magnet {asked} is asked for twice; expected each magnet once"));
        }
        progress.set("magnets", done, arguments.magnet.len());
        let links = magnets::links(asked, &fluid, arguments.current)?;
        let curves = wanted.iter().map(|curve| curve.for_magnet(&links).ok()).collect();
        all.push(Reach { links, curves });
    }
    progress.end();
    let files = write(&mut folder, &wanted, &all)?;
    if arguments.json {
        outln!("{}", summary(&wanted, &all, &files));
        return Ok(());
    }
    print(&wanted, &all);
    crate::cli::file::told(&files);
    Ok(())
}

fn wanted(files: &[PathBuf]) -> miette::Result<Vec<ControlCurve>> {
    let mut curves = Vec::<ControlCurve>::new();
    for file in files {
        let curve = ControlCurve::read(file).into_diagnostic()?;
        if curves.iter().any(|other| other.material == curve.material) {
            let other = PathBuf::from("one before");
            return Err(CurveError::Twice { file: file.clone(), other, material: curve.material }).into_diagnostic();
        }
        curves.push(curve);
    }
    Ok(if curves.is_empty() { ControlCurve::all_built_in().collect() } else { curves })
}

/// How well a material is shown by whatever magnet: what the fluid's shape leaves.
fn felt(curve: &ControlCurve) -> String {
    match curve.felt_error {
        Some((force, area)) => format!("force within {:.0} %, area within {:.0} %", 100.0 * force, 100.0 * area),
        None => "nobody tells how well".to_owned(),
    }
}

/// What a magnet makes of a material: the answer in a few words.
fn reached(wanted: &ControlCurve, made: Option<&ControlCurve>) -> String {
    let Some(made) = made else { return "nothing".to_owned() };
    let (from, to) = made.reachable_n;
    let most_a = made.rows.iter().filter(|row| row.force_n <= to).map(|row| row.current_a).fold(0.0, f64::max);
    let current = format!("at most {} A, within {} A", number(most_a), number(made.bound_a));
    if from <= 0.0 && to >= wanted.most_n() {
        format!("all, {current}")
    } else {
        format!("{} to {} N, {current}", number(from), number(to))
    }
}

/// One line a material, a cell a magnet.
fn rows(wanted: &[ControlCurve], all: &[Reach]) -> Vec<Vec<String>> {
    let row = |(at, curve): (usize, &ControlCurve)| {
        let last = curve.rows.last().map_or(0.0, |row| row.travel_mm);
        let own = [
            curve.material.clone(),
            format!("{} N at {} mm", number(curve.most_n()), number(last)),
            number(curve.most_kpa()),
            felt(curve),
        ];
        own.into_iter().chain(all.iter().map(|reach| reached(curve, reach.curves[at].as_ref()))).collect()
    };
    wanted.iter().enumerate().map(row).collect()
}

fn head(all: &[Reach]) -> Vec<String> {
    let own = ["material", "its curve ends at", "largest yield stress, kPa", "however strong the magnet"];
    let magnet = |reach: &Reach| format!("{} ({} kPa at most)", reach.links.magnet, number(reach.links.most_kpa()));
    own.into_iter().map(str::to_owned).chain(all.iter().map(magnet)).collect()
}

fn print(wanted: &[ControlCurve], all: &[Reach]) {
    let head = head(all);
    for row in rows(wanted, all) {
        outln!("{}", row[0]);
        for (name, cell) in head.iter().zip(&row).skip(1) {
            outln!("  {name:<36}  {cell}");
        }
    }
}

fn write(folder: &mut OwnFolder, wanted: &[ControlCurve], all: &[Reach]) -> miette::Result<Vec<PathBuf>> {
    let limits: Vec<(&str, f64)> = all.iter().map(|r| (r.links.magnet.as_str(), r.links.most_kpa())).collect();
    let stresses = picture::reach(wanted, &limits);
    let mut page = crate::report::Page::new("What can be shown", "Finger, fluid and magnets simulated.");
    page.figure(
        &stresses.svg(),
        "Yield stress that every material wants, and the most that every magnet makes (lines across).",
    );
    let head = head(all);
    page.table(&head.iter().map(String::as_str).collect::<Vec<_>>(), &rows(wanted, all));
    page.paragraph(magnets::ABOUT_FLUIDS);
    let mut files = vec![folder.write("reach.svg", stresses.svg().as_bytes()).into_diagnostic()?];
    for reach in all {
        let curves: Vec<&ControlCurve> = reach.curves.iter().flatten().collect();
        let name = file_name(
            Path::new(&reach.links.magnet).file_stem().map_or("magnet".into(), |n| n.to_string_lossy()).as_ref(),
        );
        page.section(&reach.links.magnet);
        page.figure(&picture::currents(&curves).svg(), "Current over force; the light part is beyond the magnet.");
        for curve in curves {
            let file = format!("{}-{name}.csv", file_name(&curve.material));
            files.push(folder.write(&file, curve.to_csv().into_diagnostic()?.as_bytes()).into_diagnostic()?);
        }
    }
    files.insert(0, folder.write("reach.html", page.html().as_bytes()).into_diagnostic()?);
    Ok(files)
}

fn summary(wanted: &[ControlCurve], all: &[Reach], files: &[PathBuf]) -> serde_json::Value {
    let magnet = |at: usize| {
        move |reach: &Reach| {
            let made = reach.curves[at].as_ref();
            json!({
                "magnet": reach.links.magnet, "most_yield_kPa": reach.links.most_kpa(), "most_A": reach.links.most_a,
                "reachable_N": made.map(|curve| [curve.reachable_n.0, curve.reachable_n.1]),
                "bound_A": made.map(|curve| curve.bound_a),
            })
        }
    };
    let material = |(at, curve): (usize, &ControlCurve)| {
        json!({
            "material": curve.material, "most_N": curve.most_n(), "most_yield_kPa": curve.most_kpa(),
            "felt_error": curve.felt_error.map(|(force, area)| json!({"force": force, "area": area})),
            "magnets": all.iter().map(magnet(at)).collect::<Vec<_>>(),
        })
    };
    let files = crate::cli::file::names(files);
    json!({"materials": wanted.iter().enumerate().map(material).collect::<Vec<_>>(), "files": files})
}
