//! Control curves: what coil and actuator of the display must do under a finger's force so that a
//! material is felt.

mod curve;
mod error;

pub use curve::{COLUMNS, ControlCurve, MOST_ROWS, Row};
pub use error::CurveError;

#[cfg(test)]
mod tests;
