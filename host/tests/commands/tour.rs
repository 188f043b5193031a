//! `palpate tour`: the bench of the thesis in a random order, on the simulated board.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

fn tour(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_palpate"));
    command.current_dir(folder).arg("tour").args(arguments).output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).split_whitespace().filter(|word| *word != "│").collect::<Vec<_>>().join(" ")
}

/// Foams of the library are recognised, tissues are pressed beside them, and every press is a row.
#[test]
fn foams_and_tissues_are_pressed_in_a_random_order_and_told_apart() {
    let folder = tempfile::tempdir().unwrap();
    let output = tour(folder.path(), &["--presses", "18", "--bounding", "constrained", "--json"]);
    assert!(output.status.success(), "{}", said(&output));
    let told: Value = serde_json::from_slice(&output.stdout).unwrap();
    let stops = told["stops"].as_array().unwrap();
    let of = |name: &str| stops.iter().find(|stop| stop["stop"] == name).unwrap();
    for name in ["EVA", "B1", "ICF", "A2"] {
        let foam = of(name);
        assert_eq!(foam["search"]["right"], foam["search"]["presses"], "{foam}");
        assert_eq!(foam["in_library"], true);
    }
    assert_eq!((&of("liver")["in_library"], &of("liver")["search"]["right"]), (&false.into(), &0.into()));
    let rows = std::fs::read_to_string(folder.path().join("out/tour/presses.csv")).unwrap();
    let names: Vec<&str> = rows.lines().skip(1).map(|row| row.split(',').nth(1).unwrap()).collect();
    assert!((16..=20).contains(&names.len()), "{names:?}");
    assert!(names.windows(2).filter(|pair| pair[0] != pair[1]).count() > 7, "the order is shuffled: {names:?}");
    for name in ["tour.html", "mu-search.svg", "alpha-filter.svg", "tissues.svg", "surface.svg"] {
        let text = std::fs::read_to_string(folder.path().join("out/tour").join(name)).unwrap();
        assert!(!text.contains("NaN") && text.len() > 500, "{name}");
    }
}

#[test]
fn what_cannot_be_toured_is_told() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("t.toml"), "[stop.x]\nat_mm = [0, 0]\n").unwrap();
    for (arguments, expected) in [
        (&["t.toml"][..], "expected three numbers, the middle of its face"),
        (&["--rate", "40"], "--rate is 40"),
        (&["--depth", "9"], "--depth is 9"),
        (&["--bounding", "rope"], "possible values: penalty, projection, nearest-neighbour, constrained"),
    ] {
        let output = tour(folder.path(), arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(said(&output).contains(expected), "{arguments:?}: {}", said(&output));
    }
    let copied = tour(folder.path(), &["--copy", "mine.toml"]);
    assert!(copied.status.success(), "{}", said(&copied));
    let again = tour(folder.path(), &["--copy", "mine.toml"]);
    assert_eq!(again.status.code(), Some(2), "a user's file is not overwritten");
}
