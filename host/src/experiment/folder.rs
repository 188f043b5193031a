//! A folder as it was read: the runs with their labels, and all together.

use std::path::PathBuf;

use super::sensor::Trouble;
use super::{Indenter, Recording, Specimen, Test};

/// What is known of the force sensor.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Sensor {
    /// Standard deviation of its noise in N, if stated.
    pub noise_n: Option<f64>,
    /// The force zero is right even where no force before contact is recorded.
    pub zero_is_known: bool,
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
    /// Magnet whose flux density a table holds: a file, or the name of one that comes with the program; and the table's unit
    /// over T.
    pub magnet: Option<(String, f64)>,
    /// Load of a mass that the sensor carries, N, if stated.
    pub load_n: Option<f64>,
    /// What was wrong with its readings, and was left out.
    pub troubles: Vec<Trouble>,
    /// Label that it shares with the runs that repeat it, where that is declared.
    pub repeats: Option<String>,
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
            magnet: None,
            load_n: None,
            troubles: Vec::new(),
            repeats: None,
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
