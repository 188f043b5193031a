//! Recording: the same logs as those of `palpate log`, in a folder, numbered.

use std::path::{Path, PathBuf};

use crate::log::{LogError, Recorder};
use crate::plant::Truth;
use crate::session::{Event, Traffic};

/// Most recordings in a folder.
const MOST: u32 = 100_000;

/// Logs that are being written.
#[derive(Debug)]
pub struct Recording {
    recorder: Recorder,
    csv: PathBuf,
}

impl Recording {
    /// Begins `recording-NNN.csv` and `.mcap` with the first number that no file in `folder` has; makes the folder.
    ///
    /// # Errors
    /// [`LogError`] when folder or files cannot be made.
    pub fn begin(folder: &Path) -> Result<Self, LogError> {
        let failed = |source| LogError::File { path: folder.into(), source };
        std::fs::create_dir_all(folder).map_err(failed)?;
        let (csv, mcap) = (1..MOST)
            .map(|n| [format!("recording-{n:03}.csv"), format!("recording-{n:03}.mcap")].map(|name| folder.join(name)))
            .map(|[csv, mcap]| (csv, mcap))
            .find(|(csv, mcap)| !csv.exists() && !mcap.exists())
            .ok_or_else(|| failed(std::io::Error::other("it holds all the recordings it can")))?;
        Ok(Recording { recorder: Recorder::create(Some(&csv), Some(&mcap))?, csv })
    }

    /// The CSV file; the MCAP file has the same name with its own extension.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.csv
    }

    /// Logs true physics, before the event of its tick.
    ///
    /// # Errors
    /// [`LogError`] when writing fails.
    pub fn truth(&mut self, truth: Truth) -> Result<(), LogError> {
        self.recorder.truth(truth)
    }

    /// Logs what the board said.
    ///
    /// # Errors
    /// [`LogError`] when writing fails.
    pub fn event(&mut self, event: &Event, traffic: &Traffic) -> Result<(), LogError> {
        self.recorder.event(event, traffic)
    }

    /// Ends the logs properly.
    ///
    /// # Errors
    /// [`LogError`] when writing fails.
    pub fn finish(self) -> Result<(), LogError> {
        self.recorder.finish()
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn each_recording_has_a_name_of_its_own() {
        let folder = tempfile::tempdir().unwrap();
        let inside = folder.path().join("a/b");
        for n in 1..4 {
            let recording = Recording::begin(&inside).unwrap();
            assert_eq!(recording.path(), inside.join(format!("recording-{n:03}.csv")));
            recording.finish().unwrap();
        }
        std::fs::remove_file(inside.join("recording-002.csv")).unwrap();
        // Its MCAP file is still there.
        assert_eq!(Recording::begin(&inside).unwrap().path(), inside.join("recording-004.csv"));
    }

    #[test]
    fn a_folder_that_cannot_be_made_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        std::fs::write(&file, "").unwrap();
        let error = Recording::begin(&file.join("in")).unwrap_err().to_string();
        assert!(error.starts_with(&format!("log {}: ", file.join("in").display())), "{error}");
    }
}
