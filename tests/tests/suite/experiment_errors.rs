//! The texts of mistakes in experiment folders: file, line, column, value, expectation.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::path::Path;

use palpate::experiment;
use proptest::prelude::*;
use tempfile::TempDir;

const DESCRIPTION: &str = r#"name = "EVA"
[specimen.eva]
base_law = "hyperfoam"
terms = 1
height_mm = 12.7
radius_mm = 25.0
base = "bonded"
[indenter.r4]
radius_mm = 4.0
[sensor]
noise_N = 0.002
[[run]]
file = "a.csv"
specimen = "eva"
indenter = "r4"
"#;

fn samples(count: usize) -> String {
    let mut csv = "time_s,depth_mm,force_N\n".to_owned();
    for i in 0..count {
        let depth = i as f64 * 0.02;
        csv.push_str(&format!("{:.2},{depth:.3},{:.5}\n", depth, 0.3 * depth.powf(1.5)));
    }
    csv
}

fn folder(description: &str, csv: &[u8]) -> TempDir {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("experiment.toml"), description).unwrap();
    fs::write(folder.path().join("a.csv"), csv).unwrap();
    folder
}

/// The message with the temporary folder's name taken out.
fn message(path: &Path) -> String {
    let error = experiment::read(path).expect_err("this must be refused");
    error.to_string().replace(&format!("{}/", path.display()), "")
}

fn of_description(description: &str) -> String {
    message(folder(description, samples(100).as_bytes()).path())
}

fn of_csv(csv: &str) -> String {
    message(folder(DESCRIPTION, csv.as_bytes()).path())
}

/// `samples(100)` with one line (from 1, the header is line 1) replaced.
fn with_line(line: usize, text: &str) -> String {
    let all = samples(100);
    let mut lines: Vec<&str> = all.lines().collect();
    lines[line - 1] = text;
    lines.join("\n") + "\n"
}

#[test]
fn a_correct_folder_is_read() {
    let folder = folder(DESCRIPTION, samples(100).as_bytes());
    let read = experiment::read(folder.path()).unwrap();
    assert_eq!(read.name, "EVA");
    assert_eq!(read.runs[0].recording.len(), 100);
    assert_eq!(read.runs[0].recording.line[0], 2);
    assert_eq!(read.sensor.noise_n, Some(0.002));
    assert_eq!(read.specimens[0].height_mm.known(), Some(12.7));
}

#[test]
fn mistakes_in_the_description() {
    let cases = [
        (
            DESCRIPTION.replace("height_mm", "heigth_mm"),
            "experiment.toml, line 5, column 1: unknown key `heigth_mm` in [specimen.eva]; did you mean `height_mm`?",
        ),
        (
            DESCRIPTION.replace("[sensor]", "[sensor]\ncolour = 1"),
            "experiment.toml, line 11, column 1: unknown key `colour` in [sensor]; known keys: noise_N, zero",
        ),
        (
            DESCRIPTION.replace("height_mm = 12.7\n", ""),
            "experiment.toml, line 2, column 1: [specimen.eva] lacks the key `height_mm` (a length of 0.05 to 1000 mm, or \"unknown\")",
        ),
        (
            DESCRIPTION.replace("12.7", "-12.7"),
            "experiment.toml, line 5, column 13: `height_mm` is -12.7; expected a length of 0.05 to 1000 mm, or \"unknown\"",
        ),
        (
            DESCRIPTION.replace("12.7", "nan"),
            "experiment.toml, line 5, column 13: `height_mm` is nan; expected a length of 0.05 to 1000 mm, or \"unknown\"",
        ),
        (
            DESCRIPTION.replace("\"bonded\"", "\"glued\""),
            "experiment.toml, line 7, column 8: `base` is \"glued\"; expected one of \"bonded\", \"sliding\"",
        ),
        (
            DESCRIPTION.replace("specimen = \"eva\"", "specimen = \"eve\""),
            "experiment.toml, line 14, column 12: `specimen` names \"eve\", which is not described; known: eva",
        ),
        (DESCRIPTION.replace("a.csv", "b.csv"), "experiment.toml, line 13, column 8: no such file: b.csv"),
        (
            DESCRIPTION.split("[[run]]").next().unwrap().to_owned(),
            "experiment.toml, line 1, column 1: the file lacks the key `run` (at least one [[run]] with the file it was recorded in)",
        ),
    ];
    for (description, expected) in cases {
        assert_eq!(of_description(&description), expected);
    }
    let syntax = of_description("name = \n");
    assert!(syntax.starts_with("experiment.toml, line 1, column 8: not valid TOML: "), "{syntax}");
}

