//! Logs of a killed process hold everything up to the last second.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use palpate::log::{COLUMNS, recover_mcap};

/// Most that may be lost, s of board time.
const LAST_SECOND_S: f64 = 1.0;

#[test]
fn logs_survive_a_kill_up_to_the_last_second() {
    let folder = tempfile::tempdir().unwrap();
    let (csv, mcap) = (folder.path().join("log.csv"), folder.path().join("log.mcap"));
    let mut child = Command::new(env!("CARGO_BIN_EXE_palpate"))
        .args(["log", "--board", "sim"])
        .arg("--csv")
        .arg(&csv)
        .arg("--mcap")
        .arg(&mcap)
        .stdin(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    // The board's clock starts with the log's first line; wait for that line, then for five seconds of records.
    let deadline = Instant::now() + Duration::from_secs(30);
    while std::fs::read_to_string(&csv).is_ok_and(|t| t.lines().count() < 2) || !csv.exists() {
        assert!(Instant::now() < deadline, "nothing was logged in 30 s");
        thread::sleep(Duration::from_millis(20));
    }
    let first_seen = Instant::now();
    let last_before_s = last_time_s(&csv);
    thread::sleep(Duration::from_secs(5));
    // SIGKILL on Unix: the process gets no chance to tidy up.
    child.kill().unwrap();
    // From the first line seen to the kill, by the wall clock; the simulated board runs in real time.
    let killed_at_s = last_before_s + first_seen.elapsed().as_secs_f64();
    child.wait().unwrap();

    let text = std::fs::read_to_string(&csv).unwrap();
    assert!(text.ends_with('\n'), "the CSV must end with a whole line");
    let cells = COLUMNS.split(',').count();
    assert_eq!(text.lines().next(), Some(COLUMNS));
    for line in text.lines() {
        assert_eq!(line.split(',').count(), cells, "{line}");
    }
    let ticks: Vec<u32> = text.lines().skip(1).map(|l| l.split(',').nth(1).unwrap().parse().unwrap()).collect();
    assert!(ticks.windows(2).all(|w| w[1] == w[0] + 1), "a record is missing in the CSV");
    let csv_end_s = last_time_s(&csv);
    assert!(csv_end_s >= killed_at_s - LAST_SECOND_S, "CSV ends at {csv_end_s} s, killed at {killed_at_s} s");

    let recovered = recover_mcap(&mcap).unwrap();
    assert!(recovered.torn.is_some(), "a killed log has no summary");
    for topic in ["telemetry", "truth"] {
        let times = recovered.messages.iter().filter(|m| m.0 == topic).map(|m| m.1);
        let end_s = times.fold(0.0, f64::max);
        assert!(end_s >= killed_at_s - LAST_SECOND_S, "{topic} in MCAP ends at {end_s} s, killed at {killed_at_s} s");
    }
}

/// Board time of the last whole line, s.
fn last_time_s(csv: &std::path::Path) -> f64 {
    let text = std::fs::read_to_string(csv).unwrap();
    let whole = &text[..text.rfind('\n').unwrap()];
    whole.lines().last().unwrap().split(',').next().unwrap().parse().unwrap()
}

#[test]
fn a_log_with_a_time_limit_ends_properly() {
    let folder = tempfile::tempdir().unwrap();
    let (csv, mcap) = (folder.path().join("log.csv"), folder.path().join("log.mcap"));
    let begun = std::time::Instant::now();
    let out = Command::new(env!("CARGO_BIN_EXE_palpate"))
        .args(["log", "--seconds", "1", "--json", "--csv"])
        .arg(&csv)
        .arg("--mcap")
        .arg(&mcap)
        .stdin(Stdio::null())
        .output()
        .unwrap();
    assert!(out.status.success(), "{}", String::from_utf8_lossy(&out.stderr));
    let answer: serde_json::Value = serde_json::from_slice(&out.stdout).unwrap();
    assert_eq!(answer["telemetry"]["frames_lost"], 0);
    let recovered = recover_mcap(&mcap).unwrap();
    assert_eq!(recovered.torn, None);
    let records = recovered.messages.iter().filter(|m| m.0 == "telemetry").count();
    assert_eq!(records, std::fs::read_to_string(&csv).unwrap().lines().count() - 1);
    // A second at 50 Hz, less the ticks of the greeting; more only if the machine was held up meanwhile.
    let most = (begun.elapsed().as_secs_f64() * 50.0) as usize + 1;
    assert!((45..=most).contains(&records), "{records} of at most {most}");
}
