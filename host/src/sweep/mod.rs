//! Sweeps on disk: the description a user writes, the journals of a folder, the merged table.
//!
//! What a sweep is and how its bytes look is the business of [`lut_gen::sweep`]; here is what has to do with files.

mod description;
mod error;
mod folder;
mod journals;

pub use description::{parse, read};
pub use error::SweepError;
pub use folder::{Folder, Keeper};
pub use journals::{Found, journals};
