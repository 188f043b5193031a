//! `palpate lut sweep` and `palpate lut merge` as a script sees them: killed, in shards, refused.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::thread;
use std::time::{Duration, Instant};

/// Twelve points, four factors, four checks, on the coarsest mesh: about two seconds on one core.
const SPEC: &str = r#"
name = "small"
law = "hyperfoam"
[specimen]
height_mm = 12.7
radius_mm = 25.0
[indenter]
radius_mm = 4.0
[motion]
rates_mm_s = [1.0]
depth_mm = 2.0
depths = 8
[solve]
refinement = 0.4
checks = 2
[[axis]]
name = "mu_MPa"
values = [0.05, 0.1, 0.15, 0.2]
factor = true
[[axis]]
name = "alpha"
from = 2.0
to = 16.0
count = 6
spacing = "logarithmic"
[[axis]]
name = "nu"
values = [0.0, 0.3]
"#;

/// Points of [`SPEC`], checks included.
const POINTS: usize = 16;

/// Points of the sweep that is killed: enough that it is still running when it shall be.
const MANY: usize = 84;

/// An empty folder of a test's own with a description in it.
fn folder(name: &str, spec: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    fs::write(folder.join("sweep.toml"), spec).unwrap();
    folder
}

fn palpate(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_palpate")).arg("lut").args(arguments).current_dir(folder).output().unwrap()
}

fn succeeds(folder: &Path, arguments: &[&str]) -> serde_json::Value {
    let output = palpate(folder, &[arguments, &["--json"]].concat());
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// What it says when it refuses, on one line.
fn refusal(folder: &Path, arguments: &[&str]) -> String {
    let output = palpate(folder, arguments);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}");
    assert!(output.stdout.is_empty(), "{arguments:?}");
    let text = String::from_utf8(output.stderr).unwrap();
    // The frame around a report breaks lines between words, and after hyphens and slashes of paths.
    text.split(|c: char| c.is_whitespace() || "│×╰─▶".contains(c)).collect()
}

fn assert_says(text: &str, expected: &str) {
    let expected: String = expected.split_whitespace().collect();
    assert!(text.contains(&expected), "{text}\ndoes not say\n{expected}");
}

/// The merged table of an uninterrupted run on one thread.
fn reference(folder: &Path, points: usize) -> Vec<u8> {
    let swept = succeeds(folder, &["sweep", "sweep.toml", "--out", "whole", "--threads", "1"]);
    assert_eq!((&swept["points"], &swept["solved"], &swept["before"]), (&points.into(), &points.into(), &0.into()));
    merged(folder, &["whole"])
}

fn merged(folder: &Path, parts: &[&str]) -> Vec<u8> {
    let answer = succeeds(folder, &[&["merge", "sweep.toml"], parts, &["-o", "table"]].concat());
    assert_eq!(answer["failed"].as_array().unwrap().len(), 0, "{answer}");
    fs::read(folder.join("table")).unwrap()
}

#[test]
fn a_killed_sweep_continues_to_the_same_bytes() {
    let folder = folder(
        "killed_sweep",
        &SPEC.replace("count = 6", "count = 40").replace("refinement = 0.4", "refinement = 0.8"),
    );
    let arguments = ["sweep", "sweep.toml", "--out", "killed", "--threads", "1"];
    let mut child = Command::new(env!("CARGO_BIN_EXE_palpate"))
        .arg("lut")
        .args(arguments)
        .current_dir(&folder)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let journal = folder.join("killed/shard-1-of-1.journal");
    let records =
        || fs::read(&journal).map_or(0, |b| lut_gen::sweep::Journal::parse(&b).map_or(0, |j| j.outcomes.len()));
    let deadline = Instant::now() + Duration::from_secs(60);
    while records() < 3 {
        assert!(Instant::now() < deadline, "no three points in a minute");
        assert!(child.try_wait().unwrap().is_none(), "it ended before it could be killed");
        thread::sleep(Duration::from_millis(5));
    }
    // While it writes, nobody else may.
    assert_says(&refusal(&folder, &arguments), "killed/shard-1-of-1.journal is being written by another process; wait");
    // SIGKILL on Unix: the process gets no chance to tidy up.
    child.kill().unwrap();
    child.wait().unwrap();
    let before = records();
    assert!((3..MANY).contains(&before), "killed in the middle, after {before}");
    // A kill rarely hits the write itself; so a torn record is put there.
    let whole = fs::read(&journal).unwrap();
    fs::write(&journal, [&whole[..], &whole[whole.len() - 40..]].concat()).unwrap();

    let incomplete = refusal(&folder, &["merge", "sweep.toml", "killed", "-o", "table"]);
    assert_says(&incomplete, &format!("{} of {MANY} points are not solved yet", MANY - before));
    assert_says(&incomplete, "Run the sweep again for: shard 1/1");

    let continued = succeeds(&folder, &arguments);
    assert_eq!((&continued["before"], &continued["solved"]), (&before.into(), &(MANY - before).into()));
    assert_eq!(merged(&folder, &["killed"]), reference(&folder, MANY));
    let again = succeeds(&folder, &arguments);
    assert_eq!((&again["before"], &again["solved"]), (&MANY.into(), &0.into()));
}

