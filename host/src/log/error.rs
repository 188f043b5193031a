//! What can go wrong with a log.

use std::path::PathBuf;

/// A log could not be written or read.
#[derive(Debug, thiserror::Error)]
pub enum LogError {
    /// The file cannot be made, written or read.
    #[error("recording {}: {source}{}", .path.display(), advice(.source))]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The MCAP library refused.
    #[error("recording {}: {reason}", .path.display())]
    Mcap {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// A folder, a device or a pipe has the name.
    #[error("cannot record to {}: it is not a file; choose another name", .path.display())]
    NoFile {
        /// The name.
        path: PathBuf,
    },
    /// CSV and MCAP would go into one file.
    #[error("--csv and --mcap both name {}; they need two files", .path.display())]
    SameFile {
        /// The name.
        path: PathBuf,
    },
}

/// What is left of a recording that the disk takes no more of.
fn advice(source: &std::io::Error) -> &'static str {
    use std::io::ErrorKind as Kind;
    match source.kind() {
        Kind::StorageFull | Kind::QuotaExceeded | Kind::FileTooLarge => {
            "; what was recorded before is kept and complete. Free some space, or record to another disk"
        }
        _ => "",
    }
}
