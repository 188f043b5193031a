//! What can go wrong with a log.

use std::path::PathBuf;

/// A log could not be written or read.
#[derive(Debug, thiserror::Error)]
pub enum LogError {
    /// The file cannot be made, written or read.
    #[error("log {}: {source}", .path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The MCAP library refused.
    #[error("log {}: {reason}", .path.display())]
    Mcap {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
}
