//! A case as it lies there, or copied to be changed; folders of one's own.

use std::fs;
use std::path::{Path, PathBuf};

use palpate::experiment::{self, Experiment, Recording};
use tempfile::TempDir;

/// The input of a case, or `None` with a visible message if it is absent.
pub fn input(name: &str) -> Option<PathBuf> {
    tests::shared_or_skipped(&format!("cases/{name}/input"))
}

/// A copy of a case with texts of its `experiment.toml` replaced, each of which must be there.
pub fn changed(name: &str, changes: &[(&str, &str)]) -> Option<TempDir> {
    let input = input(name)?;
    let copy = TempDir::new().unwrap();
    for entry in fs::read_dir(input).unwrap() {
        let entry = entry.unwrap();
        fs::write(copy.path().join(entry.file_name()), fs::read(entry.path()).unwrap()).unwrap();
    }
    let file = copy.path().join("experiment.toml");
    let mut text = fs::read_to_string(&file).unwrap();
    for (from, to) in changes {
        assert!(text.contains(from), "{name} has no {from:?}");
        text = text.replace(from, to);
    }
    fs::write(file, text).unwrap();
    Some(copy)
}

/// What an experiment is refused with, without the folder's name.
pub fn message(folder: &Path) -> String {
    let error = experiment::read(folder).expect_err("this must be refused");
    error.to_string().replace(&format!("{}/", folder.display()), "")
}

/// An experiment read from a folder.
pub fn read(folder: &Path) -> Experiment {
    experiment::read(folder).unwrap_or_else(|error| panic!("{error}"))
}

/// A folder with one run whose data file is `data`; `keys` stand before the specimen, `of_run` in the run.
pub fn folder(file: &str, data: &[u8], keys: &str, of_run: &str) -> TempDir {
    let folder = TempDir::new().unwrap();
    let text = format!(
        "{keys}\n[specimen.foam]\nheight_mm = 20.0\nradius_mm = 30.0\n[indenter.ball]\nradius_mm = 5.0\n\
         [[run]]\nfile = \"{file}\"\nspecimen = \"foam\"\nindenter = \"ball\"\n{of_run}\n"
    );
    fs::write(folder.path().join("experiment.toml"), text).unwrap();
    fs::write(folder.path().join(file), data).unwrap();
    folder
}

/// The only run of a folder.
pub fn recording(folder: &TempDir) -> Recording {
    read(folder.path()).runs.remove(0).recording
}

/// Samples agree to `tolerance`: what the digits of a file leave.
pub fn agree(found: &Recording, expected: &Recording, tolerance: f64) {
    assert_eq!(found.len(), expected.len());
    let columns =
        [(&found.time_s, &expected.time_s), (&found.depth_mm, &expected.depth_mm), (&found.force_n, &expected.force_n)];
    for (name, (found, expected)) in ["time", "depth", "force"].iter().zip(columns) {
        assert_eq!(found.len(), expected.len(), "{name}");
        for (at, (a, b)) in found.iter().zip(expected).enumerate() {
            assert!((a - b).abs() <= tolerance, "{name} {at}: {a}, expected {b}");
        }
    }
}
