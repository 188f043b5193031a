//! Where results come from: program, command, date, and the files that were read.

use std::collections::BTreeSet;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use jiff::Timestamp;
use serde_json::{Value, json};
use sha2::{Digest, Sha256};

use crate::experiment::Experiment;
use crate::report::Page;

/// Name of the program in files.
pub const PROGRAM: &str = "palpate";
/// The commit it was built from, where that was known.
pub const COMMIT: Option<&str> = option_env!("PALPATE_COMMIT");
/// Bytes that are read at once.
const PIECE: usize = 1 << 16;

/// A file that was read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Input {
    /// Where it is.
    pub path: PathBuf,
    /// SHA-256 of its bytes, hexadecimal; none where it could not be read again.
    pub sha256: Option<String>,
}

/// Where results come from.
#[derive(Debug, Clone, PartialEq)]
pub struct Provenance {
    /// The command line.
    pub command: Vec<String>,
    /// When the files were read, UTC.
    pub at: Timestamp,
    /// Files that were read, each once.
    pub inputs: Vec<Input>,
}

impl Provenance {
    /// Of this call, on these files.
    #[must_use]
    pub fn of(files: impl IntoIterator<Item = PathBuf>) -> Self {
        let files: BTreeSet<PathBuf> = files.into_iter().filter(|path| !path.as_os_str().is_empty()).collect();
        let input = |path: PathBuf| Input { sha256: sha256(&path).ok(), path };
        Self {
            command: std::env::args_os().map(|word| word.to_string_lossy().into_owned()).collect(),
            at: Timestamp::now(),
            inputs: files.into_iter().map(input).collect(),
        }
    }

    /// Of this call on an experiment that was just read, and on other files beside it.
    #[must_use]
    pub fn of_experiment(named: &Path, experiment: &Experiment, others: &[&Path]) -> Self {
        let description = if named.is_file() { named.to_owned() } else { named.join("experiment.toml") };
        let runs = experiment.runs.iter().map(|run| run.path.clone());
        Self::of(std::iter::once(description).chain(runs).chain(others.iter().map(|path| path.to_path_buf())))
    }

    /// As it stands in files; `seconds` is how long the command took.
    #[must_use]
    pub fn json(&self, seconds: f64) -> Value {
        let inputs: Vec<Value> = self
            .inputs
            .iter()
            .map(|input| json!({ "path": input.path.display().to_string(), "sha256": input.sha256 }))
            .collect();
        json!({
            "program": PROGRAM, "version": env!("CARGO_PKG_VERSION"), "commit": COMMIT, "command": self.command,
            "date_utc": self.date(), "seconds": seconds, "inputs": inputs,
        })
    }

    /// Date and time in UTC, as in ISO 8601.
    #[must_use]
    pub fn date(&self) -> String {
        self.at.strftime("%Y-%m-%dT%H:%M:%SZ").to_string()
    }

    /// Program and version, with the commit where it is known.
    #[must_use]
    pub fn version() -> String {
        let commit = COMMIT.map_or_else(String::new, |commit| format!(" (commit {commit})"));
        format!("{PROGRAM} {}{commit}", env!("CARGO_PKG_VERSION"))
    }

    /// Closes a page with it.
    pub fn section(&self, page: &mut Page) {
        page.section("Where this comes from");
        let row = |name: &str, value: String| vec![name.to_owned(), value];
        let rows = [row("program", Self::version()), row("command", self.command.join(" ")), row("date", self.date())];
        page.table(&["", ""], &rows);
        if self.inputs.is_empty() {
            return;
        }
        page.fold("Files that were read, with their SHA-256");
        let told = |input: &Input| {
            vec![input.path.display().to_string(), input.sha256.clone().unwrap_or_else(|| "not readable".to_owned())]
        };
        page.table(&["file", "SHA-256"], &self.inputs.iter().map(told).collect::<Vec<_>>());
        page.unfold();
    }
}

/// SHA-256 of a file, hexadecimal.
///
/// # Errors
/// A file that cannot be read.
pub fn sha256(path: &Path) -> io::Result<String> {
    let mut file = File::open(path)?;
    let mut hash = Sha256::new();
    let mut piece = vec![0; PIECE];
    loop {
        match file.read(&mut piece)? {
            0 => break,
            read => hash.update(&piece[..read]),
        }
    }
    Ok(hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect())
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn files_are_told_once_by_the_hash_of_their_bytes() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.csv");
        std::fs::write(&file, "abc").unwrap();
        let told = Provenance::of([file.clone(), file, folder.path().join("missing.csv"), PathBuf::new()]);
        assert_eq!(told.inputs.len(), 2);
        // FIPS 180-2, appendix B.1
        let abc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(told.inputs[0].sha256.as_deref(), Some(abc));
        assert_eq!(told.inputs[1].sha256, None);
        let json = told.json(1.5);
        assert_eq!(json["version"], env!("CARGO_PKG_VERSION"));
        assert!(json["date_utc"].as_str().unwrap().ends_with('Z'));
    }
}
