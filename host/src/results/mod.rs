//! What a command found, kept: one folder a call with answer, curves, parameters, figures and page.
//!
//! | file | holds |
//! |---|---|
//! | `result.json` | the answer of `--json`, with `curves` and `provenance` |
//! | `parameters.csv` | one row a parameter, with its interval |
//! | `provenance.json` | version, command, date and the SHA-256 of every file that was read |
//! | `material.inp`, `material.feb` | the law for Abaqus or CalculiX, and for FEBio |
//! | `figures/*.svg`, `report.html` | the page, and its figures one by one |
//!
//! How folders are named: docs/decisions/0007-result-folders.md.

pub mod curves;
pub mod export;
pub mod folder;
pub mod parameters;
pub mod provenance;
pub mod table;

use crate::experiment::Experiment;

/// What a material is called outside of its experiment: where none is named, its only specimen has the better name.
#[must_use]
pub fn material_name<'a>(experiment: &'a Experiment, material: &'a str) -> &'a str {
    let mut own = experiment.specimens.iter().filter(|specimen| specimen.material == material);
    match (own.next(), own.next()) {
        (Some(only), None) if material == UNNAMED => &only.name,
        _ => material,
    }
}

/// Name of a material in experiments that name none.
const UNNAMED: &str = "specimen";

pub use folder::{Folder, FolderError, Place};
pub use provenance::Provenance;