#[test]
fn shards_of_any_number_of_threads_merge_to_the_same_bytes() {
    let folder = folder("sharded_sweep", SPEC);
    let whole = reference(&folder, POINTS);
    for (shard, threads, out) in [("3/3", "1", "a"), ("1/3", "2", "a"), ("2/3", "3", "b")] {
        succeeds(&folder, &["sweep", "sweep.toml", "--shard", shard, "--threads", threads, "--out", out]);
    }
    let lacking = refusal(&folder, &["merge", "sweep.toml", "a"]);
    assert_says(&lacking, "5 of 16 points are not solved yet: 1 (alpha 2, nu 0.3); 4 (alpha ");
    assert_says(&lacking, "Run the sweep again for: shard 2/3");
    assert_eq!(merged(&folder, &["a", "b"]), whole);
    assert_eq!(merged(&folder, &["b", "a/shard-1-of-3.journal", "a/shard-3-of-3.journal"]), whole);

    // The merged table explains itself.
    let told = succeeds(&folder, &["--explain", "table"]);
    assert_eq!((&told["points"], &told["name"]), (&12.into(), &"small".into()));
    assert_eq!((&told["axes"][0]["name"], &told["axes"][0]["role"]), (&"mu_MPa".into(), &"factor".into()));
    let bound = &told["error_bound"];
    assert!(bound["discretisation"].as_f64().unwrap() > 0.0 && bound["interpolation"].as_f64().unwrap() > 0.0);
    let text = String::from_utf8(palpate(&folder, &["--explain", "table"]).stdout).unwrap();
    assert!(text.contains("axis        alpha        2, 3.031, 4.595, 6.964, 10.56, 16; logarithmic\n"), "{text}");
    let mut bad = whole;
    bad[100] ^= 1;
    fs::write(folder.join("table"), bad).unwrap();
    let damaged = refusal(&folder, &["--explain", "table"]);
    assert_says(&damaged, "table is not a usable table");
    assert_says(&damaged, "the table is damaged: its SHA-256 is wrong");

    // A folder keeps one sweep; the journal of another is refused and not touched.
    fs::write(folder.join("sweep.toml"), SPEC.replace("count = 6", "count = 5")).unwrap();
    let journal = fs::read(folder.join("b/shard-2-of-3.journal")).unwrap();
    for arguments in [&["sweep", "sweep.toml", "--shard", "2/3", "--out", "b"][..], &["merge", "sweep.toml", "b"]] {
        let other = refusal(&folder, arguments);
        assert_says(&other, "shard-2-of-3.journal belongs to another sweep: its `axes` is [{");
    }
    assert_eq!(fs::read(folder.join("b/shard-2-of-3.journal")).unwrap(), journal);
}

