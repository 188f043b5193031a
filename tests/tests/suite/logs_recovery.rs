//! MCAP logs that were cut anywhere still give every complete message before the cut.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate::link::{InProcess, Link, Pace};
use palpate::log::{Recorder, recover_mcap};
use palpate::plant::Jitter;
use palpate::session::{Patience, Session};
use palpate::simulated_board::SimulatedBoard;

/// Ten seconds of telemetry, logged at `path`.
fn logged(path: &std::path::Path) {
    let board = InProcess::new(SimulatedBoard::new(1, Jitter::NONE), Pace::Free);
    let (mut session, _) = Session::open(board, Patience::default()).unwrap();
    let mut recorder = Recorder::create_new(None, Some(path)).unwrap();
    let until_s = session.link().now_s() + 10.0;
    while let Some(event) = session.poll(until_s).unwrap() {
        recorder.event(&event, &session.traffic()).unwrap();
    }
    recorder.finish().unwrap();
}

#[test]
fn a_log_cut_anywhere_gives_all_but_the_last_chunk_before_the_cut() {
    let folder = tempfile::tempdir().unwrap();
    let whole = folder.path().join("whole.mcap");
    logged(&whole);
    let bytes = std::fs::read(&whole).unwrap();
    let complete = recover_mcap(&whole).unwrap();
    assert_eq!(complete.torn, None);
    assert_eq!(complete.messages.len(), 500);
    let cut = folder.path().join("cut.mcap");
    let mut before = 0;
    for tenth in 1..10 {
        let end = bytes.len() * tenth / 10;
        std::fs::write(&cut, &bytes[..end]).unwrap();
        let recovered = recover_mcap(&cut).unwrap();
        assert!(recovered.torn.is_some());
        let n = recovered.messages.len();
        assert_eq!(recovered.messages[..], complete.messages[..n]);
        // Chunks are half a second, 25 records; the summary at the end is far below a tenth of the file.
        assert!(n >= before && n + 25 + 500 / 20 >= 500 * tenth / 10, "{n} messages from {tenth} tenths");
        before = n;
    }
}

#[test]
fn what_is_no_mcap_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("notes.mcap");
    std::fs::write(&file, "hello").unwrap();
    let error = recover_mcap(&file).unwrap_err().to_string();
    assert_eq!(error, format!("recording {}: not an MCAP file", file.display()));
    let missing = folder.path().join("missing.mcap");
    assert!(recover_mcap(&missing).unwrap_err().to_string().starts_with(&format!("recording {}: ", missing.display())));
}