#[test]
fn a_missing_folder_is_named() {
    let folder = TempDir::new().unwrap();
    let text = experiment::read(&folder.path().join("nowhere")).unwrap_err().to_string();
    assert!(text.contains("nowhere/experiment.toml: no such file"), "{text}");
}

#[test]
fn mistakes_in_the_data() {
    let cases = [
        (
            with_line(57, "1.10,1.100,NaN"),
            "a.csv, line 57, column 3 (force_N): \"NaN\" is NaN; expected a finite number",
        ),
        (
            with_line(57, "1.10,inf,0.3"),
            "a.csv, line 57, column 2 (depth_mm): \"inf\" is infinite; expected a finite number",
        ),
        (
            with_line(57, "1.10,1e999,0.3"),
            "a.csv, line 57, column 2 (depth_mm): \"1e999\" is infinite; expected a finite number",
        ),
        (with_line(9, "0.14,0.1.4,0.3"), "a.csv, line 9, column 2 (depth_mm): \"0.1.4\" is not a number"),
        (with_line(9, "0.14,,0.3"), "a.csv, line 9, column 2 (depth_mm): the cell is empty; expected a number"),
        (with_line(9, "0.14,0.3"), "a.csv, line 9: the row has 2 cells where the header has 3"),
        (with_line(9, "0.10,0.14,0.3"), "a.csv, line 9, column 1 (time_s): time goes backwards: 0.1 s after 0.12 s"),
        (
            with_line(9, "0.14,14.0,0.3"),
            "a.csv, line 9, column 2 (depth_mm): depth 14 mm is above the specimen's height of 12.7 mm; check the unit, the direction and the zero of the depth column",
        ),
        (
            with_line(9, "0.14,1400,0.3"),
            "a.csv, line 9, column 2 (depth_mm): depth 1400 mm is above the specimen's height of 12.7 mm; is the column in micrometres? Then write { name = \"...\", scale = 0.001 } in [columns]",
        ),
        (
            with_line(1, "time_s,depth_mm,force"),
            "a.csv, line 1: no column `force_N` (depth without force says nothing); the header has: time_s, depth_mm, force. Map it in [columns] of experiment.toml",
        ),
        (
            with_line(1, "time_s,depth,force_N"),
            "a.csv, line 1: no column `depth_mm` (force without depth says nothing); the header has: time_s, depth, force_N. Map it in [columns] of experiment.toml",
        ),
        (
            with_line(1, "time_s,time_s,force_N"),
            "a.csv, line 1: the column `time_s` appears twice in the header; choose with { name = \"time_s\", nth = 2 } or by number ({ number = 3 }) in [columns]",
        ),
        ("time_s,depth_mm,force_N\n".to_owned(), "a.csv: the file has no rows below its header"),
        (String::new(), "a.csv: the file has no header line"),
    ];
    for (csv, expected) in cases {
        assert_eq!(of_csv(&csv), expected);
    }
}

/// A line number stays right below lines to skip, blank lines and Windows line ends.
#[test]
fn lines_are_counted_as_an_editor_does() {
    let mut lines: Vec<String> = samples(100).lines().map(str::to_owned).collect();
    lines.insert(0, "instrument x; 20 °C".to_owned());
    lines.insert(1, "serial 7".to_owned());
    lines.insert(20, String::new());
    lines[56] = "1.10,1.100,nan".to_owned();
    let description =
        format!("[format]\nskip_lines = 2\nencoding = \"latin1\"\n{DESCRIPTION}").replace("name = \"EVA\"\n", "");
    for end in ["\n", "\r\n"] {
        let text = lines.join(end);
        let latin1: Vec<u8> = text.chars().map(|c| u8::try_from(u32::from(c)).unwrap()).collect();
        let folder = folder(&description, &latin1);
        assert_eq!(
            message(folder.path()),
            "a.csv, line 57, column 3 (force_N): \"nan\" is NaN; expected a finite number"
        );
    }
}

