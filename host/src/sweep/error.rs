//! What can go wrong with the files of a sweep.

use std::path::PathBuf;

use lut_gen::sweep::{JournalError, MergeError};

/// Why a sweep did not run, or gave no table.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// The operating system refused.
    #[error("{what} {path}: {cause}")]
    Files {
        /// What was tried, such as "cannot write".
        what: &'static str,
        /// With what.
        path: PathBuf,
        /// The system's answer.
        cause: std::io::Error,
    },
    /// Another process writes the same journal.
    #[error("{0} is being written by another process; wait until it has ended, or choose another folder with --out")]
    Busy(PathBuf),
    /// The folder holds something else.
    #[error("{journal} belongs to another sweep: {difference}. Choose another folder with --out, or delete that one")]
    Other {
        /// A journal in the folder.
        journal: PathBuf,
        /// What differs.
        difference: String,
    },
    /// A journal that cannot be read.
    #[error("{journal} is not usable: {cause}")]
    Journal {
        /// The file.
        journal: PathBuf,
        /// What is wrong with it.
        cause: JournalError,
    },
    /// A folder without journals.
    #[error("{0} holds no journal of a sweep (*.journal); make one with `palpate lut sweep`")]
    Empty(PathBuf),
    /// Journals that make no table.
    #[error(transparent)]
    Merge(#[from] MergeError),
}

impl SweepError {
    pub(super) fn files(what: &'static str, path: &std::path::Path) -> impl FnOnce(std::io::Error) -> Self {
        let path = path.to_owned();
        move |cause| Self::Files { what, path, cause }
    }
}
