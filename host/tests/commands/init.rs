//! `palpate init` as a command: a table or JSON, a new folder, and no file written over.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

fn init(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_palpate"));
    command.current_dir(folder).arg("init").args(arguments).stdin(Stdio::null()).output().unwrap()
}

fn recording(folder: &Path) {
    let rows: String = (0..50)
        .map(|i| format!("{:.2};{:.3};{:.4}\n", 0.1 * f64::from(i), 0.05 * f64::from(i), 0.01 * f64::from(i * i)))
        .collect();
    let text = format!("Zeit (s);Weg (mm);Kraft (N)\n{rows}").replace('.', ",");
    fs::write(folder.join("foam A.csv"), text).unwrap();
}

#[test]
fn a_new_folder_is_written_and_told() {
    let work = tempfile::tempdir().unwrap();
    recording(work.path());
    let out = init(work.path(), &["foam A.csv", "--ball-mm", "4", "--height-mm", "20"]);
    let said = String::from_utf8(out.stdout).unwrap();
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    assert!(said.contains("foam A.csv  indentation  50 rows, 10 Hz, one loading of 2.45 mm at 0.5 mm/s"), "{said}");
    assert!(said.contains("then: palpate identify foam A"), "{said}");
    let text = fs::read_to_string(work.path().join("foam A/experiment.toml")).unwrap();
    assert!(text.contains("file = \"../foam A.csv\"") && text.contains("decimal = \",\""), "{text}");
    // The second call goes beside the first.
    assert!(init(work.path(), &["foam A.csv"]).status.success());
    assert!(work.path().join("foam A-2/experiment.toml").is_file());
    assert_eq!(fs::read_to_string(work.path().join("foam A/experiment.toml")).unwrap(), text);
}

#[test]
fn json_names_what_is_to_be_filled_in() {
    let work = tempfile::tempdir().unwrap();
    recording(work.path());
    let out = init(work.path(), &["foam A.csv", "--out", "new", "--json"]);
    let said: serde_json::Value = serde_json::from_slice(&out.stdout).unwrap();
    assert_eq!(said["to_fill_in"], serde_json::json!(["[specimen.specimen] height_mm", "[indenter.ball] radius_mm"]));
    assert_eq!(said["runs"][0]["keys"]["delimiter"], "\";\"");
    assert_eq!(said["unread"], serde_json::Value::Null);
}

#[test]
fn an_experiment_that_is_there_and_files_without_numbers_are_refused() {
    let work = tempfile::tempdir().unwrap();
    recording(work.path());
    fs::write(work.path().join("experiment.toml"), "mine").unwrap();
    let out = init(work.path(), &["foam A.csv", "--out", "."]);
    assert_eq!(out.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&out.stderr).contains("is not written over"));
    assert_eq!(fs::read_to_string(work.path().join("experiment.toml")).unwrap(), "mine");
    fs::write(work.path().join("notes.txt"), "nothing here").unwrap();
    let out = init(work.path(), &["notes.txt", "--out", "other"]);
    assert_eq!(out.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&out.stderr).contains("no table of numbers in it"));
    assert!(!work.path().join("other").exists());
}
