//! Implicit quasi-static solution: sparse tangent, Newton's method, path through a motion.

mod constraint;
mod error;
mod jump;
mod matrix;
mod motion;
mod newton;
mod pace;
mod path;
mod stepping;
mod system;

pub use crate::fem::sparse::{Factor, HELD, Pattern, Stored, elimination_order};
pub use error::SolveError;
pub use matrix::Matrix;
pub use motion::{Motion, Segment, Target};
pub use newton::{Configuration, Control, Newton, Problem, Workspace};
pub(crate) use path::remembers;
pub use path::{Accepted, Course, Observer, Path, Station};
pub use stepping::Stepping;
pub use system::{Base, History, State, Step, System};
