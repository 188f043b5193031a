//! Every raw file of `../shared/data`. The recordings are not part of this repository; without them the test says SKIPPED.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use palpate::experiment::Test;
use palpate::init::{Options, look};
use tempfile::TempDir;

use super::made;

/// Two numbers that suit every recording: no press is deeper than that specimen.
const TWO_NUMBERS: Options = Options { ball_mm: Some(5.0), height_mm: Some(100.0), radius_mm: None, test: None };

/// Files that hold no table, by the end of their names: descriptions, and a table of four rows.
const NO_TABLES: [&str; 4] =
    ["calibration2.txt", "README.txt", "comsol_parameters4.txt", "Kawamura_2001__BT_lambda_1d1.csv"];

/// Recordings of depth and force, and how many: all else are tables of other things.
const RECORDINGS: [(&str, usize); 7] = [
    ("aurora_dualmode", 8),
    ("beef_ball", 78),
    ("ecoflex", 15),
    ("linear_actuator_friction", 2),
    ("mr_damper_loops", 30),
    ("shoe_foam", 4),
    ("silicone_ball", 5),
];

fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files(&path, found);
        } else if path
            .extension()
            .is_some_and(|e| ["csv", "txt", "ddf", "xlsx", "xls", "ods"].iter().any(|ending| e == *ending))
        {
            found.push(path);
        }
    }
}

#[test]
fn every_raw_file_is_read_or_told() {
    let Some(data) = tests::shared_or_skipped("data") else { return };
    let mut all = Vec::new();
    files(&data, &mut all);
    all.sort();
    let work = TempDir::new().unwrap();
    let mut recordings: BTreeMap<String, usize> = BTreeMap::new();
    for (at, file) in all.iter().enumerate() {
        let Some((draft, read)) = made(std::slice::from_ref(file), &work.path().join(at.to_string()), &TWO_NUMBERS)
        else {
            assert!(NO_TABLES.iter().any(|name| file.ends_with(name)), "{}", file.display());
            continue;
        };
        assert_eq!(draft.unread, None, "{}", file.display());
        for (run, drafted) in read.runs.iter().zip(&draft.runs) {
            assert!(run.recording.len() >= 5, "{}", file.display());
            if run.test == Test::Table {
                assert!(!drafted.notes.is_empty());
                continue;
            }
            let set = file.strip_prefix(&data).unwrap().components().next().unwrap();
            *recordings.entry(set.as_os_str().to_string_lossy().into_owned()).or_default() += 1;
            // Where force is largest the indenter is deep: both directions are right.
            let largest = run.recording.force_n.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            assert!(largest > 0.0, "{}", file.display());
        }
    }
    println!("{} files, recordings: {recordings:?}", all.len());
    assert_eq!(recordings, RECORDINGS.iter().map(|(set, count)| ((*set).to_owned(), *count)).collect());
}

/// What the tests' own descriptions of these recordings say, made by hand: the same samples.
#[test]
fn as_described_by_hand() {
    if tests::shared_or_skipped("data").is_none() {
        return;
    }
    let by_hand = Path::new(env!("CARGO_MANIFEST_DIR")).join("experiments");
    for name in ["silicone_ball", "beef_ball", "ecoflex", "shoe_foam"] {
        let described = palpate::experiment::read(&by_hand.join(name)).unwrap();
        for run in &described.runs {
            let work = TempDir::new().unwrap();
            let (_, read) = made(std::slice::from_ref(&run.path), work.path(), &TWO_NUMBERS).unwrap();
            let found = &read.runs[0].recording;
            assert_eq!((&found.time_s, &found.line), (&run.recording.time_s, &run.recording.line), "{}", run.file);
            assert_eq!(found.force_n, run.recording.force_n, "{}", run.file);
            assert_eq!(found.depth_mm, run.recording.depth_mm, "{}", run.file);
        }
    }
}

/// Sizes that a file states of itself are taken, and a test that it names.
#[test]
fn what_a_file_says_of_itself() {
    let Some(file) = tests::shared_or_skipped("data/ecoflex/EF10_0T/EF10_0T_B2.csv") else { return };
    let draft = look(&[file], &Options::default());
    assert_eq!(draft.runs[0].test, Test::Uniaxial);
    let text = draft.text(Path::new("."), &Options::default());
    assert!(text.contains("height_mm = 30.0") && text.contains("radius_mm = 25.0"), "{text}");
}
