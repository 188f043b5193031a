//! `palpate identify` as a script sees it: exit status, standard output, standard error.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output};

/// A folder of its own with an experiment of one run.
fn folder(name: &str, csv: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    fs::create_dir_all(&folder).unwrap();
    let description = "[specimen.a]\nheight_mm = 12.7\nradius_mm = 25\n[indenter.b]\nradius_mm = 4\n\
                       [[run]]\nfile = \"run.csv\"\nspecimen = \"a\"\nindenter = \"b\"\n";
    fs::write(folder.join("experiment.toml"), description).unwrap();
    fs::write(folder.join("run.csv"), csv).unwrap();
    folder
}

fn palpate(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_palpate")).args(arguments).output().unwrap()
}

/// A ramp through air, force flickering by a milli-newton.
fn air() -> String {
    let mut csv = "time_s,depth_mm,force_N\n".to_owned();
    for i in 0..150 {
        let flicker = f64::from(i * 37 % 11 - 5) * 2e-4;
        csv.push_str(&format!("{:.2},{:.2},{flicker:.5}\n", f64::from(i) * 0.02, f64::from(i) * 0.02));
    }
    csv
}

#[test]
fn nothing_found_is_an_answer() {
    let folder = folder("air", &air());
    let report = folder.join("report");
    // What an older palpate wrote there is not known as its own.
    let _ = fs::remove_dir_all(&report);
    let output = palpate(&["identify", folder.to_str().unwrap(), "--json", "--report", report.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let text = String::from_utf8(output.stdout).unwrap();
    let answer: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(answer["outcome"], "no-contact");
    assert_eq!(answer["fe_solves"], 0);
    let html = fs::read_to_string(answer["report"].as_str().unwrap()).unwrap();
    assert!(html.contains("force never rises above its noise"));
}

/// A ball that touches at 0.3 mm and pushes back as Hertz has it.
fn touch() -> String {
    let mut csv = "time_s,depth_mm,force_N\n".to_owned();
    for i in 0..150 {
        let depth = f64::from(i) * 0.02;
        csv.push_str(&format!("{depth:.2},{depth:.2},{:.5}\n", 0.5 * (depth - 0.3).max(0.0).powf(1.5)));
    }
    csv
}

/// Standard error in one line: the terminal's width may break a message anywhere.
fn said(output: &Output) -> String {
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    text.split_whitespace().filter(|w| *w != "│").collect::<Vec<_>>().join(" ")
}

#[test]
fn what_cannot_be_fitted_is_refused_before_a_solve() {
    let folder = folder("refused", &touch());
    let path = folder.to_str().unwrap();
    let refused = |options: &[&str]| {
        let output = palpate(&[&["identify", path, "--json"], options].concat());
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        assert!(output.stdout.is_empty());
        said(&output)
    };
    assert!(refused(&["--terms", "3"]).contains("3 is not in 1..=2"));
    assert!(refused(&["--method", "simplex", "--terms", "3"]).contains("3 is not in 1..=2"));
    assert!(refused(&["--nu", "0.6"]).contains("expected a number from -0.9 to 0.49"));
    assert!(refused(&["--friction=-1"]).contains("expected a number from 0 to 1"));
    let text = refused(&["--free", "stiffness"]);
    assert!(text.contains("possible values: nu, friction, platen-friction, height, ball-radius"), "{text}");
    let description = fs::read_to_string(folder.join("experiment.toml")).unwrap();
    fs::write(folder.join("experiment.toml"), description.replace("radius_mm = 4\n", "radius_mm = \"unknown\"\n"))
        .unwrap();
    let text = refused(&[]);
    assert!(text.contains("the radius of indenter \"b\" is unknown"), "{text}");
}

#[test]
fn bad_input_says_where_and_leaves_standard_output_empty() {
    let lines: Vec<String> =
        air().lines().enumerate().map(|(i, l)| if i == 56 { "1.1,1.1,NaN".into() } else { l.to_owned() }).collect();
    let folder = folder("nan", &lines.join("\n"));
    let output = palpate(&["identify", folder.to_str().unwrap(), "--json"]);
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    assert!(output.stdout.is_empty());
    let said = said(&output);
    assert!(said.contains("line 57, column 3 (force_N): \"NaN\" is NaN; expected a finite number"), "{said}");
    assert!(!said.contains('\u{1b}'), "no colours where nobody watches");
}
