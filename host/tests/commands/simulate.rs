//! `palpate simulate` as a script sees it.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::path::Path;
use std::process::{Command, Output};

use palpate::experiment;

/// Two spots on the coarsest mesh.
const SPEC: &str = "name = \"small\"\nrefinement = 0.4\n[specimen.eva]\nmu_MPa = 0.2\nalpha = 8\nheight_mm = 12.7\n\
                    [indenter.r4]\nradius_mm = 4\n[[run]]\nspecimen = \"eva\"\nindenter = \"r4\"\nrate_mm_s = 2\ndepth_mm = 2\n\
                    replicates = 2\n[noise]\nsensor_N = 0.01\n[[effect]]\ncode = \"sensor-gain\"\ngain = 1.5\n";

fn palpate(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_palpate")).args(arguments).current_dir(folder).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

#[test]
fn a_folder_is_made_and_the_truth_stays_outside() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("spec.toml"), SPEC).unwrap();
    let done = palpate(folder.path(), &["simulate", "spec.toml", "--out", "made", "--truth", "truth.toml", "--json"]);
    assert!(done.status.success(), "{}", text(&done.stderr));
    let told: serde_json::Value = serde_json::from_slice(&done.stdout).unwrap();
    assert_eq!((&told["runs"], &told["samples"], &told["fe_solves"]), (&2.into(), &102.into(), &1.into()));
    assert_eq!(told["effects"][0]["parameters"]["gain"], 1.5);
    let read = experiment::read(&folder.path().join("made")).unwrap();
    assert_eq!((read.name.as_str(), read.runs.len(), read.runs[0].recording.len()), ("small", 2, 51));
    assert!(
        text(&std::fs::read(folder.path().join("truth.toml")).unwrap()).contains("code = \"sensor-gain\"\ngain = 1.5")
    );
    let inside = palpate(folder.path(), &["simulate", "spec.toml", "--out", "made", "--truth", "made/truth.toml"]);
    assert_eq!(inside.status.code(), Some(2));
    let told = text(&inside.stderr);
    assert!(told.contains("lies in the folder made") && !folder.path().join("made/truth.toml").exists(), "{told}");
}

#[test]
fn mistakes_end_with_2_and_say_where() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("spec.toml"), SPEC.replace("gain = 1.5", "gain = 0")).unwrap();
    let done = palpate(folder.path(), &["simulate", "spec.toml", "--out", "made"]);
    assert_eq!(done.status.code(), Some(2));
    let told = text(&done.stderr);
    assert!(told.contains("spec.toml, line 19, column 8: `gain` is 0; expected a gain of 0.01 to 100"), "{told}");
    assert!(done.stdout.is_empty() && !folder.path().join("made").exists());
}

#[test]
fn the_example_is_printed() {
    let done = palpate(Path::new("."), &["simulate", "--example"]);
    assert!(done.status.success());
    assert_eq!(text(&done.stdout), palpate::simulate::EXAMPLE);
}
