//! A newcomer's walk: one press in many formats, the ball's radius and the specimen's height, and no editor.

use std::fs;
use std::path::PathBuf;

use palpate::experiment;
use palpate::init::{Options, free_folder, look, write};
use tempfile::TempDir;

use super::formats::{all, press};
use super::made;

const TWO_NUMBERS: Options = Options { ball_mm: Some(5.0), height_mm: Some(20.0), radius_mm: None, test: None };

#[test]
fn every_format_gives_the_same_samples() {
    let expected = press();
    for written in all() {
        let work = TempDir::new().unwrap();
        let file = work.path().join(written.name);
        fs::write(&file, &written.bytes).unwrap();
        let (draft, read) = made(&[file], &work.path().join("new"), &TWO_NUMBERS)
            .unwrap_or_else(|| panic!("{} holds no recording", written.name));
        assert_eq!(draft.to_fill_in(work.path(), &TWO_NUMBERS), [""; 0], "{}", written.name);
        assert_eq!(read.runs.len(), written.runs, "{}\n{}", written.name, draft.text(work.path(), &TWO_NUMBERS));
        let found = &read.runs[0].recording;
        assert_eq!(found.len(), expected.len(), "{}", written.name);
        for at in 0..expected.len() {
            // Nine decimals in the file, or six; 60 s to the unit of time at most, 1000 mm to that of depth.
            let pairs = [
                ("time", found.time_s[at], expected.time_s[at], 1e-6),
                ("depth", found.depth_mm[at], expected.depth_mm[at], 1e-6),
                ("force", found.force_n[at], expected.force_n[at], 1e-6),
            ];
            for (what, found, expected, tolerance) in pairs {
                assert!(
                    (found - expected).abs() < tolerance,
                    "{} row {at}: {what} {found}, expected {expected}",
                    written.name
                );
            }
        }
        assert!(draft.runs[0].shown().contains("one loading"), "{}: {}", written.name, draft.runs[0].shown());
    }
}

/// Files of one pattern are runs of one experiment, and what they share is said once.
#[test]
fn several_files_are_runs() {
    let work = TempDir::new().unwrap();
    let files: Vec<PathBuf> = (1..=3).map(|nth| work.path().join(format!("foam {nth}.csv"))).collect();
    files.iter().for_each(|file| fs::write(file, &all()[1].bytes).unwrap());
    let (draft, read) = made(&files, &work.path().join("new"), &TWO_NUMBERS).unwrap();
    assert_eq!(read.runs.len(), 3);
    let text = draft.text(&work.path().join("new"), &TWO_NUMBERS);
    assert_eq!(text.matches("delimiter = \";\"").count(), 1, "{text}");
    assert!(text.contains("file = \"../foam 2.csv\""), "{text}");
}

/// Without the two numbers the experiment is refused with the key to fill in.
#[test]
fn what_nobody_can_guess_is_asked_for() {
    let work = TempDir::new().unwrap();
    let file = work.path().join("a.csv");
    fs::write(&file, &all()[0].bytes).unwrap();
    let options = Options::default();
    let draft = look(&[file], &options);
    assert_eq!(draft.to_fill_in(work.path(), &options), ["[specimen.specimen] height_mm", "[indenter.ball] radius_mm"]);
    let written = write(work.path(), &draft.text(work.path(), &options)).unwrap();
    let said = experiment::read(&written).unwrap_err().to_string();
    assert!(said.contains("`height_mm` is \"FILL IN\"; expected a length of 0.05 to 1000 mm"), "{said}");
    let filled = fs::read_to_string(&written).unwrap().replacen("\"FILL IN\"", "20.0", 1);
    let said = experiment::parse(&written, &filled).unwrap_err().to_string();
    assert!(said.contains("`radius_mm` is \"FILL IN\"; expected the ball's radius"), "{said}");
}

/// An `experiment.toml` that is there stays.
#[test]
fn nothing_is_written_over() {
    let work = TempDir::new().unwrap();
    fs::write(work.path().join("experiment.toml"), "mine").unwrap();
    assert!(write(work.path(), "other").is_err());
    assert_eq!(fs::read_to_string(work.path().join("experiment.toml")).unwrap(), "mine");
    // A name that is free in this folder stays as it is.
    assert_eq!(free_folder(&PathBuf::from("data/no such recording.csv")), PathBuf::from("no such recording"));
    assert_eq!(free_folder(&PathBuf::from("src.csv")), PathBuf::from("src-2"));
}
