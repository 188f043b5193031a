//! Experiment folders: `experiment.toml` and one data file a run.
//!
//! Everything that comes out of [`read`] is checked: finite numbers, time that does not go
//! backwards, depths inside the specimen. Units are mm, N, s. What is read here is exactly what
//! the files say; branches, rates and contact are found later, from the data ([`motion`]).

mod description;
mod error;
pub(crate) mod file;
mod folder;
mod format;
mod keys;
mod kind;
mod layout;
pub mod motion;
mod plausible;
mod recording;
pub mod replicate;
pub(crate) mod section;
pub mod sensor;
pub mod signal;
mod specimen;
pub(crate) mod unit;

use std::path::Path;

pub(crate) use description::circle_mm;
pub use error::{Column, ExperimentError, Problem};
pub use file::{DISPLAY_PAIRS, GAP_MM, UNDER_FINGER};
pub use folder::{Experiment, Run, Sensor};
pub use format::{Format, Mapping, Pace, Part, Source};
pub use kind::Test;
pub use recording::Recording;
pub use specimen::{Base, BaseLaw, Indenter, Length, Specimen};

/// Reads an experiment: a folder with `experiment.toml`, or that file itself.
///
/// # Errors
/// The first mistake found, with file, line and column ([`Problem`] lists the kinds).
pub fn read(path: &Path) -> Result<Experiment, ExperimentError> {
    let file = if path.is_dir() || path.extension().is_none_or(|e| e != "toml") {
        path.join("experiment.toml")
    } else {
        path.to_owned()
    };
    parse(&file, &text_of(&file)?)
}

/// Text of a description: of an experiment, a sweep or a simulation.
///
/// # Errors
/// A file that is missing, cannot be read, or is not UTF-8.
pub(crate) fn text_of(file: &Path) -> Result<String, ExperimentError> {
    let bytes = std::fs::read(file).map_err(|cause| match cause.kind() {
        std::io::ErrorKind::NotFound => {
            ExperimentError::of_file(file, Problem::MissingFile(file.display().to_string()))
        }
        _ => ExperimentError::of_file(file, Problem::Unreadable(cause.to_string())),
    })?;
    String::from_utf8(bytes).map_err(|_| ExperimentError::of_file(file, Problem::Encoding("UTF-8".to_owned())))
}

/// Reads an experiment whose description is already in memory; `file` is where it would be.
///
/// # Errors
/// As [`read`].
pub fn parse(file: &Path, text: &str) -> Result<Experiment, ExperimentError> {
    description::experiment(file, text)
}