#[test]
fn an_undeclared_encoding_is_told_and_a_declared_one_read() {
    let mut csv = b"time_s,depth_mm,force_N,t\xe9mp\n".to_vec();
    for i in 0..20 {
        csv.extend(format!("{i},{i},0.1,x\n").bytes());
    }
    let description = DESCRIPTION.replace("12.7", "50.0");
    assert_eq!(
        message(folder(&description, &csv).path()),
        "a.csv: not valid UTF-8; state the file's encoding with [format] encoding = \"latin1\""
    );
    let declared = description.replace("[sensor]", "[format]\nencoding = \"latin1\"\n[sensor]");
    assert_eq!(experiment::read(folder(&declared, &csv).path()).unwrap().runs.len(), 1);
}

#[test]
fn other_names_units_and_decimal_commas() {
    let description = format!(
        "[columns]\ndepth_mm = {{ name = \"Weg\", scale = 1000.0, sign = -1 }}\nforce_N = \"Kraft\"\n\
         [format]\ndelimiter = \";\"\ndecimal = \",\"\n{}",
        DESCRIPTION.replace("name = \"EVA\"\n", "")
    );
    let csv = "time_s;Weg;Kraft;Bemerkung\n0,0;0;0;start\n0,5;-0,001;0,25;\n";
    let read = experiment::read(folder(&description, csv.as_bytes()).path()).unwrap();
    let recording = &read.runs[0].recording;
    assert_eq!(recording.time_s, [0.0, 0.5]);
    assert_eq!(recording.depth_mm[1], 1.0);
    assert_eq!(recording.force_n, [0.0, 0.25]);
    let point = csv.replace("0,25", "0.25");
    assert_eq!(
        message(folder(&description, point.as_bytes()).path()),
        "a.csv, line 3, column 3 (Kraft): \"0.25\" is not a number; is this a decimal point? Write decimal = \".\" in [format]"
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// Whatever stands in a data file is read or refused, never a panic.
    #[test]
    fn no_csv_panics(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        let folder = folder(DESCRIPTION, &bytes);
        let _ = experiment::read(folder.path());
    }

    /// The same for cells that look like data.
    #[test]
    fn no_table_panics(csv in "(time_s|depth_mm|force_N|[,;\n\r\"]|[-+0-9.eEinfNa ]{0,6}){0,60}") {
        let folder = folder(DESCRIPTION, format!("time_s,depth_mm,force_N\n{csv}").as_bytes());
        let _ = experiment::read(folder.path());
    }

    /// The same for the description: any text, and known keys with any values.
    #[test]
    fn no_description_panics(text in "(\\PC|\n){0,200}") {
        let folder = folder(&text, b"time_s,depth_mm,force_N\n0,0,0\n");
        let _ = experiment::read(folder.path());
    }

    /// Known words in any order.
    #[test]
    fn no_words_panic(words in prop::collection::vec(prop::sample::select(vec![
        "[columns]\n", "[format]\n", "[specimen.a]\n", "[indenter.b]\n", "[[run]]\n", "[sensor]\n",
        "depth_mm", "height_mm", "radius_mm", "file", "specimen", "indenter", "delimiter", "decimal",
        "=", "\"unknown\"", "\"a\"", "\"a.csv\"", "-1", "1e400", "0x7f", "[", "]", "{", "}", ",", "\n", "true", "1979-05-27",
    ]), 0..40)) {
        let folder = folder(&words.join(" "), b"time_s,depth_mm,force_N\n0,0,0\n1,1,1\n");
        let _ = experiment::read(folder.path());
    }
}
