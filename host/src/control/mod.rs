//! Control curves: what coil and actuator of the display must do under a finger's force so that a
//! material is felt.

mod along;
pub mod compose;
mod curve;
mod error;
mod library;
pub mod remake;
pub mod study;
mod ticks;

pub use curve::{COLUMNS, ControlCurve, MOST_ROWS, Row};
pub use error::CurveError;
pub use library::{Curves, actuator_only, put};
pub use ticks::ShownTicks;

#[cfg(test)]
mod tests;
