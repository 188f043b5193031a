//! Why a study cannot be made.

use lut_gen::solid::solve::SolveError;

use crate::identify::fe::ModelError;

/// Why a study cannot be made.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum StudyError {
    /// No such material was indented.
    #[error("no run indents a material named \"{wanted}\"; the experiment has: {known}")]
    UnknownMaterial {
        /// What was asked for.
        wanted: String,
        /// What there is.
        known: String,
    },
    /// No soft material was indented at all.
    #[error("the experiment holds no indentation run into a soft specimen")]
    NoMaterial,
    /// No curve can be used.
    #[error("no run into \"{material}\" can be used: {reason}")]
    NothingToFit {
        /// The material.
        material: String,
        /// The outcome's word.
        reason: &'static str,
    },
    /// The material declares another law.
    #[error(
        "the study \"{study}\" is about mu and alpha of a one-term hyperfoam, with the height known except for \"objective\"; \"{material}\" is declared as {declared}"
    )]
    NotOneTermFoam {
        /// Name of the study.
        study: &'static str,
        /// The material.
        material: String,
        /// What its specimens declare.
        declared: String,
    },
    /// The study simulates a recording of its own.
    #[error("the study \"{study}\" simulates its own recording; leave out the experiment")]
    OwnRecording {
        /// Name of the study.
        study: &'static str,
    },
    /// A parameter of the study is out of range.
    #[error("{parameter} = {value} {expected}")]
    Parameter {
        /// Its name.
        parameter: &'static str,
        /// Its value.
        value: f64,
        /// What is expected of it.
        expected: &'static str,
    },
    /// The forward model.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Model(#[from] ModelError),
    /// The simulated recordings.
    #[error("the recordings of the simulated foam cannot be made")]
    Simulation(#[from] SolveError),
}
