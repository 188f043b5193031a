//! The journals in folders.

use std::path::{Path, PathBuf};

use lut_gen::sweep::{Journal, JournalError};

use super::SweepError;

/// A journal and where it is.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// The file.
    pub path: PathBuf,
    /// What is in it.
    pub journal: Journal,
}

/// Ending of a journal's name.
pub(super) const ENDING: &str = "journal";

/// The journals of a folder, in the order of their names; or the one that `path` names. One whose
/// header is not finished holds nothing and is left out.
///
/// # Errors
/// [`SweepError`]: unreadable files, damaged journals.
pub fn journals(path: &Path) -> Result<Vec<Found>, SweepError> {
    let files = if path.is_dir() { listed(path)? } else { vec![path.to_owned()] };
    let mut found = Vec::new();
    for path in files {
        let bytes = std::fs::read(&path).map_err(SweepError::files("cannot read", &path))?;
        match Journal::parse(&bytes) {
            Ok(journal) => found.push(Found { path, journal }),
            Err(JournalError::Begun(_)) => {}
            Err(cause) => return Err(SweepError::Journal { journal: path, cause }),
        }
    }
    Ok(found)
}

/// The names of the journals in a folder, sorted.
pub(super) fn listed(folder: &Path) -> Result<Vec<PathBuf>, SweepError> {
    let entries = std::fs::read_dir(folder).map_err(SweepError::files("cannot list", folder))?;
    let mut files = entries
        .map(|entry| entry.map(|e| e.path()))
        .collect::<Result<Vec<_>, _>>()
        .map_err(SweepError::files("cannot list", folder))?;
    files.retain(|file| file.extension().is_some_and(|e| e == ENDING));
    files.sort();
    Ok(files)
}
