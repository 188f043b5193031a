//! The studies of thesis chapter 2 as commands: each answers one question of the inverse problem with numbers and pictures.
//!
//! ```text
//! subject     whose recordings: an experiment folder, or a simulated foam whose truth, noise and seed are stated
//! findings    what a study hands over: lines, tables, pictures, one JSON object; written as page and SVG files
//! objective   the valley of Eq. 14 and the ways down it (Figs. 9, 10, 13)
//! script      the simplex that is printed, on the liver (appendix C)
//! depth       parameters against depth for each ball (Fig. 11)
//! trend       lines through parameters, and where they cross
//! curve       measured against predicted (Figs. 12, 14)
//! terms       the equivalent optima of two terms (Table 2)
//! rivals      optimisers on one problem (Fig. 89)
//! ```

pub mod curve;
pub mod depth;
mod error;
pub mod findings;
pub mod objective;
pub mod rivals;
pub mod script;
pub mod subject;
pub mod terms;
pub mod trend;

pub use error::StudyError;
pub use findings::{DEFAULT_FOLDER, Findings};
pub use subject::{Foam, Subject};
