//! What can go wrong when a board is written.

use std::path::PathBuf;

use protocol::lut::TableError;

use super::OptionRefusal;
use crate::session::SessionError;

/// A board could not be written.
#[derive(Debug, thiserror::Error)]
pub enum FlashingError {
    /// No probe is plugged in.
    #[error("no debug probe found: connect a USB cable to the board's ST-LINK connector (CN1) and try again")]
    NoProbe,
    /// Other probes are plugged in.
    #[error("no debug probe with serial number {serial}; found: {}", listed(.found))]
    NoSuchProbe {
        /// The number asked for.
        serial: String,
        /// What is there.
        found: Vec<String>,
    },
    /// More than one probe is plugged in.
    #[error("{} debug probes found: choose one with --probe SERIAL: {}", .found.len(), listed(.found))]
    ManyProbes {
        /// What is there.
        found: Vec<String>,
    },
    /// The probe may not be opened.
    #[error(
        "no permission to open {probe}: on Linux install the udev rules of probe-rs (https://probe.rs/docs/getting-started/probe-setup)"
    )]
    NoPermission {
        /// The probe.
        probe: String,
    },
    /// Neither firmware nor table.
    #[error("nothing to write: name an ELF file, or a table with --table")]
    Nothing,
    /// A file cannot be read.
    #[error("{}: {source}", .path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A file is not firmware for this board.
    #[error("{}: not firmware for this board: {reason}", .path.display())]
    Firmware {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// A file is not a table.
    #[error("{}: {source}", .path.display())]
    Table {
        /// The file.
        path: PathBuf,
        /// What its check found.
        source: TableError,
    },
    /// A table is too long for bank 2.
    #[error("{}: table of {length} bytes, flash bank 2 has {limit}", .path.display())]
    TableTooLarge {
        /// The file.
        path: PathBuf,
        /// Its length.
        length: u64,
        /// What fits.
        limit: u64,
    },
    /// The option bytes stay as they are.
    #[error(transparent)]
    Options(#[from] OptionRefusal),
    /// The chip or the probe failed.
    #[error("{chip}: cannot {what}: {source}")]
    Chip {
        /// The chip.
        chip: String,
        /// What was tried.
        what: &'static str,
        /// Why.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
    /// The written board does not answer, or not in this version of the protocol.
    #[error("written and verified, but {0}")]
    Greeting(#[from] SessionError),
    /// The written board is not what was written.
    #[error(
        "the board has started, but its {what} is {found}, expected {expected}: is the ELF file that of this tool?"
    )]
    Started {
        /// What differs.
        what: &'static str,
        /// What the board says.
        found: String,
        /// What was written.
        expected: String,
    },
}

fn listed(found: &[String]) -> String {
    if found.is_empty() { "none".into() } else { found.join(", ") }
}
