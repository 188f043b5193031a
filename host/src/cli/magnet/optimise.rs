//! `palpate magnet optimise`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use clap::Args;
use miette::{IntoDiagnostic, miette};
use serde_json::json;

use super::super::progress::Progress;
use super::set::set;
use crate::magnet::search::{Candidate, Limits, Settings, Source, Variable, search};
use crate::magnet::{located, names, parse};
use crate::ownership::OwnFolder;
use crate::report::{Page, magnet as picture, number};

/// Folder of files where none is asked for.
const DEFAULT_FOLDER: &str = "out/magnet-search";

/// The strongest magnets for their size, within limits.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Magnet files, or names of magnets that come with the program
    #[arg(value_name = "FILE", required = true)]
    magnets: Vec<String>,
    /// A parameter of the files to vary: NAME=FROM:TO, or NAME=FROM:TO:STEP
    #[arg(long, value_name = "RANGE", required = true)]
    vary: Vec<String>,
    /// A parameter with another value, such as depth=12; more than once for more
    #[arg(long, value_name = "NAME=VALUE")]
    set: Vec<String>,
    /// Flux density that is wanted where the control curve is read, T
    #[arg(long, value_name = "T")]
    wanted: Option<f64>,
    /// Largest current of the driver, A (the thesis' limit)
    #[arg(long, value_name = "A", default_value_t = 2.5)]
    current: f64,
    /// Largest voltage across a hot coil, V
    #[arg(long, value_name = "V", default_value_t = 24.0)]
    volts: f64,
    /// How long the current must be able to flow from the room's temperature, s, or "ever"
    #[arg(long, value_name = "S", default_value = "10")]
    seconds: String,
    /// Largest box around the magnet, cm^3
    #[arg(long, value_name = "CM3", default_value_t = 1000.0)]
    volume: f64,
    /// Magnets that are looked at, for each file
    #[arg(long, value_name = "COUNT", default_value_t = 384)]
    evaluations: usize,
    /// Seed of the search's chance
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Folder for the page, the picture and front.csv
    #[arg(long, value_name = "DIR", default_value = DEFAULT_FOLDER)]
    out: PathBuf,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
}

/// Searches, and shows the front.
///
/// # Errors
/// A bad range, a file with a mistake, limits that no magnet keeps, a file that cannot be written.
pub fn run(arguments: &Arguments) -> miette::Result<()> {
    let limits = limits(arguments)?;
    let sources = sources(arguments)?;
    let settings = Settings { evaluations: arguments.evaluations, seed: arguments.seed };
    let progress = Progress::new();
    let found = search(&sources, &limits, settings, &mut |done, of| progress.set("magnets", done, of));
    progress.end();
    let front = found.into_diagnostic()?;
    let best = best(&front, arguments.wanted);
    let files = write(arguments, &sources, &limits, &front, best)?;
    if arguments.json {
        outln!("{}", summary(&sources, &front, arguments.wanted, best, &files));
        return Ok(());
    }
    for line in answer(&sources, &front, arguments.wanted, best) {
        outln!("{line}");
    }
    outln!("");
    for row in table(&sources, &front) {
        outln!("{}", row.iter().map(|cell| format!("{cell:>12}")).collect::<Vec<_>>().join("  "));
    }
    crate::cli::file::told(&files);
    Ok(())
}

fn limits(arguments: &Arguments) -> miette::Result<Limits> {
    let positive = |name: &str, value: f64, unit: &str| {
        let good = value > 0.0 && value.is_finite();
        good.then_some(value).ok_or_else(|| miette!("--{name} is {value}; expected more than 0 {unit}"))
    };
    if !(4..=100_000).contains(&arguments.evaluations) {
        return Err(miette!("--evaluations is {}; expected 4 to 100000", arguments.evaluations));
    }
    if let Some(wanted) = arguments.wanted {
        positive("wanted", wanted, "T")?;
    }
    let seconds = match arguments.seconds.trim() {
        "ever" => f64::INFINITY,
        text => {
            let value = text.parse().map_err(|_| miette!("--seconds is {text}; expected seconds, or \"ever\""))?;
            positive("seconds", value, "s")?
        }
    };
    Ok(Limits {
        current_a: positive("current", arguments.current, "A")?,
        volts: positive("volts", arguments.volts, "V")?,
        seconds,
        volume_cm3: positive("volume", arguments.volume, "cm^3")?,
    })
}

