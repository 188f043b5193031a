//! `palpate magnet`.

mod files;
pub(super) mod fluid;
mod optimise;
mod set;
mod told;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use clap::{Args, Subcommand, ValueEnum};
use lut_gen::fem::triangle::Order;
use miette::{IntoDiagnostic, WrapErr, miette};

use super::progress::Progress;
use crate::magnet::{BUILT_IN, Magnet, located, names, parse};
use set::set;

/// Folder of files where none is asked for.
const DEFAULT_FOLDER: &str = "out/magnet";

/// Most currents of a run.
const MOST_CURRENTS: usize = 400;

/// A magnet's field over its current.
#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub struct Arguments {
    #[command(subcommand)]
    task: Option<Task>,
    /// A magnet.toml, or the name of a magnet that comes with the program (`palpate magnet list`)
    #[arg(value_name = "FILE", required = true)]
    magnet: Option<String>,
    /// Currents, A: FROM:TO:STEP, or a list with commas; magnets without a coil need none
    #[arg(long, value_name = "A", default_value = "0.25:2.5:0.25")]
    current: String,
    /// A parameter of the file with another value, such as gap=8; more than once for more
    #[arg(long, value_name = "NAME=VALUE")]
    set: Vec<String>,
    /// Order of the triangles; the thesis' program has first-order ones
    #[arg(long, value_enum, default_value_t = OrderArgument::Second)]
    order: OrderArgument,
    /// Multiplies the size of all triangles
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0)]
    coarser: f64,
    /// Write a map for ParaView at every current, not only at the last
    #[arg(long)]
    maps: bool,
    /// Folder for the page, the pictures, readings.csv and the map for ParaView
    #[arg(long, value_name = "DIR", default_value = DEFAULT_FOLDER)]
    out: PathBuf,
    /// Copy the magnet's file to this one, to change it, and compute nothing
    #[arg(long, value_name = "FILE")]
    copy: Option<PathBuf>,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Subcommand)]
enum Task {
    /// Search the strongest magnets for their size, within limits of current, heat and volume
    Optimise(optimise::Arguments),
    /// Show a fluid's flux density and yield stress over field strength
    Fluid(fluid::Arguments),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum OrderArgument {
    First,
    Second,
    Third,
}

/// Computes and shows a magnet's field.
///
/// # Errors
/// A file with a mistake, a drawing that cannot be solved, a file that cannot be written.
pub fn run(arguments: &Arguments) -> miette::Result<()> {
    match &arguments.task {
        Some(Task::Optimise(arguments)) => return optimise::run(arguments),
        Some(Task::Fluid(arguments)) => return fluid::run(arguments),
        None => {}
    }
    let asked = arguments.magnet.as_deref().unwrap_or("list");
    if asked == "list" {
        list();
        return Ok(());
    }
    let (magnet, text) = magnet(asked, &set(&arguments.set)?)?;
    if let Some(copy) = &arguments.copy {
        super::file::copy(copy, &text)?;
        return Ok(());
    }
    if !(0.1..=10.0).contains(&arguments.coarser) {
        return Err(miette!("--coarser is {}; expected 0.1 to 10", arguments.coarser));
    }
    let currents = if magnet.design.coils.is_empty() { vec![0.0] } else { currents(&arguments.current)? };
    let mut wanted = magnet.wanted();
    wanted.coarser = arguments.coarser;
    wanted.order = match arguments.order {
        OrderArgument::First => Order::First,
        OrderArgument::Second => Order::Second,
        OrderArgument::Third => Order::Third,
    };
    let progress = Progress::new();
    let total = currents.len();
    let study = magnet.design.study(&wanted, &currents, &mut |done| progress.set("field at each current", done, total));
    progress.end();
    let study = study.into_diagnostic().wrap_err_with(|| format!("the field of \"{}\"", magnet.title))?;
    let files = files::write(&arguments.out, arguments.maps, &magnet, &study)?;
    if arguments.json {
        outln!("{}", told::summary(&magnet, &study, &files));
    } else {
        told::print(&magnet, &study);
        crate::cli::file::told(&files);
    }
    Ok(())
}

fn list() {
    outln!("Magnets that come with the program; `palpate magnet NAME --copy my.toml` writes one to change it.");
    for magnet in BUILT_IN {
        let title = parse(Path::new(magnet.name), magnet.text, &BTreeMap::new()).map(|m| m.title).unwrap_or_default();
        outln!("  {:18} {title}", magnet.name);
    }
}

/// The magnet of a file or of a name, with its text.
pub(super) fn magnet(asked: &str, set: &BTreeMap<String, f64>) -> miette::Result<(Magnet, String)> {
    let (file, text) = located(Path::new(asked), asked)?
        .ok_or_else(|| miette!("no file {asked}, and no magnet of this name; known are {}", names()))?;
    Ok((parse(&file, &text, set)?, text))
}

/// `0.25:4:0.25`, or `1,2.5`.
fn currents(text: &str) -> miette::Result<Vec<f64>> {
    super::series::numbers("--current", text, ("currents", "A"), MOST_CURRENTS)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use clap::Parser;

    use super::*;

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        arguments: Arguments,
    }