#[test]
fn points_that_fail_are_listed_and_tried_again_when_asked() {
    // A ball of 17 mm is too wide for a block of 25 mm radius.
    let axes = SPEC.split("[[axis]]").next().unwrap().replace("radius_mm = 4.0", "").replace("checks = 2", "");
    let spec = format!(
        "{axes}[material]\nmu_MPa = 0.1\nalpha = 8\n[[axis]]\nname = \"ball_radius_mm\"\nvalues = [4.0, 17.0]\n"
    );
    let folder = folder("failing_sweep", &spec);
    let swept = succeeds(&folder, &["sweep", "sweep.toml"]);
    assert_eq!((&swept["solved"], &swept["failed"].as_array().unwrap().len()), (&1.into(), &1));
    let failure = &swept["failed"][0];
    assert_eq!((&failure["point"], &failure["at"]), (&1.into(), &"ball_radius_mm 17".into()));
    let reason = "radius_mm of the specimen = 25 must be at least 1.5 ball radii, 25.5 mm";
    assert_eq!(failure["error"], reason);
    let again = succeeds(&folder, &["sweep", "sweep.toml"]);
    assert_eq!((&again["solved"], &again["failed_before"]), (&0.into(), &1.into()));
    let retried = succeeds(&folder, &["sweep", "sweep.toml", "--retry-failed"]);
    assert_eq!((&retried["before"], &retried["failed"][0]["error"]), (&1.into(), &reason.into()));
    let table = succeeds(&folder, &["merge", "sweep.toml", "out/sweep"]);
    assert_eq!(table["failed"][0]["error"], reason);
    let text = String::from_utf8(palpate(&folder, &["--explain", "out/sweep.lut"]).stdout).unwrap();
    assert!(text.contains(&format!("failed      point 1 (ball_radius_mm 17): {reason}\n")), "{text}");
}

#[test]
fn mistakes_are_named() {
    let folder = folder("mistaken_sweep", SPEC);
    for shard in ["5/4", "0/4", "1/0", "two"] {
        let text = refusal(&folder, &["sweep", "sweep.toml", "--shard", shard]);
        assert_says(&text, &format!("shard \"{shard}\" is not one; expected i/n, part i of n with i from 1 to n"));
    }
    assert_says(&refusal(&folder, &["sweep", "nowhere.toml"]), "nowhere.toml: no such file: nowhere.toml");
    assert_says(&refusal(&folder, &["merge", "sweep.toml", "."]), ". holds no journal of a sweep (*.journal)");
    fs::write(folder.join("bad.journal"), b"something else").unwrap();
    let foreign = refusal(&folder, &["merge", "sweep.toml", "."]);
    assert_says(&foreign, "bad.journal is not usable: the file does not begin like the journal of a sweep");

    let cases = [
        (
            "\"nu\"",
            "\"poisson\"",
            "sweep.toml, line 27, column 8: `name` is \"poisson\"; expected one of \"mu_MPa\", \"alpha\", \"nu\"",
        ),
        (
            "factor = true",
            "faktor = true",
            "line 19, column 1: unknown key `faktor` in [[axis]]; did you mean `factor`?",
        ),
        ("depths = 8", "depths = 0", "line 12, column 10: `depths` is 0; expected how many depths, 1 to 1000000"),
        (
            "values = [0.0, 0.3]",
            "values = [0.3, 0.0]",
            "line 26, column 1: axis nu: values is 0 after 0.3; expected a strictly rising list",
        ),
        (
            "values = [0.0, 0.3]",
            "values = [0.0, \"x\"]",
            "line 28, column 16: `values` is \"x\"; expected a list of numbers",
        ),
        (
            "depth_mm = 2.0",
            "depth_mm = 12.5",
            "line 9, column 1: motion: the largest depth is 12.5 mm; expected below 95 %",
        ),
        (
            "height_mm = 12.7",
            "",
            "sweep.toml: the hyperfoam law: height_mm is missing; expected a fixed value or an axis",
        ),
        ("count = 6", "values = [1.0]", "`from` is given beside values; expected one of the two"),
        (
            "law = \"hyperfoam\"",
            "law = \"neo-hooke\"",
            "`law` is \"neo-hooke\"; expected one of \"hyperfoam\", \"ogden\"",
        ),
    ];
    for (before, after, expected) in cases {
        assert!(SPEC.contains(before), "{before}");
        fs::write(folder.join("sweep.toml"), SPEC.replace(before, after)).unwrap();
        assert_says(&refusal(&folder, &["sweep", "sweep.toml"]), expected);
    }
}
