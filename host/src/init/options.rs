//! What the experimenter knows.

use crate::experiment::Test;

/// What is known beside the files.
#[derive(Debug, Clone, Copy, Default)]
pub struct Options {
    /// Radius of the ball, mm.
    pub ball_mm: Option<f64>,
    /// Height of the specimen, mm.
    pub height_mm: Option<f64>,
    /// Radius of the specimen, mm.
    pub radius_mm: Option<f64>,
    /// What was done.
    pub test: Option<Test>,
}
