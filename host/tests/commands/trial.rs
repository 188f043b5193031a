//! A session that is killed at any moment goes on: no answer is lost, none comes twice, and the order stays.
#![cfg(unix)]
#![allow(clippy::unwrap_used)]

use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Presentations of the session.
const PRESENTATIONS: usize = 40;

fn command(journal: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_palpate"));
    command.args(["trial", "run"]).arg(journal);
    command.args(["--materials", "ICF", "A2", "B1", "EVA", "--repeats", "10", "--seed", "5", "--subject", "3"]);
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null());
    command
}

fn lines(journal: &Path) -> usize {
    std::fs::read_to_string(journal).unwrap_or_default().matches('\n').count()
}

#[test]
fn a_killed_session_goes_on_where_it_was() {
    let folder = tempfile::tempdir().unwrap();
    let journal = folder.path().join("s.jsonl");
    let mut kept = String::new();
    // Killed after 0, 5, 10, 15 more answers were on the disk, while the next are being written.
    for round in 1..=4 {
        let mut child = command(&journal).spawn().unwrap();
        let mut keys = child.stdin.take().unwrap();
        keys.write_all("1\n".repeat(20).as_bytes()).unwrap();
        let wanted = 1 + 5 * (round - 1);
        let began = Instant::now();
        while lines(&journal) < wanted && began.elapsed() < Duration::from_secs(60) {
            std::thread::sleep(Duration::from_millis(1));
        }
        child.kill().unwrap();
        child.wait().unwrap();
        let text = std::fs::read_to_string(&journal).unwrap();
        let whole = &text[..text.rfind('\n').unwrap() + 1];
        assert!(whole.starts_with(&kept), "round {round}: an earlier line has changed");
        assert!(lines(&journal) >= wanted, "round {round}: {} lines", lines(&journal));
        kept = whole.to_owned();
    }
    let mut child = command(&journal).spawn().unwrap();
    child.stdin.take().unwrap().write_all("2\nx\n".repeat(PRESENTATIONS).as_bytes()).unwrap();
    let told = child.wait_with_output().unwrap();
    assert!(told.status.success());
    assert!(String::from_utf8_lossy(&told.stdout).starts_with("all 40 answered"), "{told:?}");
    let text = std::fs::read_to_string(&journal).unwrap();
    assert!(text.starts_with(&kept) && lines(&journal) == PRESENTATIONS + 1, "{text}");
    for (at, line) in text.lines().skip(1).enumerate() {
        assert!(line.starts_with(&format!("{{\"trial\":{},", at + 1)), "{line}");
    }
    assert!(!text.contains("\"seed\""), "the seed would tell who the subject is");
}
