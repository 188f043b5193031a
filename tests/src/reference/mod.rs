//! Force curves of codes that are not ours, and what they are compared with.
//!
//! The files lie in `../shared/reference` beside the checkout (or under `PALPATE_SHARED`).
//! Their headers have one of two forms, see [`Reference::parse`]; whatever cannot be read or
//! would change the physics unnoticed is an [`ReferenceError`] that names file and field.

mod comparison;
mod header;

use std::path::{Path, PathBuf};

pub use comparison::{Comparison, FROM_MM, PROMISE_PERCENT, SHOWN_MM, table};
use lut_gen::solid::contact::Ball;
use lut_gen::solid::law::Hyperfoam;
use lut_gen::solid::model::Specimen;

/// A force curve of another code with the problem it solves.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    /// Name of the file without its ending.
    pub name: String,
    /// Material of the block.
    pub law: Hyperfoam,
    /// The block.
    pub specimen: Specimen,
    /// The ball.
    pub ball: Ball,
    /// Coulomb's coefficient between ball and block (-); 0 without friction.
    pub friction: f64,
    /// Uncertainty the curve states from 0.5 mm on, percent of the local force.
    pub uncertainty_percent: f64,
    /// Depth (mm), rising, and force (N).
    pub rows: Vec<(f64, f64)>,
}

/// Why a reference file could not be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("reference curve {file}: {problem}")]
pub struct ReferenceError {
    /// The file, or the name the text was given.
    pub file: String,
    /// What is wrong, with field, value and expectation.
    pub problem: String,
}

impl Reference {
    /// Reads a curve from its file.
    ///
    /// # Errors
    /// [`ReferenceError`] names the file and what in it is missing or not understood.
    pub fn read(path: &Path) -> Result<Self, ReferenceError> {
        let file = path.display().to_string();
        let text = std::fs::read_to_string(path)
            .map_err(|e| ReferenceError { file: file.clone(), problem: format!("cannot be read: {e}") })?;
        let name = path.file_stem().map_or_else(|| file.clone(), |s| s.to_string_lossy().into_owned());
        Self::parse(&name, &text).map_err(|e| ReferenceError { file, ..e })
    }

    /// Reads a curve of the given name from its text. The header's lines start with `#`; either
    ///
    /// ```text
    /// # mu=0.15, alpha=8, mu2=0.05, alpha2=-4, nu=0, R=4, h=12.7, sliding=1, friction=0.3  [..; block radius 25 mm; ..]
    /// # ..; uncertainty from 0.5 mm on: 0.08 % ..
    /// ```
    ///
    /// or, for CalculiX, one line each `indenter_R_mm:`, `block:`, `material:` with
    /// `terms (..) = [[mu, alpha, nu], ..]`, `friction:` and one line a mesh.
    ///
    /// # Errors
    /// [`ReferenceError`] names what is missing or not understood.
    pub fn parse(name: &str, text: &str) -> Result<Self, ReferenceError> {
        header::parse(name, text).map_err(|problem| ReferenceError { file: name.to_owned(), problem })
    }

    /// Depth the curve ends at (mm).
    #[must_use]
    pub fn depth_mm(&self) -> f64 {
        self.rows.last().map_or(0.0, |r| r.0)
    }

    /// Largest force of the curve (N).
    #[must_use]
    pub fn peak_n(&self) -> f64 {
        self.rows.iter().map(|r| r.1).fold(0.0, f64::max)
    }
}

/// Folder the reference curves are looked for in.
#[must_use]
pub fn folder() -> PathBuf {
    crate::shared().join("reference")
}

/// The curves (`*.csv`) of a folder in order of their names; `None` when there is no such folder.
///
/// # Errors
/// The folder's or a file's [`ReferenceError`]; one unreadable file spoils all, so that none is
/// left out unnoticed.
pub fn curves(folder: &Path) -> Result<Option<Vec<Reference>>, ReferenceError> {
    if !folder.is_dir() {
        return Ok(None);
    }
    let fail = |e: std::io::Error| ReferenceError { file: folder.display().to_string(), problem: e.to_string() };
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(fail)? {
        let path = entry.map_err(fail)?.path();
        if path.extension().is_some_and(|e| e == "csv") {
            files.push(path);
        }
    }
    files.sort();
    files.iter().map(|p| Reference::read(p)).collect::<Result<Vec<_>, _>>().map(Some)
}
