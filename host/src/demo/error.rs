//! What can go wrong in the demo.

use std::path::PathBuf;

use lut_gen::solid::solve::SolveError;
use lut_gen::table::LutError;

use crate::log::LogError;
use crate::session::SessionError;

/// The demo could not be finished.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum DemoError {
    /// A finite-element solve failed.
    #[error("{what}: {source}")]
    Solve {
        /// Of what.
        what: String,
        /// Why.
        source: SolveError,
    },
    /// The table could not be made.
    #[error(transparent)]
    Lut(#[from] LutError),
    /// A material's curve is no curve.
    #[error("the computed curve of {name} has a force that is negative or not finite")]
    Curve {
        /// The material.
        name: String,
    },
    /// The extended model does not fit the demo.
    #[error(transparent)]
    Model(#[from] crate::extended::ExtendedError),
    /// A control curve does not fit the library.
    #[error(transparent)]
    Control(#[from] crate::control::CurveError),
    /// The conversation with the board failed.
    #[error(transparent)]
    Session(#[from] SessionError),
    /// A log failed.
    #[error(transparent)]
    Log(#[from] LogError),
    /// The constants of the displays that a hand presses.
    #[error(transparent)]
    Constants(#[from] crate::experiment::ExperimentError),
    /// A hand felt nothing.
    #[error(transparent)]
    Unfelt(#[from] crate::feel::Unfelt),
    /// A file cannot be read or written.
    #[error("{}: {source}", .path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A palpation never ended.
    #[error("palpation {number} did not end within {waited_s:.0} s of board time: the board is in state {state}")]
    Endless {
        /// Its number.
        number: usize,
        /// Board time waited, s.
        waited_s: f64,
        /// State of the board.
        state: String,
    },
    /// The table given has no library.
    #[error("the table has no library materials to display: make one with `palpate lut`")]
    NoLibrary,
}
