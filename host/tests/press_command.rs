//! `palpate press` as a person or a script uses it, on a served simulated board.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use protocol::lut::{AxisSpec, Role, Scale, TableSpec, axis_name};

fn palpate(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_palpate"));
    command.args(arguments).stdin(Stdio::null());
    command
}

/// A served simulated board that ends with the test; nothing lies under its probe.
struct Served(Child, String);

impl Served {
    fn start() -> Self {
        let mut child = palpate(&["board", "serve", "--listen", "127.0.0.1:0"]).stdout(Stdio::piped()).spawn().unwrap();
        let mut line = String::new();
        BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
        let place = line.trim().strip_prefix("simulated board at ").unwrap().to_owned();
        Served(child, place)
    }

    fn press(&self, folder: &Path, more: &[&str]) -> Command {
        let mut command = palpate(&["press", "--board", &self.1, "--csv"]);
        command.arg(folder.join("press.csv")).args(more);
        command
    }

    fn upload(&self, folder: &Path) {
        let file = folder.join("table.bin");
        std::fs::write(&file, table()).unwrap();
        let uploaded = palpate(&["board", "upload", "--board", &self.1]).arg(file).output().unwrap();
        assert!(uploaded.status.success(), "{}", String::from_utf8_lossy(&uploaded.stderr));
    }

    fn state(&self) -> serde_json::Value {
        json(&palpate(&["board", "status", "--json", "--board", &self.1]).output().unwrap())
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn json(output: &Output) -> serde_json::Value {
    serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)))
}

fn table() -> Vec<u8> {
    let axis = |name: &str, unit: &str, role, values: &[f64]| AxisSpec::new(name, unit, role, Scale::Listed, values);
    let depths: Vec<f64> = (1..=200).map(|i| 0.02 * f64::from(i)).collect();
    let alphas: Vec<f64> = (1..=12).map(f64::from).collect();
    let force = |alpha: f64, depth: f64| depth.powf(1.5) * (1.0 + 0.01 * alpha * depth);
    let table = TableSpec {
        columns: alphas.iter().map(|a| depths.iter().map(|d| force(*a, *d)).collect()).collect(),
        axes: vec![
            axis(axis_name::DEPTH, "mm", Role::Row, &depths),
            axis(axis_name::ALPHA, "", Role::Column, &alphas),
            axis(axis_name::MU, "MPa", Role::Factor, &[0.01, 0.1, 0.3]),
        ],
        library: vec![],
        discretisation: 0.001,
        interpolation: 0.001,
        provenance: "for a test of press".into(),
    };
    table.to_bytes().unwrap()
}

#[test]
fn a_press_says_what_it_found_and_never_writes_over_a_recording() {
    let (served, folder) = (Served::start(), tempfile::tempdir().unwrap());
    let refused = served.press(folder.path(), &[]).output().unwrap();
    assert_eq!(refused.status.code(), Some(2));
    let text = String::from_utf8_lossy(&refused.stderr).replace("\n  │", "");
    assert!(text.contains("refused SetMode") && text.contains("upload one"), "{text}");
    served.upload(folder.path());
    std::fs::write(folder.path().join("press.csv"), "mine").unwrap();
    let pressed = served.press(folder.path(), &["--rate", "4", "--json"]).output().unwrap();
    let answer = json(&pressed);
    assert_eq!((pressed.status.code(), &answer["outcome"]), (Some(4), &"no-result".into()), "{answer}");
    assert_eq!(answer["text"], "palpation 1: no contact before the end of the travel");
    assert_eq!(std::fs::read_to_string(folder.path().join("press.csv")).unwrap(), "mine");
    let recorded = std::fs::read_to_string(answer["csv"].as_str().unwrap()).unwrap();
    assert!(recorded.contains(",Approach,") && recorded.contains("verdict 1 NoContact"));
    let status = served.state();
    assert_eq!((&status["state"], &status["faults"]), (&"Idle".into(), &serde_json::json!([])));
}

#[test]
fn with_the_surface_stated_a_press_without_contact_ends_a_millimetre_below_it() {
    let (served, folder) = (Served::start(), tempfile::tempdir().unwrap());
    served.upload(folder.path());
    let pressed = served.press(folder.path(), &["--rate", "4", "--surface", "25"]).output().unwrap();
    assert_eq!(pressed.status.code(), Some(4), "{}", String::from_utf8_lossy(&pressed.stderr));
    let mut rows = csv::Reader::from_path(folder.path().join("press.csv")).unwrap();
    let at = rows.headers().unwrap().iter().position(|name| name == "sensor_probe_mm").unwrap();
    let heights = rows.records().filter_map(|row| row.unwrap().get(at)?.parse::<f64>().ok());
    let lowest = heights.fold(f64::INFINITY, f64::min);
    // Without it the arm would turn a millimetre above the plate.
    assert!((23.5..24.2).contains(&lowest), "{lowest} mm");
}

#[cfg(unix)]
#[test]
fn a_signal_brings_the_arm_home_before_it_ends() {
    // `timeout` sends one to the process and one to its group, other supervisors two kinds. Not SIGHUP, which whoever
    // started the tests may have ignored.
    for signals in [&["-INT"][..], &["-TERM", "-TERM"], &["-QUIT", "-TERM"]] {
        let (served, folder) = (Served::start(), tempfile::tempdir().unwrap());
        served.upload(folder.path());
        let mut press = served.press(folder.path(), &["--rate", "1"]).stderr(Stdio::piped()).spawn().unwrap();
        let csv = folder.path().join("press.csv");
        let deadline = Instant::now() + Duration::from_secs(30);
        while !std::fs::read_to_string(&csv).is_ok_and(|text| text.contains(",Approach,")) {
            assert!(Instant::now() < deadline, "the arm does not move");
            std::thread::sleep(Duration::from_millis(20));
        }
        for signal in signals {
            assert!(Command::new("kill").args([signal, press.id().to_string().as_str()]).status().unwrap().success());
        }
        let ended = press.wait().unwrap();
        assert_eq!(ended.code(), Some(5), "{signals:?}");
        // It has waited: the board is at rest at once, and no fault of a lost link follows.
        let status = served.state();
        assert_eq!((&status["state"], &status["faults"]), (&"Idle".into(), &serde_json::json!([])), "{signals:?}");
        let recorded = std::fs::read_to_string(&csv).unwrap();
        let last = recorded.lines().last().unwrap();
        assert!(last.contains(",Idle,"), "{last}");
    }
}
