//! Implicit quasi-static solution: sparse system, Newton's method, path in depth.

mod error;
mod newton;
mod path;
mod sparse;
mod system;

pub use error::SolveError;
pub use newton::{Newton, Problem, Workspace};
pub use path::{Path, Station, Stepping};
pub use sparse::{Factor, HELD, Pattern};
pub use system::{Base, State, System};