/// The files with what is varied of each: a parameter that a file has not is left out there, and one that no file has is
/// an error.
fn sources(arguments: &Arguments) -> miette::Result<Vec<Source>> {
    let variables: Vec<Variable> = arguments
        .vary
        .iter()
        .map(|text| Variable::parse(text).map_err(|e| miette!("{e}")))
        .collect::<Result<_, _>>()?;
    let fixed = set(&arguments.set)?;
    let mut sources = Vec::new();
    let mut known: BTreeMap<String, ()> = BTreeMap::new();
    for asked in &arguments.magnets {
        let (path, text) = located(Path::new(asked), asked)?
            .ok_or_else(|| miette!("no file {asked}, and no magnet of this name; known are {}", names()))?;
        let magnet = parse(&path, &text, &fixed)?;
        if magnet.control.is_none() {
            return Err(miette!("{asked} has no `control`; expected the point or probe whose flux density is wanted"));
        }
        known.extend(magnet.parameters.0.keys().map(|name| (name.clone(), ())));
        let own = variables.iter().filter(|v| magnet.parameters.0.contains_key(&v.name)).cloned();
        let fixed = fixed.iter().map(|(name, value)| Variable::fixed(name, *value));
        sources.push(Source { name: asked.clone(), path, text, variables: own.chain(fixed).collect() });
    }
    for variable in &variables {
        if !known.contains_key(&variable.name) {
            let known: Vec<&str> = known.keys().map(String::as_str).collect();
            return Err(miette!(
                "--vary {}: no file has such a parameter; known are {}",
                variable.name,
                known.join(", ")
            ));
        }
    }
    Ok(sources)
}

/// The smallest magnet that surely has what is wanted.
fn best(front: &[Candidate], wanted: Option<f64>) -> Option<usize> {
    let wanted = wanted?;
    front.iter().position(|candidate| candidate.flux.size_t() - candidate.flux.error_t >= wanted)
}

/// What was found, in sentences.
fn answer(sources: &[Source], front: &[Candidate], wanted: Option<f64>, best: Option<usize>) -> Vec<String> {
    let strongest = front.last().map_or(f64::NAN, |candidate| candidate.flux.size_t());
    let mut lines = match (wanted, best.map(|i| &front[i])) {
        (Some(wanted), Some(found)) => vec![
            format!(
                "{} T are met by a magnet of {} cm^3: {} T at {} A.",
                number(wanted),
                number(found.volume_cm3),
                number(found.flux.size_t()),
                number(found.current_a)
            ),
            format!("Look at it: {}", command(sources, found)),
        ],
        (Some(wanted), None) => {
            vec![format!("{} T are not met: the strongest magnet found has {} T.", number(wanted), number(strongest))]
        }
        (None, _) => vec![format!("The strongest magnet found has {} T.", number(strongest))],
    };
    lines.push("A front that a search found: a better magnet may exist, a worse one need not be built.".to_owned());
    lines
}

/// The command that computes a magnet of the front.
fn command(sources: &[Source], candidate: &Candidate) -> String {
    let set = candidate.set.iter().map(|(name, value)| format!(" --set {name}={}", number(*value)));
    let name = &sources[candidate.file].name;
    format!("palpate magnet {name} --current {}{}", number(candidate.current_a), set.collect::<String>())
}

/// A head and a row a magnet.
fn table(sources: &[Source], front: &[Candidate]) -> Vec<Vec<String>> {
    let mut varied: Vec<&str> = sources.iter().flat_map(|s| s.variables.iter().map(|v| v.name.as_str())).collect();
    varied.sort_unstable();
    varied.dedup();
    let head = ["volume cm^3", "B T", "+- T", "current A", "heat W", "file"].into_iter().chain(varied.iter().copied());
    let row = |candidate: &Candidate| {
        let flux = &candidate.flux;
        let numbers = [candidate.volume_cm3, flux.size_t(), flux.error_t, candidate.current_a, candidate.watt];
        let varied = varied.iter().map(|name| candidate.set.get(*name).map_or("-".to_owned(), |value| number(*value)));
        numbers.map(number).into_iter().chain([sources[candidate.file].name.clone()]).chain(varied).collect()
    };
    std::iter::once(head.map(str::to_owned).collect()).chain(front.iter().map(row)).collect()
}

