//! `palpate magnet fluid`.

use std::path::{Path, PathBuf};

use clap::Args;
use miette::{IntoDiagnostic, miette};
use serde_json::json;

use crate::magnet::fluid::{NamedFluid, known, names, read};
use crate::ownership::OwnFolder;
use crate::report::{Page, magnet as picture, number};

/// Folder of files where none is asked for.
const DEFAULT_FOLDER: &str = "out/fluid";
/// Field strengths of the table, kA/m.
const ROWS: u32 = 30;

/// A fluid's flux density and yield stress over field strength (Fig. 53 of the thesis).
#[derive(Debug, Args)]
pub struct Arguments {
    /// A fluid.toml, or the name of a fluid that the program knows
    #[arg(value_name = "FILE", default_value = "MRF-122EG")]
    fluid: String,
    /// Yield stresses whose flux density is wanted, kPa, with commas
    #[arg(long, value_name = "KPA", value_delimiter = ',')]
    stress: Vec<f64>,
    /// Largest field strength, kA/m
    #[arg(long, value_name = "KA_M", default_value_t = 300.0)]
    strength: f64,
    /// Folder for the page, its pictures and fluid.csv
    #[arg(long, value_name = "DIR", default_value = DEFAULT_FOLDER)]
    out: PathBuf,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
}

/// Shows a fluid.
///
/// # Errors
/// A file with a mistake, a number out of range, a file that cannot be written.
pub fn run(arguments: &Arguments) -> miette::Result<()> {
    let fluid = found(&arguments.fluid)?;
    if !(1.0..=1e5).contains(&arguments.strength) {
        return Err(miette!("--strength is {}; expected 1 to 100000 kA/m", arguments.strength));
    }
    if let Some(bad) = arguments.stress.iter().find(|kpa| !(**kpa >= 0.0 && kpa.is_finite())) {
        return Err(miette!("--stress is {bad}; expected 0 or more kPa"));
    }
    let rows = rows(&fluid, arguments.strength);
    let answers: Vec<(f64, Option<f64>)> =
        arguments.stress.iter().map(|kpa| (*kpa, fluid.fluid.flux_for_yield(*kpa))).collect();
    let files = write(arguments, &fluid, &rows, &answers)?;
    if arguments.json {
        let answers = answers.iter().map(|(kpa, b_t)| json!({ "yield_kPa": kpa, "B_T": b_t }));
        let rows = rows.iter().map(|[h, b, tau]| json!({ "H_kA_m": h, "B_T": b, "yield_kPa": tau }));
        outln!(
            "{}",
            json!({
                "fluid": fluid.title,
                "source": fluid.source,
                "saturation_kPa": fluid.fluid.saturation_kpa(),
                "curve": rows.collect::<Vec<_>>(),
                "wanted": answers.collect::<Vec<_>>(),
                "files": files,
            })
        );
        return Ok(());
    }
    outln!("{}: {}", fluid.title, fluid.source);
    for line in sentences(&fluid, &answers) {
        outln!("{line}");
    }
    outln!("");
    outln!("{:>8}  {:>8}  {:>10}", "H kA/m", "B T", "yield kPa");
    for [h, b, tau] in rows.iter().step_by(3) {
        outln!("{:>8}  {:>8}  {:>10}", number(*h), format!("{b:.4}"), format!("{tau:.2}"));
    }
    crate::cli::file::told(&files);
    Ok(())
}

/// The fluid of a file or of a name.
pub(in crate::cli) fn found(asked: &str) -> miette::Result<NamedFluid> {
    let file = Path::new(asked);
    if file.is_file() {
        return Ok(read(file)?);
    }
    known(asked).ok_or_else(|| miette!("no file {asked}, and no fluid of this name; known are {}", names().join(", ")))
}

/// Field strength, flux density and yield stress.
fn rows(fluid: &NamedFluid, most: f64) -> Vec<[f64; 3]> {
    let row = |h: f64| [h, fluid.fluid.flux_at_strength(h), fluid.fluid.yield_at_strength(h)];
    (0..=ROWS).map(|i| row(most * f64::from(i) / f64::from(ROWS))).collect()
}

fn sentences(fluid: &NamedFluid, answers: &[(f64, Option<f64>)]) -> Vec<String> {
    let most = fluid.fluid.saturation_kpa();
    let mut lines = vec![format!(
        "It yields at {} kPa at most. Models fitted to the same data differ by 13 to 24 % (Xie, Liu and Cai 2020).",
        number(most)
    )];
    lines.extend(answers.iter().map(|(kpa, b_t)| match b_t {
        Some(b_t) => format!("{} kPa want {} T.", number(*kpa), number(*b_t)),
        None => format!("{} kPa cannot be reached: the fluid saturates at {} kPa.", number(*kpa), number(most)),
    }));
    lines
}

fn write(
    arguments: &Arguments,
    fluid: &NamedFluid,
    rows: &[[f64; 3]],
    answers: &[(f64, Option<f64>)],
) -> miette::Result<Vec<PathBuf>> {
    let mut folder = OwnFolder::open(&arguments.out, "--out", Some(DEFAULT_FOLDER)).into_diagnostic()?;
    let [flux, stress] = picture::fluid(&fluid.title, rows).map(|figure| figure.svg());
    let mut page = Page::new(&fluid.title, &fluid.source);
    for line in sentences(fluid, answers) {
        page.paragraph(&line);
    }
    page.figure(&flux, "Flux density over field strength: what the magnet's elements use.");
    page.figure(&stress, "Yield stress over field strength.");
    let mut csv = "H_kA_m,B_T,yield_kPa\n".to_owned();
    csv.extend(rows.iter().map(|[h, b, tau]| format!("{h},{b},{tau}\n")));
    let texts = [("fluid.html", page.html()), ("flux.svg", flux), ("yield.svg", stress), ("fluid.csv", csv)];
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
        Line::parse_from(std::iter::once("fluid").chain(words.split_whitespace())).arguments
    }

    #[test]
    fn a_fluid_leaves_its_page_and_says_what_cannot_be_reached() {
        let folder = tempfile::tempdir().unwrap();
        let mut asked = arguments("MRF-122EG --stress 10,40");
        asked.out = folder.path().join("fluid");
        run(&asked).unwrap();
        let page = std::fs::read_to_string(asked.out.join("fluid.html")).unwrap();
        assert!(page.contains("10 kPa want 0.27") && page.contains("40 kPa cannot be reached"), "{page}");
        let csv = std::fs::read_to_string(asked.out.join("fluid.csv")).unwrap();
        assert_eq!(csv.lines().count(), 32);
    }

    #[test]
    fn bad_words_are_told_with_what_was_expected() {
        let told = |words: &str| run(&arguments(words)).unwrap_err().to_string();
        assert!(told("oil").contains("known are MRF-122EG, MRF-132DG, MRF-140CG"));
        assert!(told("MRF-122EG --stress=-1").contains("expected 0 or more kPa"));
        assert!(told("MRF-122EG --strength 0").contains("expected 1 to 100000 kA/m"));
    }
}
