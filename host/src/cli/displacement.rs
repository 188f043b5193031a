//! `palpate displacement`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use miette::IntoDiagnostic;
use serde_json::json;

use super::range::within;
use crate::displacement::table::Displacement;
use crate::displacement::{Cap, Tables, tables};
use crate::ownership::{OwnFolder, file_name};
use crate::report::Page;
use crate::report::displacement as picture;

/// Folder where none is asked for.
const DEFAULT_FOLDER: &str = "out/displacement";

/// A recorded compression, and the display that shows it.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Folder or experiment.toml with runs of test = "uniaxial"
    #[arg(value_name = "EXPERIMENT")]
    experiment: PathBuf,
    /// Area of the cap that the finger presses, mm2 (the thesis gives none)
    #[arg(long, value_name = "MM2")]
    cap_mm2: f64,
    /// Thickness of the material that is displayed, mm [default: that of the specimen]
    #[arg(long, value_name = "MM")]
    thickness_mm: Option<f64>,
    /// Largest force of the finger, N
    #[arg(long, value_name = "N", default_value_t = 10.0)]
    force_n: f64,
    /// What the finger's pulp adds
    #[arg(long, value_enum, default_value_t = Pulp::None)]
    pulp: Pulp,
    /// Folder for the tables, the page and its picture
    #[arg(long, value_name = "DIR", default_value = DEFAULT_FOLDER)]
    out: PathBuf,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
}

/// What the pulp adds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Pulp {
    /// Nothing: the compression itself
    None,
    /// The thesis' sphere, Eqs. 50 to 52, up to 5.63 N
    Thesis,
}

/// Reads, converts and writes.
///
/// # Errors
/// An experiment with a mistake, one without a compression, an option out of range, a file that cannot be written.
pub fn run(arguments: &Arguments) -> miette::Result<()> {
    within("--cap-mm2", arguments.cap_mm2, 1.0..=1e4, "mm2")?;
    within("--force-n", arguments.force_n, 0.1..=100.0, "N")?;
    if let Some(thickness_mm) = arguments.thickness_mm {
        within("--thickness-mm", thickness_mm, 0.1..=200.0, "mm")?;
    }
    let experiment = crate::experiment::read(&arguments.experiment)?;
    let cap = Cap {
        area_mm2: arguments.cap_mm2,
        thickness_mm: arguments.thickness_mm,
        most_n: arguments.force_n,
        thesis_pulp: arguments.pulp == Pulp::Thesis,
    };
    let found = tables(&experiment, &cap).into_diagnostic()?;
    let mut folder = OwnFolder::open(&arguments.out, "--out", Some(DEFAULT_FOLDER)).into_diagnostic()?;
    let files = write(&mut folder, &found)?;
    if arguments.json {
        outln!(
            "{}",
            json!({"materials": found.iter().map(told).collect::<Vec<_>>(), "files": super::file::names(&files)})
        );
        return Ok(());
    }
    found.iter().for_each(|one| outln!("{}", sentence(one)));
    super::file::told(&files);
    Ok(())
}

fn end(table: &Displacement) -> (f64, f64) {
    table.rows.last().copied().unwrap_or_default()
}

fn sentence(one: &Tables) -> String {
    let table = &one.loading;
    let (force_n, shaft_mm) = end(table);
    format!(
        "{} ({}): {shaft_mm:.2} mm of {} mm at {force_n:.2} N, recorded to {:.0} %; {:.0} kPa over the strains 2 to 8 %; {}",
        table.material,
        one.specimen,
        table.thickness_mm,
        100.0 * one.strain,
        one.modulus_kpa,
        if one.unloading.is_some() { "loading and unloading" } else { "loading only: the recording has no way back" }
    )
}

fn told(one: &Tables) -> serde_json::Value {
    let (force_n, shaft_mm) = end(&one.loading);
    json!({"material": one.loading.material, "specimen": one.specimen, "largest_force_N": force_n, "largest_shaft_mm": shaft_mm, "strain": one.strain,
           "modulus_kPa": one.modulus_kpa, "unloading": one.unloading.is_some()})
}

fn write(folder: &mut OwnFolder, found: &[Tables]) -> miette::Result<Vec<PathBuf>> {
    let mut page = Page::new("Displacement tables", "Where the actuator's shaft is under a finger's force.");
    page.list(&found.iter().map(sentence).collect::<Vec<_>>());
    let mut files = Vec::new();
    for one in found {
        let is_alone = found.iter().filter(|other| other.loading.material == one.loading.material).count() == 1;
        let name = file_name(&if is_alone {
            one.loading.material.clone()
        } else {
            format!("{} {}", one.loading.material, one.specimen)
        });
        let svg = picture::branches(one).svg();
        page.figure(&svg, "Force of the finger over the shaft, down and up (thesis Figs. 70 and 71).");
        files.push(folder.write(&format!("{name}.svg"), svg.as_bytes()).into_diagnostic()?);
        for table in [Some(&one.loading), one.unloading.as_ref()].into_iter().flatten() {
            let file = if table.branch == "loading" { format!("{name}.csv") } else { format!("{name}-unloading.csv") };
            files.push(folder.write(&file, table.to_csv().as_bytes()).into_diagnostic()?);
        }
    }
    files.insert(0, folder.write("displacement.html", page.html().as_bytes()).into_diagnostic()?);
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

    #[test]
    fn options_out_of_range_and_experiments_without_compression_are_told() {
        let told = |words: &[&str]| {
            let words = std::iter::once("displacement").chain(words.iter().copied());
            run(&Line::parse_from(words).arguments).unwrap_err().to_string()
        };
        assert!(told(&["nowhere", "--cap-mm2", "0"]).contains("--cap-mm2 is 0; expected"));
        let folder = tempfile::tempdir().unwrap();
        let text = "name = \"x\"\n[specimen.a]\nbase_law = \"hyperfoam\"\nheight_mm = 20\nradius_mm = 30\n[indenter.b]\n\
                    radius_mm = 4\n[[run]]\nfile = \"r.csv\"\nspecimen = \"a\"\nindenter = \"b\"\ntest = \"indentation\"\n";
        std::fs::write(folder.path().join("experiment.toml"), text).unwrap();
        let rows: String = (0..50)
            .map(|i| format!("{},{},{}\n", 0.1 * f64::from(i), 0.05 * f64::from(i), 0.01 * f64::from(i)))
            .collect();
        std::fs::write(folder.path().join("r.csv"), format!("time_s,depth_mm,force_N\n{rows}")).unwrap();
        let text = told(&[folder.path().to_str().unwrap(), "--cap-mm2", "314"]);
        assert!(text.contains("x: no run with test = \"uniaxial\""), "{text}");
    }
}