fn summary(
    sources: &[Source],
    front: &[Candidate],
    wanted: Option<f64>,
    best: Option<usize>,
    files: &[PathBuf],
) -> serde_json::Value {
    let one = |candidate: &Candidate| {
        json!({
            "file": sources[candidate.file].name,
            "parameters": candidate.set,
            "volume_cm3": candidate.volume_cm3,
            "current_A": candidate.current_a,
            "heat_W": candidate.watt,
            "flux_T": candidate.flux.size_t(),
            "flux_error_T": candidate.flux.error_t,
        })
    };
    json!({
        "front": front.iter().map(one).collect::<Vec<_>>(),
        "wanted_T": wanted,
        "met_by": best.map(|i| one(&front[i])),
        "command": best.map(|i| command(sources, &front[i])),
        "files": files,
    })
}

fn write(
    arguments: &Arguments,
    sources: &[Source],
    limits: &Limits,
    front: &[Candidate],
    best: Option<usize>,
) -> miette::Result<Vec<PathBuf>> {
    let mut folder = OwnFolder::open(&arguments.out, "--out", Some(DEFAULT_FOLDER)).into_diagnostic()?;
    let names: Vec<&str> = sources.iter().map(|source| source.name.as_str()).collect();
    let drawn = picture::front(&names, front, arguments.wanted).svg();
    let rows = table(sources, front);
    let mut page = Page::new(
        "Magnets: flux density for their size",
        &format!(
            "At most {} A and {} V, for {}, in {} cm^3. {} magnets of each file were looked at, seed {}.",
            number(limits.current_a),
            number(limits.volts),
            if limits.seconds.is_finite() { format!("{} s", number(limits.seconds)) } else { "ever".to_owned() },
            number(limits.volume_cm3),
            arguments.evaluations,
            arguments.seed
        ),
    );
    for line in answer(sources, front, arguments.wanted, best) {
        page.paragraph(&line);
    }
    page.figure(
        &drawn,
        "Computed by finite elements on two meshes; no other magnet that was looked at is smaller and as strong.",
    );
    let head: Vec<&str> = rows[0].iter().map(String::as_str).collect();
    page.table(&head, &rows[1..]);
    let csv = rows.iter().map(|row| row.join(",").replace(" cm^3", "_cm3").replace(' ', "_")).collect::<Vec<_>>();
    let texts =
        [("search.html", page.html()), ("front.svg", drawn.clone()), ("front.csv", format!("{}\n", csv.join("\n")))];
    texts.iter().map(|(name, text)| folder.write(name, text.as_bytes()).into_diagnostic()).collect()
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
        Line::parse_from(std::iter::once("optimise").chain(words.split_whitespace())).arguments
    }

    fn told(words: &str) -> String {
        run(&arguments(words)).unwrap_err().to_string()
    }

    #[test]
    fn a_search_leaves_a_front_that_rises_and_a_magnet_that_is_met() {
        let folder = tempfile::tempdir().unwrap();
        let mut asked = arguments(
            "ring --vary gap=4:10 --vary turns=300:1200:10 --vary wire=24:32:1 --evaluations 64 --wanted 0.3",
        );
        asked.out = folder.path().join("search");
        run(&asked).unwrap();
        let csv = std::fs::read_to_string(asked.out.join("front.csv")).unwrap();
        let rows: Vec<Vec<f64>> =
            csv.lines().skip(1).map(|line| line.split(',').filter_map(|cell| cell.parse().ok()).collect()).collect();
        assert!(!rows.is_empty() && rows.last().unwrap()[1] > 0.3, "{csv}");
        assert!(rows.windows(2).all(|pair| pair[0][0] <= pair[1][0] && pair[0][1] <= pair[1][1]), "{csv}");
        let page = std::fs::read_to_string(asked.out.join("search.html")).unwrap();
        assert!(page.contains("0.3 T are met by a magnet of") && !page.contains("NaN"));
    }

    #[test]
    fn bad_words_are_told_with_what_was_expected() {
        assert!(told("ring --vary gap").contains("there is no ="));
        assert!(told("ring --vary hole=1:2").contains("no file has such a parameter; known are"));
        assert!(told("ring --vary gap=4:8 --seconds soon").contains("expected seconds, or \"ever\""));
        assert!(told("ring --vary gap=4:8 --current 0").contains("--current is 0; expected more than 0 A"));
        assert!(told("rung --vary gap=4:8").contains("known are quadrupole"));
        let large = told("ring --vary gap=4:8 --volume 1 --evaluations 8");
        assert!(large.contains("none of 8 magnets is within the limits; the nearest is too large, by"), "{large}");
    }
}