    fn arguments(words: &[&str]) -> Arguments {
        Line::parse_from(std::iter::once("magnet").chain(words.iter().copied())).arguments
    }

    fn told(words: &[&str]) -> String {
        format!("{:?}", run(&arguments(words)).unwrap_err())
    }

    #[test]
    fn third_order_says_what_second_order_says() {
        let folder = tempfile::tempdir().unwrap();
        let read = |order: &str| {
            let mut asked = arguments(&["ring", "--current", "2", "--order", order]);
            asked.out = folder.path().join(order);
            run(&asked).unwrap();
            let csv = std::fs::read_to_string(asked.out.join("readings.csv")).unwrap();
            csv.lines().nth(1).unwrap().split(',').nth(1).unwrap().parse::<f64>().unwrap()
        };
        assert!((read("third") / read("second") - 1.0).abs() < 2e-4);
    }

    #[test]
    fn a_run_leaves_page_pictures_readings_and_map() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("ring");
        let mut asked = arguments(&["ring", "--current", "1,2", "--coarser", "3"]);
        asked.out = out.clone();
        run(&asked).unwrap();
        for name in ["magnet.html", "map.svg", "lines.svg", "current.svg", "readings.csv", "map_001.vtu"] {
            let text = std::fs::read_to_string(out.join(name)).unwrap_or_else(|e| panic!("{name}: {e}"));
            assert!(!text.contains("NaN") && !text.contains("inf "), "{name}");
        }
        assert!(!out.join("map_000.vtu").exists(), "only the last current has a map");
        let csv = std::fs::read_to_string(out.join("readings.csv")).unwrap();
        assert_eq!(csv.lines().count(), 3);
        assert!(csv.starts_with("current_A,centre B_T,centre error_T,"), "{csv}");
        let picture = std::fs::read_to_string(out.join("map.svg")).unwrap();
        assert_eq!(picture.matches("<svg").count(), picture.matches("</svg>").count());
    }

    #[test]
    fn a_copy_is_written_once_and_is_the_same_magnet() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("mine.toml");
        let name = file.to_str().unwrap();
        run(&arguments(&["pot", "--copy", name])).unwrap();
        let none = BTreeMap::new();
        assert_eq!(crate::magnet::read(&file).unwrap().design, magnet("pot", &none).unwrap().0.design);
        assert!(told(&["ring", "--copy", name]).contains("is there already"));
    }

    #[test]
    fn bad_words_are_told_with_what_was_expected() {
        assert!(told(&["rng"]).contains("known are quadrupole"));
        assert!(told(&["ring", "--current", "1:2"]).contains("FROM:TO:STEP"));
        assert!(told(&["ring", "--current", "2:1:0.5"]).contains("TO at least FROM"));
        assert!(told(&["ring", "--current", "1,x"]).contains("\"x\" is no number"));
        assert!(told(&["ring", "--current", "0:1:1e-9"]).contains("more than 400 currents"));
        assert!(told(&["ring", "--set", "gap"]).contains("such as gap=8"));
        assert!(told(&["ring", "--set", "hole=8"]).contains("has no such parameter; it has"));
        assert!(told(&["ring", "--set", "gap=-1"]).contains("the rectangle's width is -1"));
        assert!(told(&["ring", "--coarser", "0"]).contains("expected 0.1 to 10"));
    }

    #[test]
    fn lists_and_ranges_of_currents_are_read() {
        assert_eq!(currents("0.25:1:0.25").unwrap(), [0.25, 0.5, 0.75, 1.0]);
        assert_eq!(currents("2.5").unwrap(), [2.5]);
        assert_eq!(currents("-1,2").unwrap(), [-1.0, 2.0]);
    }
}
