//! What laboratories met with `palpate log`: the cases of `../shared/cases`, run as they are there, but for their ports.
//!
//! They are not part of this repository; without them the tests say SKIPPED.
#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

#[path = "trials/check.rs"]
mod check;

use std::net::TcpListener;
use std::path::Path;
use std::process::Command;

use palpate::log::recover_mcap;

const PALPATE: &str = env!("CARGO_BIN_EXE_palpate");

/// Runs a case in a folder of its own; its output, or `None` with a visible message if it is absent.
fn ran(case: &str, ports: &[&str], folder: &Path) -> Option<String> {
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/cases").join(case);
    let Ok(mut command) = std::fs::read_to_string(from.join("command.sh")) else {
        println!("SKIPPED: case {} not found", from.display());
        return None;
    };
    if !Command::new("python3").arg("-V").output().is_ok_and(|found| found.status.success()) {
        println!("SKIPPED: case {case} needs python3");
        return None;
    }
    if let Ok(line) = std::fs::read(from.join("line.py")) {
        std::fs::write(folder.join("line.py"), line).unwrap();
    }
    // Free ones: others may run the same case.
    let free: Vec<TcpListener> = ports.iter().map(|_| TcpListener::bind("127.0.0.1:0").unwrap()).collect();
    for (port, listener) in ports.iter().zip(&free) {
        command = command.replace(port, &listener.local_addr().unwrap().port().to_string());
    }
    drop(free);
    let done = Command::new("sh").arg("-c").arg(command).env("P", PALPATE).current_dir(folder).output().unwrap();
    Some(String::from_utf8_lossy(&done.stdout).into_owned() + &String::from_utf8_lossy(&done.stderr))
}

#[test]
fn a_log_that_cannot_start_leaves_the_log_before_it() {
    let folder = tempfile::tempdir().unwrap();
    let Some(told) = ran("16a-log-again-wipes-the-recording", &[], folder.path()) else { return };
    assert!(told.contains("cannot open serial:/dev/ttyACM7") && told.contains("exit 2"), "{told}");
    assert_eq!(std::fs::metadata(folder.path().join("rec.csv")).unwrap().len(), 3893, "{told}");
}

#[test]
fn a_board_that_restarts_in_a_log_is_heard_again_and_told() {
    let folder = tempfile::tempdir().unwrap();
    let Some(told) = ran("17a-board-restarts-mid-log", &["4782", "4783"], folder.path()) else { return };
    assert!(told.contains("exit 0"), "{told}");
    let rows = check::rows(&folder.path().join("r.csv")).unwrap();
    // 590 without the restart; a busy machine lets the simulated board start later.
    assert!(rows.len() >= 500, "{} rows: {told}", rows.len());
    let gaps = check::gaps_are_told(&rows).unwrap();
    assert!(gaps.len() == 1 && gaps[0].contains("board restarted (cause: power on or brown-out)"), "{gaps:?}");
    assert!(rows.last().unwrap().frames_lost < 10, "{told}");
    let shown = std::fs::read_to_string(folder.path().join("r.out")).unwrap();
    assert!(shown.contains("board restarted (cause: power on or brown-out), ticks begin again"), "{shown}");
    let (messages, proper, told_gaps) = check::messages(&folder.path().join("r.mcap")).unwrap();
    assert!(proper && told_gaps == 1);
    let gap = messages.iter().find(|(topic, ..)| topic == "gap").unwrap();
    assert_eq!(gap.2["cause"], "power on or brown-out");
}

#[test]
fn a_log_ended_by_sigterm_is_whole() {
    let folder = tempfile::tempdir().unwrap();
    let Some(told) = ran("18a-log-sigterm", &["4792"], folder.path()) else { return };
    let recovered = recover_mcap(&folder.path().join("t.mcap")).unwrap();
    assert_eq!(recovered.torn, None, "{told}");
    let records = recovered.messages.iter().filter(|(topic, ..)| topic == "telemetry").count();
    let rows = check::rows(&folder.path().join("t.csv")).unwrap();
    assert!(rows.len() == records && records > 100, "{} rows, {records} records: {told}", rows.len());
}
