//! Fluids by name and as files: `fluid.toml`.

use std::collections::BTreeMap;
use std::path::Path;

use lut_gen::magnet::bh::{Between, Law, Table};
use lut_gen::magnet::fluid::{Fluid, Oil};
use lut_gen::magnet::material::{NAMES, named};

use super::expression::Parameters;
use super::material::pairs;
use crate::experiment::section::{Document, Section};
use crate::experiment::{ExperimentError, Problem, text_of};

/// A fluid, and what is told of it.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedFluid {
    /// What it is.
    pub title: String,
    /// Where its numbers come from.
    pub source: String,
    /// Its laws.
    pub fluid: Fluid,
}

const KEYS: [&str; 6] = ["title", "source", "iron_fraction", "oil", "flux_csv", "yield_csv"];

/// Names of the fluids that the program knows.
pub fn names() -> Vec<&'static str> {
    NAMES.into_iter().filter(|name| fraction(name).is_some()).collect()
}

/// Iron of a fluid that the program knows, as a part of its volume.
fn fraction(name: &str) -> Option<f64> {
    match named(name, Between::Monotone)?.ok()? {
        Law::Fluid(fraction) => Some(fraction),
        _ => None,
    }
}

/// A fluid of LORD's that the program knows, by Carlson's fits for hydrocarbon oil.
pub fn known(name: &str) -> Option<NamedFluid> {
    let fraction = fraction(name)?;
    Some(NamedFluid {
        title: name.to_owned(),
        source: format!("Carlson 2005, {fraction} of the volume iron, hydrocarbon oil"),
        fluid: Fluid::carlson(fraction, Oil::Hydrocarbon).ok()?,
    })
}

/// Reads a fluid's file.
///
/// # Errors
/// The first mistake found, with file, line and column.
pub fn read(file: &Path) -> Result<NamedFluid, ExperimentError> {
    parse(file, &text_of(file)?)
}

fn parse(file: &Path, text: &str) -> Result<NamedFluid, ExperimentError> {
    let document = Document { file, text };
    let root = document.table()?;
    let root = Section::new(document, "the file".to_owned(), 0..0, root.get_ref());
    root.only(&KEYS)?;
    let stem = file.file_stem().map_or("fluid".into(), |n| n.to_string_lossy().into_owned());
    Ok(NamedFluid {
        title: root.text("title", "a text in quotes")?.map_or(stem, str::to_owned),
        source: root.text("source", "a text in quotes")?.unwrap_or_default().to_owned(),
        fluid: fluid(&root)?,
    })
}

/// Carlson's laws by `iron_fraction` and `oil`; a table takes the place of either.
fn fluid(root: &Section<'_>) -> Result<Fluid, ExperimentError> {
    let oils = [("hydrocarbon", Oil::Hydrocarbon), ("water", Oil::Water), ("silicone", Oil::Silicone)];
    let oil = root.word("oil", &oils)?;
    let expected = "the part of the fluid's volume that is iron, 0.01 to 0.5";
    let fraction = Parameters(BTreeMap::new()).number(root, "iron_fraction", 0.01..=0.5, expected)?;
    let (has_flux, has_yield) = (root.value("flux_csv").is_some(), root.value("yield_csv").is_some());
    let wrong = |key: &str, error: String| {
        let span = root.value(key).map_or(root.span.clone(), toml::Spanned::span);
        root.document.error(span, Problem::Contradiction(error))
    };
    if oil.is_some() && has_yield {
        let text = "`oil` and `yield_csv` both say how the fluid yields; expected one of them".to_owned();
        return Err(wrong("oil", text));
    }
    let law = if has_flux {
        let expected = "the name of a CSV file with B in T and H in A/m";
        let (file, points) = pairs(root, "flux_csv", expected, [("B", "a number of T"), ("H", "a number of A/m")])?;
        let table = Table::new(&points, Between::Monotone);
        Law::Table(table.map_err(|e| ExperimentError::of_file(&file, Problem::Contradiction(e.to_string())))?)
    } else {
        let fraction = fraction.ok_or_else(|| root.missing("iron_fraction", expected))?;
        Law::fluid(fraction).map_err(|error| wrong("iron_fraction", error.to_string()))?
    };
    if has_yield {
        let expected = "the name of a CSV file with H in A/m and the yield stress in Pa, from 0, 0 on";
        let columns = [("H", "a number of A/m"), ("yield stress", "a number of Pa")];
        let (file, points) = pairs(root, "yield_csv", expected, columns)?;
        return Fluid::measured(law, &points)
            .map_err(|error| ExperimentError::of_file(&file, Problem::Contradiction(error.to_string())));
    }
    let fraction = fraction.ok_or_else(|| root.missing("iron_fraction", expected))?;
    let carlson = Fluid::carlson(fraction, oil.unwrap_or_default()).map(|fluid| fluid.with_law(law));
    carlson.map_err(|error| wrong("iron_fraction", error.to_string()))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_users_own_curves_take_the_place_of_carlsons() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| {
            let file = folder.path().join(name);
            std::fs::write(&file, text).unwrap();
            file
        };
        write("yield.csv", "H,yield\n0,0\n50000,9000\n200000,30000\n");
        write("flux.csv", "# B H\n0,0\n0.2,40000\n0.6,200000\n");
        let own = read(&write("own.toml", "flux_csv = \"flux.csv\"\nyield_csv = \"yield.csv\"\n")).unwrap();
        assert_eq!(own.title, "own");
        assert!((own.fluid.yield_at_strength(50.0) - 9.0).abs() < 1e-12);
        assert!((own.fluid.flux_at_strength(40.0) - 0.2).abs() < 1e-9);
        let mixed = read(&write("mixed.toml", "iron_fraction = 0.22\nyield_csv = \"yield.csv\"\n")).unwrap();
        assert!((mixed.fluid.flux_at_strength(50.0) - 0.234).abs() < 6e-4);
        write("yield.csv", "0,0\n50000,x\n");
        let text = read(&folder.path().join("own.toml")).unwrap_err().to_string();
        assert!(text.contains("yield.csv, line 2") && text.contains("a number of Pa"), "{text}");
    }

    #[test]
    fn mistakes_are_told() {
        for (text, told) in [
            ("oil = \"water\"", "`iron_fraction`"),
            ("iron_fraction = 0.9", "the part of the fluid's volume that is iron"),
            ("iron_fraction = 0.2\noil = \"olive\"", "expected one of \"hydrocarbon\", \"water\", \"silicone\""),
            ("iron_fraction = 0.2\noil = \"water\"\nyield_csv = \"a.csv\"", "expected one of them"),
            ("iron = 0.2", "iron"),
        ] {
            let found = parse(Path::new("fluid.toml"), text).unwrap_err().to_string();
            assert!(found.contains(told) && found.contains("fluid.toml"), "{text}: {found}");
        }
    }

    #[test]
    fn the_fluids_of_the_program_are_known_by_name() {
        assert_eq!(names(), ["MRF-122EG", "MRF-132DG", "MRF-140CG"]);
        assert!((known("MRF-122EG").unwrap().fluid.saturation_kpa() - 27.0).abs() < 0.1);
        assert_eq!(known("copper"), None);
    }
}
