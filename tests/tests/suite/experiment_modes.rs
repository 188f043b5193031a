//! What an experiment folder says of runs without a ball: areas, time windows, columns of a single run; and its mistakes.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;

use palpate::experiment::{self, Experiment, Length};
use tempfile::TempDir;

const DESCRIPTION: &str = r#"name = "strip"
[specimen.strip]
height_mm = 20.0
area_mm2 = 50.0
[[run]]
file = "a.csv"
specimen = "strip"
test = "tension"
"#;

fn folder(description: &str, csv: &str) -> TempDir {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("experiment.toml"), description).unwrap();
    fs::write(folder.path().join("a.csv"), csv).unwrap();
    folder
}

/// Elongation by 0.1 mm a sample of 0.1 s, the force one tenth of it, both with a sign.
fn pulled(sign: f64) -> String {
    let row = |i: i32| {
        format!("{:.1},{:.1},{:.2}\n", 0.1 * f64::from(i), sign * 0.1 * f64::from(i), sign * 0.01 * f64::from(i))
    };
    "time_s,depth_mm,force_N\n".to_owned() + &(0..300).map(row).collect::<String>()
}

fn read(description: &str, csv: &str) -> Experiment {
    experiment::read(folder(description, csv).path()).unwrap()
}

fn said(description: &str) -> String {
    let folder = folder(description, &pulled(1.0));
    let error = experiment::read(folder.path()).expect_err("this must be refused").to_string();
    error.replace(&format!("{}/", folder.path().display()), "")
}

#[test]
fn an_area_stands_for_the_circle_and_a_pull_has_either_sign() {
    for sign in [1.0, -1.0] {
        let strip = read(DESCRIPTION, &pulled(sign));
        let Length::Known(radius_mm) = strip.specimens[0].radius_mm else { panic!("{:?}", strip.specimens) };
        assert!((std::f64::consts::PI * radius_mm * radius_mm - 50.0).abs() < 1e-12);
        // Elongation by more than the height is no mistake, as depth would be.
        let recording = &strip.runs[0].recording;
        assert!((recording.depth_mm[299] - 29.9).abs() < 1e-9 && (recording.force_n[299] - 2.99).abs() < 1e-9);
    }
}

#[test]
fn a_window_of_time_is_read() {
    let window = DESCRIPTION.replace("test =", "from_s = 5.0\nto_s = 10.0\ntest =");
    let strip = read(&window, &pulled(1.0));
    let recording = &strip.runs[0].recording;
    assert_eq!((recording.len(), recording.time_s[0], recording.time_s[50]), (51, 5.0, 10.0));
    assert_eq!((recording.depth_mm.len(), recording.force_n.len(), recording.line[0]), (51, 51, 52));
}

#[test]
fn columns_and_format_of_a_single_run_come_before_those_of_all() {
    let csv = "t\tx\tF\t\n0.0\t0.0\t0.0\t\n1.0\t2.0\t3.0\t\n";
    let all = "name = \"strip\"\n[columns]\ntime_s = \"t\"\nforce_N = \"load\"\n";
    let of_run = r#"[run.format]
delimiter = "\t"
[run.columns]
force_N = "F"
depth_mm = { name = "x", scale = 0.5 }
"#;
    let own = DESCRIPTION.replace("name = \"strip\"\n", all) + of_run;
    let recording = read(&own, csv).runs[0].recording.clone();
    // The delimiter at the end of every row opens no cell.
    assert_eq!((recording.time_s[1], recording.depth_mm[1], recording.force_n[1]), (1.0, 1.0, 3.0));
}

#[test]
fn mistakes_are_named() {
    let both = DESCRIPTION.replace("area_mm2 = 50.0", "radius_mm = 4.0\narea_mm2 = 50.0");
    assert_eq!(
        said(&both),
        "experiment.toml, line 5, column 12: `area_mm2` and `radius_mm` say the same; state one of them"
    );
    let negative = DESCRIPTION.replace("50.0", "-1.0");
    assert_eq!(
        said(&negative),
        "experiment.toml, line 4, column 12: `area_mm2` is -1.0; expected an area of 0.01 to 1000000 mm2"
    );
    let neither = DESCRIPTION.replace("area_mm2 = 50.0\n", "");
    assert!(said(&neither).contains("lacks the key `radius_mm`"), "{}", said(&neither));
    let late = DESCRIPTION.replace("test =", "from_s = 40\ntest =");
    assert_eq!(
        said(&late),
        "experiment.toml, line 8, column 10: no sample lies between `from_s` and `to_s`; the recording has times from 0 to 29.9 s"
    );
    let one = DESCRIPTION.replace("test =", "place_mm = [4.0]\ntest =");
    assert_eq!(
        said(&one),
        "experiment.toml, line 8, column 12: `place_mm` is an array; expected two places in mm, each of -10000 to 10000, such as place_mm = [4.0, -2.5]"
    );
    let far = DESCRIPTION.replace("test =", "place_mm = [4.0, \"left\"]\ntest =");
    assert!(said(&far).contains("line 8, column 18: `place_mm` is \"left\"; expected two places"), "{}", said(&far));
    let run = DESCRIPTION.find("[[run]]").unwrap();
    let twice =
        format!("{0}spot = 3\nplace_mm = [1, 2]\n{1}spot = 3\nplace_mm = [1, 2.5]\n", DESCRIPTION, &DESCRIPTION[run..]);
    assert!(said(&twice).ends_with(": spot 3 lies at [1, 2.5] mm here and at [1, 2] in a.csv"), "{}", said(&twice));
    let word = DESCRIPTION.replace("test =", "to_s = \"soon\"\ntest =");
    assert_eq!(
        said(&word),
        "experiment.toml, line 8, column 8: `to_s` is \"soon\"; expected a time in s on the file's clock"
    );
    let key = format!("{DESCRIPTION}[run.format]\ndelimitr = \";\"\n");
    assert!(said(&key).contains("unknown key `delimitr` in [format]; did you mean `delimiter`?"), "{}", said(&key));
}
