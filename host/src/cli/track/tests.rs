#![allow(clippy::unwrap_used)]
use clap::Parser;

use super::*;
use crate::track::{Measure, Position, Tip};

#[derive(Debug, Parser)]
struct Line {
    #[command(flatten)]
    arguments: Arguments,
}

fn told(words: &[&str]) -> String {
    let line = Line::try_parse_from(std::iter::once("track").chain(words.iter().copied()));
    match line {
        Ok(line) => format!("{:?}", run(&line.arguments).unwrap_err()),
        Err(error) => error.to_string(),
    }
    .replace("\n  │ ", " ")
}

#[test]
fn bad_words_are_told_with_what_was_expected() {
    let folder = tempfile::tempdir().unwrap();
    let empty = folder.path().to_str().unwrap();
    let roi = ["--roi", "10,10,20,20"];
    let with = |words: &[&str]| told(&[&[empty], &roi[..], words].concat());
    assert!(told(&[empty, "--roi", "1,2,3"]).contains("expected X,Y,WIDTH,HEIGHT in whole pixels"));
    assert!(with(&[]).contains("has no PNG file; expected frames such as frame_0001.png"));
    assert!(with(&["--fps", "0"]).contains("--fps is 0; expected more than 0"));
    assert!(with(&["--mm-per-px=-1"]).contains("--mm-per-px"));
    assert!(with(&["--marker", "1,1,9,9"]).contains("--marker-mm"));
    assert!(with(&["--surface", "nan"]).contains("--surface is NaN; expected a row in pixels"));
    assert!(told(&["absent.y4m", "--roi", "1,1,9,9"]).contains("cannot read absent.y4m"));
    let mine = folder.path().join("mine.csv");
    std::fs::write(&mine, "mine").unwrap();
    assert!(with(&["--out", mine.to_str().unwrap()]).contains("exists and is kept; --force replaces it"));
    assert_eq!(std::fs::read_to_string(&mine).unwrap(), "mine");
    assert!(point("1;2").unwrap_err().to_string().contains("--tip is 1;2; expected X,Y"));
}

#[test]
fn an_encoder_with_a_mistake_is_told_by_its_line() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("encoder.csv");
    std::fs::write(&file, "time_s,height_mm\n0,1\n0.1,x\n").unwrap();
    assert!(Encoder::read(&file).unwrap_err().to_string().contains("line 3: expected time (s) and height (mm)"));
    std::fs::write(&file, "0,1\n0,2\n").unwrap();
    assert!(Encoder::read(&file).unwrap_err().to_string().contains("rising times"));
}

/// Places of 0, 1, 2, ... px are heights of the same numbers; one is wrong by 1000.
#[test]
fn one_wrong_place_leaves_the_zero_of_the_encoder() {
    let tip = |height: f64| Tip {
        place_px: [0.0, -height],
        sigma_px: [0.1; 2],
        own_sigma_px: [0.1; 2],
        correlation: 1.0,
        seen: 1.0,
        gain: 1.0,
    };
    let position = |frame: usize| {
        let height = frame as f64 + if frame == 7 { 1000.0 } else { 0.0 };
        Position { frame, time_s: Some(frame as f64), tip: Some(tip(height)) }
    };
    let positions: Vec<Position> = (0..10).map(position).collect();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("encoder.csv");
    std::fs::write(&file, (0..12).map(|t| format!("{t},{}\n", t + 40)).collect::<String>()).unwrap();
    let mut encoder = Encoder::read(&file).unwrap();
    encoder.compare(&positions, &Measure::default());
    assert!((encoder.rows[3][1] - 3.0).abs() < 1e-9, "{:?}", encoder.rows);
}
