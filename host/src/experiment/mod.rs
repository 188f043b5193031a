//! Experiment folders: `experiment.toml` and one data file a run.
//!
//! Everything that comes out of [`read`] is checked: finite numbers, time that does not go
//! backwards, depths inside the specimen. Units are mm, N, s. What is read here is exactly what
//! the files say; branches, rates and contact are found later, from the data ([`motion`]).

mod description;
mod error;
mod keys;
pub mod motion;
mod recording;
pub mod replicate;
pub(crate) mod section;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

pub(crate) use description::circle_mm;
pub use description::{Format, Mapping};
pub use error::{Column, ExperimentError, Problem};
pub use recording::{DISPLAY_PAIRS, GAP_MM, Recording};

/// A length that the experimenter may not know.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Length {
    /// Measured, mm.
    Known(f64),
    /// Written `"unknown"`: a free parameter with stated bounds.
    Unknown,
}

impl Length {
    /// The value in mm if it is known.
    pub fn known(self) -> Option<f64> {
        match self {
            Length::Known(mm) => Some(mm),
            Length::Unknown => None,
        }
    }
}

/// Law that the specimen is assumed to follow.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BaseLaw {
    /// Compressible foam, thesis Eq. 1.
    Hyperfoam,
    /// Nearly incompressible rubber or tissue, thesis Eq. 2.
    Ogden,
    /// A stiff block: shows the machine, not the material.
    Rigid,
}

/// How the specimen rests on the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Base {
    /// Glued, or too rough to slide.
    Bonded,
    /// Free to slide sideways.
    Sliding,
}

/// A block of material, a flat cylinder.
#[derive(Debug, Clone, PartialEq)]
pub struct Specimen {
    /// Name in the file.
    pub name: String,
    /// Name of what it is made of; specimens of one material share their parameters.
    pub material: String,
    /// Assumed law.
    pub base_law: BaseLaw,
    /// Terms of the law, at least 1.
    pub terms: usize,
    /// Height under the indenter.
    pub height_mm: Length,
    /// Radius of the cylinder.
    pub radius_mm: Length,
    /// Contact with the table.
    pub base: Base,
}

/// A rigid ball.
#[derive(Debug, Clone, PartialEq)]
pub struct Indenter {
    /// Name in the file.
    pub name: String,
    /// Radius of the ball.
    pub radius_mm: Length,
}

/// What is known of the force sensor.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Sensor {
    /// Standard deviation of its noise in N, if stated.
    pub noise_n: Option<f64>,
}

/// What was done in a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Test {
    /// A ball pressed into the specimen.
    Indentation,
    /// Unconfined compression between plates.
    Uniaxial,
    /// Compression in a rigid ring.
    Confined,
    /// Pulling.
    Tension,
    /// Simple shear.
    Shear,
    /// Nothing touched: noise, zero and drift.
    Air,
    /// A known load on the sensor.
    Mass,
    /// Commanded and measured position, force and current of the display over time.
    Display,
    /// An x-y calibration.
    Table,
}

/// One recorded time series and its labels.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// The file as written in `experiment.toml`.
    pub file: String,
    /// Where that file is.
    pub path: PathBuf,
    /// Index into [`Experiment::specimens`], if the run touched one.
    pub specimen: Option<usize>,
    /// Index into [`Experiment::indenters`], if a ball was used.
    pub indenter: Option<usize>,
    /// What was done.
    pub test: Test,
    /// Where on the specimen.
    pub spot: Option<i64>,
    /// Where on its upper face, mm along two directions at right angles, from any origin.
    pub place_mm: Option<[f64; 2]>,
    /// n-th time on this spot.
    pub cycle: Option<i64>,
    /// Position in the session.
    pub order: Option<i64>,
    /// Start on the session clock, s.
    pub start_s: Option<f64>,
    /// Never fitted, only predicted.
    pub hold_out: bool,
    /// Load of a mass that the sensor carries, N, if stated.
    pub load_n: Option<f64>,
    /// The samples.
    pub recording: Recording,
}

impl Run {
    /// A run that comes from no file: a ball in a specimen, to be fitted, without labels. `name` stands for the file.
    #[must_use]
    pub fn indentation(name: String, specimen: usize, indenter: usize, recording: Recording) -> Self {
        Self {
            file: name,
            path: PathBuf::new(),
            specimen: Some(specimen),
            indenter: Some(indenter),
            test: Test::Indentation,
            spot: None,
            place_mm: None,
            cycle: None,
            order: None,
            start_s: None,
            hold_out: false,
            load_n: None,
            recording,
        }
    }
}

/// A whole folder, read and checked.
#[derive(Debug, Clone, PartialEq)]
pub struct Experiment {
    /// Title.
    pub name: String,
    /// The folder.
    pub folder: PathBuf,
    /// Specimens in the order of their names.
    pub specimens: Vec<Specimen>,
    /// Indenters in the order of their names.
    pub indenters: Vec<Indenter>,
    /// Force sensor.
    pub sensor: Sensor,
    /// Runs in the order of the file.
    pub runs: Vec<Run>,
}

/// Names and places of everything a run can refer to.
pub(crate) type Names = BTreeMap<String, usize>;

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
