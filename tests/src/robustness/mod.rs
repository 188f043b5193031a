//! What must hold of everything that comes from outside, whatever its bytes: nothing panics, nothing unfinished takes effect, and what
//! is accepted is sound.
//!
//! Property tests (`tests/tests/suite/robustness.rs`, in every `cargo test`) and the fuzz targets (`tests/fuzz`) call the same four functions, with
//! the same seeds to begin from:
//!
//! | function | bytes are |
//! |---|---|
//! | [`frames`] | what arrives on the line, at the board and at the host |
//! | [`messages`] | messages whose frames are sound: kind, length, body, and so on |
//! | [`table`] | a look-up table, also with its CRCs made right |
//! | [`experiment`] | `experiment.toml`, a line of `%%`, and its data file |

mod board;
mod experiment;
mod frames;
mod messages;
pub mod seeds;
mod table;

pub use board::{Portrait, blank_board};
pub use experiment::{SEPARATOR, experiment};
pub use frames::{Recorded, frames};
pub use messages::messages;
pub use table::{sealed, table};

/// Nothing, or what does not hold.
pub type Held = Result<(), String>;
