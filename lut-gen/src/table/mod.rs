//! Look-up tables: force over depth on a grid of parameters, and their bytes.

mod grid;
mod library;
mod lut;

pub use grid::{ForceGrid, GridSpec, SecondTerm, UsedSpot};
pub use library::{CAP_RADIUS_MM, Foam, display_displacement_mm, foams};
pub use lut::{Form, LutError, library, lut, write};
