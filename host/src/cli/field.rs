//! `palpate field`.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use lut_gen::solid::contact::Ball;
use lut_gen::solid::field::{Field, vtu};
use lut_gen::solid::law::{Hyperfoam, Term};
use lut_gen::solid::model::{Indentation, Resolution, Specimen};
use lut_gen::solid::solve::Base;
use miette::{IntoDiagnostic, WrapErr, miette};
use serde_json::json;

use crate::ownership::OwnFolder;
use crate::report::{field, number};

/// Folder of files where none is asked for.
const DEFAULT_FOLDER: &str = "out/field";

/// One indentation, and at which depths to look inside.
#[derive(Debug, Args)]
pub struct Arguments {
    /// Shear modulus of the Hyperfoam, MPa
    #[arg(long, value_name = "MPA", default_value_t = 0.22)]
    mu: f64,
    /// Exponent of the Hyperfoam
    #[arg(long, value_name = "NUMBER", default_value_t = 10.53)]
    alpha: f64,
    /// Poisson's ratio
    #[arg(long, value_name = "NUMBER", default_value_t = 0.0)]
    nu: f64,
    /// Radius of the ball, mm
    #[arg(long, value_name = "MM", default_value_t = 4.0)]
    ball_mm: f64,
    /// Height of the specimen, mm
    #[arg(long, value_name = "MM", default_value_t = 12.7)]
    height_mm: f64,
    /// Radius of the specimen, mm
    #[arg(long, value_name = "MM", default_value_t = 25.0)]
    radius_mm: f64,
    /// How the specimen rests on its table
    #[arg(long, value_enum, default_value_t = BaseArgument::Bonded)]
    base: BaseArgument,
    /// Depths, mm; one file each
    #[arg(long, value_name = "MM,..", value_delimiter = ',', default_values_t = [1.0, 2.0, 3.0, 4.0])]
    depth_mm: Vec<f64>,
    /// Divides all element sizes
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0)]
    refine: f64,
    /// Folder for field.pvd (open it in ParaView), its files and a picture of the deepest step
    #[arg(long, value_name = "DIR", default_value = DEFAULT_FOLDER)]
    out: PathBuf,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum BaseArgument {
    Bonded,
    Sliding,
}

/// Most steps of a series.
const MOST_DEPTHS: usize = 400;

/// Solves the indentation and writes its fields.
///
/// # Errors
/// Values out of range, a failing solve, a file that cannot be written.
pub fn run(arguments: &Arguments) -> miette::Result<()> {
    let mut depths = arguments.depth_mm.clone();
    depths.sort_by(f64::total_cmp);
    depths.dedup();
    let Some(&deepest) = depths.last() else {
        return Err(miette!("--depth-mm is empty; expected at least one depth"));
    };
    if depths.len() > MOST_DEPTHS {
        return Err(miette!("--depth-mm lists {} depths; expected at most {MOST_DEPTHS}", depths.len()));
    }
    let fields = indentation(arguments, deepest)?
        .fields_at(&depths)
        .into_diagnostic()
        .wrap_err("the fields could not be computed")?;
    let files = write(&arguments.out, &fields)?;
    if arguments.json {
        let steps: Vec<_> = fields
            .iter()
            .map(|f| {
                json!({"depth_mm": f.step.depth_mm, "force_N": f.step.force_n, "mises_MPa": f.largest_mises_mpa(),
                       "pressure_MPa": largest_pressure(f)})
            })
            .collect();
        let names = files.iter().map(|file| file.display().to_string()).collect::<Vec<_>>();
        outln!("{}", json!({ "steps": steps, "files": names }));
        return Ok(());
    }
    for f in &fields {
        outln!(
            "depth {:6} mm  force {:8} N  largest Mises stress {:8} MPa  largest pressure {:8} MPa",
            number(f.step.depth_mm),
            number(f.step.force_n),
            number(f.largest_mises_mpa()),
            number(largest_pressure(f))
        );
    }
    for file in files.iter().rev().take(2) {
        outln!("written {}", file.display());
    }
    Ok(())
}

fn largest_pressure(field: &Field) -> f64 {
    field.pressure_mpa.iter().copied().fold(0.0, f64::max)
}

fn indentation(arguments: &Arguments, depth_mm: f64) -> miette::Result<Indentation> {
    let term = Term { mu_mpa: arguments.mu, alpha: arguments.alpha, nu: arguments.nu };
    let base = match arguments.base {
        BaseArgument::Bonded => Base::Bonded,
        BaseArgument::Sliding => Base::Sliding,
    };
    Ok(Indentation {
        law: Hyperfoam::new(vec![term]).into_diagnostic()?,
        specimen: Specimen { height_mm: arguments.height_mm, radius_mm: arguments.radius_mm, base },
        ball: Ball { radius_mm: arguments.ball_mm },
        depth_mm,
        resolution: Resolution::Refined(arguments.refine),
    })
}

/// Writes one pair of files a step, then the collection and the picture.
fn write(folder: &Path, fields: &[Field]) -> miette::Result<Vec<PathBuf>> {
    let mut folder = OwnFolder::open(folder, "--out", Some(DEFAULT_FOLDER)).into_diagnostic()?;
    let mut files = Vec::new();
    let mut save = |name: &str, text: &str| -> miette::Result<()> {
        files.push(folder.write(name, text.as_bytes()).into_diagnostic()?);
        Ok(())
    };
    let mut steps = Vec::new();
    for (i, f) in fields.iter().enumerate() {
        let (block, ball) = (format!("block_{i:03}.vtu"), format!("ball_{i:03}.vtu"));
        save(&block, &vtu::block(f))?;
        save(&ball, &vtu::ball(f))?;
        steps.push((f.step.depth_mm, block, ball));
    }
    save("field.pvd", &vtu::collection(&steps))?;
    if let Some(deepest) = fields.last() {
        save("field.svg", &field::mises("Mises stress in the deformed specimen", deepest))?;
    }
    Ok(files)
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
        Line::parse_from(std::iter::once("field").chain(words.iter().copied())).arguments
    }

    #[test]
    fn a_series_is_written_with_its_picture() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("a/b");
        let mut asked = arguments(&["--depth-mm", "2,1", "--refine", "0.4", "--base", "sliding"]);
        asked.out = out.clone();
        run(&asked).unwrap();
        let series = std::fs::read_to_string(out.join("field.pvd")).unwrap();
        assert!(series.contains("timestep=\"1\"") && series.contains("timestep=\"2\""), "{series}");
        for file in ["block_000.vtu", "ball_000.vtu", "block_001.vtu", "ball_001.vtu"] {
            assert!(series.contains(file) && out.join(file).exists());
        }
        let picture = std::fs::read_to_string(out.join("field.svg")).unwrap();
        assert!(picture.len() < 300_000, "{} bytes", picture.len());
        assert_eq!(picture.matches("<svg").count(), picture.matches("</svg>").count());
        assert!(picture.contains("Mises stress") && picture.contains("(kPa)") && picture.contains("2 mm deep"));
        assert!(!picture.contains("NaN") && !picture.contains("inf"));
    }

    #[test]
    fn bad_values_are_named() {
        let said = |words: &[&str]| format!("{:?}", run(&arguments(words)).unwrap_err());
        assert!(said(&["--nu", "0.6"]).contains("nu = 0.6"));
        assert!(said(&["--depth-mm", "20"]).contains("depth_mm = 20"));
        assert!(said(&["--refine", "100"]).contains("refinement = 100"));
    }
}
