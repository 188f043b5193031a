//! The self test could not be made.

use crate::link::LinkError;

/// Why the self-test program cannot be talked to.
#[derive(Debug, thiserror::Error)]
pub enum SelftestError {
    /// The way to the board failed.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// Nothing answers.
    #[error(
        "{board}: no answer to {request} within {waited_s:.1} s. Is the self-test program on the board (palpate selftest --flash ELF), \
         and is this the ST-LINK's port?"
    )]
    NoAnswer {
        /// The link.
        board: String,
        /// What was asked.
        request: &'static str,
        /// How long was waited, s.
        waited_s: f64,
    },
    /// The display board's firmware answers.
    #[error(
        "{board}: the firmware of the display board runs there, not the self-test program: palpate selftest --flash ELF writes it"
    )]
    DisplayBoard {
        /// The link.
        board: String,
    },
    /// Another version of the program.
    #[error(
        "{board}: the self-test program is of another version than this tool: write the one that was built with it"
    )]
    OtherVersion {
        /// The link.
        board: String,
    },
}
