//! `palpate magnet`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use lut_gen::fem::triangle::Order;
use lut_gen::magnet::curve::FluxCurve;
use lut_gen::magnet::field::Geometry;
use lut_gen::magnet::study::{State, Study};
use lut_gen::magnet::winding::Fit;
use miette::{IntoDiagnostic, WrapErr, miette};
use serde_json::{Value, json};

use super::progress::Progress;
use crate::magnet::{BUILT_IN, Magnet, parse};
use crate::ownership::OwnFolder;
use crate::report::{Page, magnet as picture, number};

/// Folder of files where none is asked for.
const DEFAULT_FOLDER: &str = "out/magnet";

/// Most currents of a run.
const MOST_CURRENTS: usize = 400;

/// A magnet's field over its current.
#[derive(Debug, Args)]
pub struct Arguments {
    /// A magnet.toml, or the name of a magnet that comes with the program (`palpate magnet list`)
    #[arg(value_name = "FILE")]
    magnet: String,
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

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum OrderArgument {
    First,
    Second,
}

/// Computes and shows a magnet's field.
///
/// # Errors
/// A file with a mistake, a drawing that cannot be solved, a file that cannot be written.
pub fn run(arguments: &Arguments) -> miette::Result<()> {
    if arguments.magnet == "list" {
        list();
        return Ok(());
    }
    let (magnet, text) = magnet(&arguments.magnet, &set(&arguments.set)?)?;
    if let Some(copy) = &arguments.copy {
        if copy.exists() {
            return Err(miette!("{} is there already; expected the name of a new file", copy.display()));
        }
        super::file::save(copy, text.as_bytes())?;
        outln!("written {}", copy.display());
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
    };
    let progress = Progress::new();
    let total = currents.len();
    let study = magnet.design.study(&wanted, &currents, &mut |done| progress.set("field at each current", done, total));
    progress.end();
    let study = study.into_diagnostic().wrap_err_with(|| format!("the field of \"{}\"", magnet.title))?;
    let files = write(&arguments.out, arguments.maps, &magnet, &study)?;
    if arguments.json {
        outln!("{}", summary(&magnet, &study, &files));
    } else {
        print(&magnet, &study);
        for file in files.iter().take(1) {
            outln!("written {} and {} more files beside it", file.display(), files.len() - 1);
        }
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

/// `gap=8`, by names.
fn set(list: &[String]) -> miette::Result<BTreeMap<String, f64>> {
    let one = |text: &String| {
        let pair = text.split_once('=').and_then(|(name, value)| Some((name, value.trim().parse::<f64>().ok()?)));
        let (name, value) = pair
            .filter(|(_, value)| value.is_finite())
            .ok_or_else(|| miette!("--set is {text}; expected a parameter and a number, such as gap=8"))?;
        Ok((name.trim().to_owned(), value))
    };
    list.iter().map(one).collect()
}

/// The magnet of a file or of a name, with its text.
fn magnet(asked: &str, set: &BTreeMap<String, f64>) -> miette::Result<(Magnet, String)> {
    let file = Path::new(asked);
    if !file.is_file()
        && let Some(known) = BUILT_IN.iter().find(|m| m.name == asked)
    {
        return Ok((parse(Path::new(known.name), known.text, set)?, known.text.to_owned()));
    }
    if !file.is_file() {
        let names = BUILT_IN.map(|m| m.name).join(", ");
        return Err(miette!("no file {asked}, and no magnet of this name; known are {names}"));
    }
    let text = crate::experiment::text_of(file)?;
    Ok((parse(file, &text, set)?, text))
}

/// `0.25:4:0.25`, or `1,2.5`.
fn currents(text: &str) -> miette::Result<Vec<f64>> {
    let bad = |what: &str| miette!("--current is {text}: {what}; expected FROM:TO:STEP or a list such as 1,2.5, in A");
    let number = |part: &str| {
        let value = part.trim().parse::<f64>().ok().filter(|v| v.is_finite());
        value.ok_or_else(|| bad(&format!("\"{part}\" is no number")))
    };
    let list = match text.split(':').collect::<Vec<_>>().as_slice() {
        [from, to, step] => {
            let (from, to, step) = (number(from)?, number(to)?, number(step)?);
            if step <= 0.0 || to < from {
                return Err(bad("the step must be more than 0, and TO at least FROM"));
            }
            let count = ((to - from) / step + 1e-9).floor();
            if count >= MOST_CURRENTS as f64 {
                return Err(bad(&format!("more than {MOST_CURRENTS} currents")));
            }
            (0..=count as usize).map(|i| from + step * i as f64).collect()
        }
        [_] => text.split(',').map(number).collect::<miette::Result<Vec<_>>>()?,
        _ => return Err(bad("two colons are wanted")),
    };
    if list.len() > MOST_CURRENTS {
        return Err(bad(&format!("more than {MOST_CURRENTS} currents")));
    }
    Ok(list)
}

/// f3: the control curve's flux density over current; `None` without a coil or where it is not told where it is read.
fn curve(magnet: &Magnet, states: &[State]) -> Option<FluxCurve> {
    let read: Option<Vec<_>> = states.iter().map(|s| Some((s.ampere, picture::controlled(magnet, s)?))).collect();
    let read = read.filter(|_| !magnet.design.coils.is_empty())?;
    let error = read.iter().map(|(_, flux)| flux.error_t).fold(0.0, f64::max);
    let mut points: Vec<(f64, f64)> = read.iter().map(|(ampere, flux)| (*ampere, flux.size_t())).collect();
    if points.first().is_some_and(|(ampere, _)| *ampere > 0.0) {
        points.insert(0, (0.0, 0.0));
    }
    FluxCurve::new(&points, error, magnet.built).ok()
}

fn print(magnet: &Magnet, study: &Study) {
    let fine = study.field.unknowns();
    outln!("{}: {} equations", magnet.title, fine);
    if !magnet.source.is_empty() {
        outln!("{}", magnet.source);
    }
    for line in depth_line(magnet).into_iter().chain(winding_lines(magnet, study)) {
        outln!("{line}");
    }
    outln!("");
    let names = picture::names(magnet);
    let width = |name: &str| name.chars().count().max(18);
    let mut head = format!("{:>9}", "current A");
    for (name, _) in &names {
        head.push_str(&format!("  {:>1$}", format!("{name} T"), width(name) + 2));
    }
    if !magnet.design.coils.is_empty() {
        head.push_str(&format!("  {:>18}  {:>13}", "linkage mWb", "inductance mH"));
    }
    outln!("{head}");
    for state in &study.states {
        let mut row = format!("{:>9}", number(state.ampere));
        for (name, look) in &names {
            let flux = look(state);
            row.push_str(&format!("  {:>1$}", give_or_take(flux.size_t(), flux.error_t), width(name) + 2));
        }
        if let Some(linked) = state.linkage_wb.first() {
            let inductance = 1e3 * linked.value / state.ampere;
            row.push_str(&format!("  {:>18}", give_or_take(1e3 * linked.value, 1e3 * linked.error)));
            row.push_str(&format!("  {:>13}", if state.ampere == 0.0 { "-".into() } else { number(inductance) }));
        }
        outln!("{row}");
    }
    if let Some(curve) = curve(magnet, &study.states) {
        outln!("");
        outln!(
            "Control curve: {} T at {} A, read between the points to {} T",
            number(curve.flux_t(curve.most_a())),
            number(curve.most_a()),
            number(curve.bound_t())
        );
    }
}

/// A value with its error, both to the error's second digit.
fn give_or_take(value: f64, error: f64) -> String {
    if !(error > 0.0 && error.is_finite()) {
        return number(value);
    }
    let digits = (1.0 - error.log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{value:.digits$} +- {error:.digits$}")
}

/// What a plane drawing says of the third dimension.
fn depth_line(magnet: &Magnet) -> Option<String> {
    let design = &magnet.design;
    if design.geometry == Geometry::Axisymmetric {
        return None;
    }
    Some(match &design.out_of_plane {
        Some(out) => format!(
            "{} mm deep: flux that leaves the plane is allowed for, to 3.5 % in the gap (air of permeability {})",
            number(design.depth_mm),
            number(out.air(design.depth_mm))
        ),
        None => format!(
            "Plane: as if it were infinitely deep. A magnet that is {} mm deep leaks before and behind.",
            number(design.depth_mm)
        ),
    })
}

fn winding_lines(magnet: &Magnet, study: &Study) -> Vec<String> {
    let mut lines = Vec::new();
    for (i, coil) in magnet.design.coils.iter().enumerate() {
        let w = &coil.winding;
        let windows = magnet.design.window_mm2(i, &study.areas);
        let window = windows.into_iter().filter(|area| *area > 0.0).fold(f64::INFINITY, f64::min);
        let fit = match w.fits(window) {
            Fit::Layered => "fits in layers",
            Fit::Grooved => "fits only with every layer in the grooves of the one below",
            Fit::No => "does NOT fit",
        };
        lines.push(format!(
            "{}: {} turns of {} mm wire, {} m, {} Ohm at 20 C; fills {} % of its smaller window of {} mm2: {fit}",
            coil.name,
            number(w.turns),
            number(w.wire_mm),
            number(w.length_m()),
            number(w.ohm(20.0)),
            number(100.0 * w.filled(window)),
            number(window),
        ));
        let most = study.states.iter().map(|s| (coil.share * s.ampere).abs()).fold(0.0, f64::max);
        let seconds = w.seconds(most);
        let how_long = if seconds.is_finite() { format!("for {} s", number(seconds)) } else { "for ever".to_owned() };
        lines.push(format!(
            "{}: {} A may flow {how_long} ({} W at first, {} to {} C), and {} A for ever",
            coil.name,
            number(most),
            number(most * most * w.ohm(w.room_c)),
            number(w.room_c),
            number(w.limit_c),
            number(w.lasting_a()),
        ));
    }
    lines
}

/// One JSON object: windings, and a row a current.
fn summary(magnet: &Magnet, study: &Study, files: &[PathBuf]) -> Value {
    let names = picture::names(magnet);
    let states = study.states.iter().map(|state| {
        let flux: serde_json::Map<String, Value> = names
            .iter()
            .map(|(name, look)| (*name, look(state)))
            .map(|(name, f)| (name.to_owned(), json!({"B_T": f.size_t(), "components_T": f.b_t, "error_T": f.error_t})))
            .collect();
        let lines: serde_json::Map<String, Value> = magnet
            .lines
            .iter()
            .enumerate()
            .map(|(i, line)| {
                let first = magnet.first_of_line(i);
                let values = (0..line.value.points).map(|k| state.points[first + k].size_t());
                (line.name.clone(), json!(values.collect::<Vec<_>>()))
            })
            .collect();
        let coils = magnet.design.coils.iter().zip(&state.linkage_wb).map(|(coil, linked)| {
            json!({"coil": coil.name, "linkage_Wb": linked.value, "error_Wb": linked.error,
                   "inductance_H": (state.ampere != 0.0).then(|| linked.value / (coil.share * state.ampere))})
        });
        json!({"current_A": state.ampere, "flux": flux, "lines_T": lines, "coils": coils.collect::<Vec<_>>(),
               "energy_J": state.energy_j.value, "coenergy_J": state.coenergy_j.value, "newton_steps": state.steps})
    });
    let coils = magnet.design.coils.iter().enumerate().map(|(i, coil)| {
        let w = &coil.winding;
        let windows = magnet.design.window_mm2(i, &study.areas);
        let window = windows.into_iter().filter(|area| *area > 0.0).fold(f64::INFINITY, f64::min);
        let fits = match w.fits(window) {
            Fit::Layered => "layered",
            Fit::Grooved => "grooved",
            Fit::No => "no",
        };
        let most = study.states.iter().map(|s| (coil.share * s.ampere).abs()).fold(0.0, f64::max);
        let seconds = w.seconds(most);
        json!({"coil": coil.name, "turns": w.turns, "wire_m": w.length_m(), "resistance_20C_Ohm": w.ohm(20.0),
               "window_mm2": window, "filled": w.filled(window), "fits": fits, "lasting_A": w.lasting_a(),
               "largest_current_A": most, "seconds_at_largest": seconds.is_finite().then_some(seconds)})
    });
    let control = curve(magnet, &study.states)
        .map(|c| json!({"most_A": c.most_a(), "most_T": c.flux_t(c.most_a()), "bound_T": c.bound_t()}));
    let files: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
    json!({"title": magnet.title, "depth": depth_line(magnet), "source": magnet.source, "unknowns": study.field.unknowns(),
           "coils": coils.collect::<Vec<_>>(), "states": states.collect::<Vec<_>>(), "control": control, "files": files})
}

/// Writes the page first, then its pictures, the readings and the map of the last current, or of all.
fn write(folder: &Path, all_maps: bool, magnet: &Magnet, study: &Study) -> miette::Result<Vec<PathBuf>> {
    let mut folder = OwnFolder::open(folder, "--out", Some(DEFAULT_FOLDER)).into_diagnostic()?;
    let mut files = Vec::new();
    let mut save = |name: &str, text: &str| -> miette::Result<()> {
        files.push(folder.write(name, text.as_bytes()).into_diagnostic()?);
        Ok(())
    };
    let (Some(state), Some(solution)) = (study.states.last(), study.solutions.last()) else {
        return Err(miette!("no current was asked for; expected at least one"));
    };
    let map = study.field.map(solution);
    let title = format!("Flux density at {} A, computed", number(state.ampere));
    let drawn = picture::map(&title, &magnet.design, &map);
    let along = (!magnet.lines.is_empty()).then(|| picture::along(magnet, state).svg());
    let over = (study.states.len() > 1).then(|| picture::over_current(magnet, &study.states).svg());
    let mut page = Page::new(&magnet.title, &magnet.source);
    page.figure(&drawn, "Bands of |B|, and lines of flux: between two of them flows the same flux.");
    for line in depth_line(magnet).into_iter().chain(winding_lines(magnet, study)) {
        page.paragraph(&line);
    }
    if let Some(svg) = &along {
        page.figure(svg, "Recovered flux density, by finite elements of the file's magnet.");
    }
    if let Some(svg) = &over {
        page.figure(svg, "Errors of discretisation, from two meshes, are smaller than the lines are wide.");
    }
    save("magnet.html", &page.html())?;
    save("map.svg", &drawn)?;
    if let Some(svg) = along {
        save("lines.svg", &svg)?;
    }
    if let Some(svg) = over {
        save("current.svg", &svg)?;
    }
    save("readings.csv", &readings(magnet, study))?;
    let first = if all_maps { 0 } else { study.states.len() - 1 };
    for (i, (state, solution)) in study.states.iter().zip(&study.solutions).enumerate().skip(first) {
        save(&format!("map_{i:03}.vtu"), &study.field.map(solution).vtu(state.ampere))?;
    }
    Ok(files)
}

/// Points and probes, linkage and energy over current.
fn readings(magnet: &Magnet, study: &Study) -> String {
    let names = picture::names(magnet);
    let mut csv = "current_A".to_owned();
    for (name, _) in &names {
        let name = name.replace([',', '"', '\n'], " ");
        csv.push_str(&format!(",{name} B_T,{name} error_T"));
    }
    for coil in &magnet.design.coils {
        csv.push_str(&format!(",{0} linkage_Wb,{0} error_Wb", coil.name.replace(',', " ")));
    }
    csv.push_str(",energy_J,coenergy_J\n");
    for state in &study.states {
        csv.push_str(&state.ampere.to_string());
        for (_, look) in &names {
            let flux = look(state);
            csv.push_str(&format!(",{},{}", flux.size_t(), flux.error_t));
        }
        for linked in &state.linkage_wb {
            csv.push_str(&format!(",{},{}", linked.value, linked.error));
        }
        csv.push_str(&format!(",{},{}\n", state.energy_j.value, state.coenergy_j.value));
    }
    csv
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
        assert!(told(&["ring", "--set", "gap=80"]).contains("region \\\"core\\\""));
        assert!(told(&["ring", "--coarser", "0"]).contains("expected 0.1 to 10"));
    }

    #[test]
    fn lists_and_ranges_of_currents_are_read() {
        assert_eq!(currents("0.25:1:0.25").unwrap(), [0.25, 0.5, 0.75, 1.0]);
        assert_eq!(currents("2.5").unwrap(), [2.5]);
        assert_eq!(currents("-1,2").unwrap(), [-1.0, 2.0]);
    }
}
