//! Recording: the same logs as those of `palpate log`, in a folder, numbered.

use std::path::{Path, PathBuf};

use crate::log::{About, LogError, Recorder};
use crate::plant::Truth;
use crate::session::{Event, Traffic};

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
        let recorder = Recorder::create_numbered(folder, "recording")?;
        let csv = recorder.csv_path().unwrap_or(folder).to_owned();
        Ok(Recording { recorder, csv })
    }

    /// The CSV file; the MCAP file has the same name with its own extension.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.csv
    }

    /// Says whose recording it is.
    ///
    /// # Errors
    /// [`LogError`] when writing fails.
    pub fn about(&mut self, about: &About) -> Result<(), LogError> {
        self.recorder.about(about)
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

    /// Logs that nothing is heard any more, and why.
    ///
    /// # Errors
    /// [`LogError`] when writing fails.
    pub fn gap_begins(&mut self, why: &str) -> Result<(), LogError> {
        self.recorder.gap_begins(why)
    }

    /// Brings what was logged to the disk when it is time to.
    ///
    /// # Errors
    /// [`LogError`] when writing fails.
    pub fn keep_if_due(&mut self) -> Result<(), LogError> {
        self.recorder.keep_if_due()
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
        assert!(error.starts_with(&format!("recording {}: ", file.join("in").display())), "{error}");
    }
}
