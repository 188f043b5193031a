//! `[material.NAME]`: by a name, a permeability, a table, the iron of a fluid, or a magnet's datasheet.

use std::path::{Path, PathBuf};

use lut_gen::magnet::bh::{Between, Law, LawError, Table};
use lut_gen::magnet::material::{Magnet, NAMES, named};

use super::expression::Parameters;
use crate::experiment::section::Section;
use crate::experiment::{ExperimentError, Problem};

/// A material of a region.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Material {
    pub law: Law,
    /// Coercive field strength of a magnet, A/mm; 0 for all else.
    pub coercive: f64,
}

const KEYS: [&str; 9] = [
    "flux_factor",
    "like",
    "permeability",
    "table_csv",
    "between",
    "iron_fraction",
    "remanence_T",
    "coercive_kA_m",
    "product_kJ_m3",
];

/// One of the materials that the program knows, by its name.
pub(super) fn by_name(name: &str) -> Option<Material> {
    named(name, Between::Monotone).and_then(Result::ok).map(|law| Material { law, coercive: 0.0 })
}

/// Reads a section.
pub(super) fn read(section: &Section<'_>, parameters: &Parameters) -> Result<Material, ExperimentError> {
    section.only(&KEYS)?;
    let ways = ["like", "permeability", "table_csv", "iron_fraction", "remanence_T"];
    let told: Vec<&str> = ways.into_iter().filter(|key| section.value(key).is_some()).collect();
    let [way] = told.as_slice() else {
        let found = if told.is_empty() { "none".to_owned() } else { told.join(", ") };
        let text = format!("a material is given by one of {}; found {found}", ways.join(", "));
        return Err(section.document.error(section.span.clone(), Problem::Contradiction(text)));
    };
    let between = section.word("between", &[("monotone", Between::Monotone), ("straight", Between::Straight)])?;
    let between = between.unwrap_or_default();
    let bad = |error: LawError| {
        let span = section.value(way).map_or(section.span.clone(), toml::Spanned::span);
        section.document.error(span, Problem::Contradiction(error.to_string()))
    };
    let mut material = Material { law: Law::Linear(1.0), coercive: 0.0 };
    match *way {
        "like" => {
            let expected = format!("one of {}", NAMES.map(|name| format!("\"{name}\"")).join(", "));
            let name = section.text("like", &expected)?.unwrap_or_default();
            let law = named(name, between).ok_or_else(|| match section.value("like") {
                Some(value) => section.bad("like", value, &expected),
                None => section.missing("like", &expected),
            })?;
            material.law = law.map_err(bad)?;
        }
        "permeability" => {
            let expected = "a multiple of the vacuum's permeability, 0.01 to 1e7";
            material.law =
                Law::Linear(parameters.number(section, "permeability", 0.01..=1e7, expected)?.unwrap_or(1.0));
        }
        "iron_fraction" => {
            let expected = "the part of the fluid's volume that is iron, 0.01 to 0.5";
            material.law =
                Law::Fluid(parameters.number(section, "iron_fraction", 0.01..=0.5, expected)?.unwrap_or(0.22));
        }
        "table_csv" => {
            material.law = Law::Table(table(section, between)?);
            material.coercive = coercive(section)?.unwrap_or(0.0);
        }
        _ => {
            let value = |key: &str, expected: &str| {
                parameters.number(section, key, 1e-3..=1e4, expected)?.ok_or_else(|| section.missing(key, expected))
            };
            let magnet = Magnet {
                remanence_t: value("remanence_T", "the flux density of the closed magnet, T")?,
                coercive_ka_m: value("coercive_kA_m", "the coercive field strength, kA/m")?,
                product_kj_m3: value("product_kJ_m3", "the energy product, kJ/m^3")?,
            };
            material.coercive = magnet.coercive_ka_m;
            material.law = magnet.law().map_err(bad)?;
        }
    }
    if let Some(factor) =
        parameters.number(section, "flux_factor", 0.1..=10.0, "B over that of the law at the same H")?
    {
        material.law = material
            .law
            .with_flux(factor)
            .map_err(|error| section.document.error(section.span.clone(), Problem::Contradiction(error.to_string())))?;
    }
    Ok(material)
}

fn coercive(section: &Section<'_>) -> Result<Option<f64>, ExperimentError> {
    section.number("coercive_kA_m", 1e-3..=1e4, "the coercive field strength, kA/m, from which H of the table counts")
}

/// A table beside the file: two columns, B in T and H in A/m; lines that begin with # or a letter are skipped.
fn table(section: &Section<'_>, between: Between) -> Result<Table, ExperimentError> {
    let expected = "the name of a CSV file with B in T and H in A/m";
    let (file, points) = pairs(section, "table_csv", expected, [("B", "a number of T"), ("H", "a number of A/m")])?;
    Table::new(&points, between)
        .map_err(|error| ExperimentError::of_file(&file, Problem::Contradiction(error.to_string())))
}

/// The CSV file that a key names, beside the section's file, with its first two columns.
pub(super) type Pairs = (PathBuf, Vec<(f64, f64)>);

/// Reads two columns of the file that a key names; each has a name and what is expected of it. Lines that begin with # or a
/// letter are skipped.
pub(super) fn pairs(
    section: &Section<'_>,
    key: &str,
    expected: &str,
    columns: [(&str, &str); 2],
) -> Result<Pairs, ExperimentError> {
    let name = section.text(key, expected)?.ok_or_else(|| section.missing(key, expected))?;
    let folder = section.document.file.parent().unwrap_or_else(|| Path::new("."));
    let file = folder.join(name);
    let text = crate::experiment::text_of(&file)?;
    let mut points = Vec::new();
    for (i, line) in text.lines().enumerate() {
        let fields: Vec<&str> = line.split([',', ';', '\t']).map(str::trim).collect();
        let is_head = line.trim().is_empty() || line.starts_with('#') || line.starts_with(char::is_alphabetic);
        if is_head {
            continue;
        }
        let number = |field: usize| {
            let found = fields.get(field).copied().unwrap_or("nothing");
            found.parse::<f64>().ok().filter(|v| v.is_finite()).ok_or_else(|| {
                let (key, expected) = columns[field];
                let problem =
                    Problem::BadValue { key: key.to_owned(), found: found.to_owned(), expected: expected.to_owned() };
                ExperimentError::of_row(&file, i + 1, Some((field + 1, key)), problem)
            })
        };
        points.push((number(0)?, number(1)?));
    }
    Ok((file, points))
}
