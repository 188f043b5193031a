//! `palpate board` and `palpate flash` as a person types them, without hardware.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Output, Stdio};

fn palpate(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_palpate")).args(arguments).stdin(Stdio::null()).output().unwrap()
}

fn stdout(output: &Output) -> String {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout.clone()).unwrap()
}

/// A served simulated board that ends with the test.
struct Served(Child, String);

impl Served {
    fn start() -> Self {
        let mut child = Command::new(env!("CARGO_BIN_EXE_palpate"))
            .args(["board", "serve", "--listen", "127.0.0.1:0"])
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut line = String::new();
        BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
        let place = line.trim().strip_prefix("simulated board at ").unwrap().to_owned();
        Served(child, place)
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[test]
fn a_served_board_answers_the_commands() {
    let served = Served::start();
    let board = ["--board", &served.1];
    let status = stdout(&palpate(&[&["board", "status"], &board[..]].concat()));
    assert!(status.starts_with("simulated board 70616c706174652d73696d01 with firmware 0.1.0"), "{status}");
    assert!(status.contains("table      none") && status.contains("faults     none"), "{status}");
    let status = stdout(&palpate(&[&["board", "status", "--json"], &board[..]].concat()));
    let status: serde_json::Value = serde_json::from_str(&status).unwrap();
    assert_eq!((&status["state"], &status["simulated"]), (&"Idle".into(), &true.into()));

    let refused = palpate(&[&["board", "mode", "palpate"], &board[..]].concat());
    assert_eq!(refused.status.code(), Some(2));
    let text = String::from_utf8_lossy(&refused.stderr).replace("\n  │", "");
    assert!(text.contains("refused SetMode") && text.contains("upload one"), "{text}");

    // The load cell's own offset of 0.03 N (0.003 of the reference) goes into the calibration.
    let before: toml::Table = stdout(&palpate(&[&["board", "calibrate"], &board[..]].concat())).parse().unwrap();
    let after: toml::Table =
        stdout(&palpate(&[&["board", "calibrate", "--tare"], &board[..]].concat())).parse().unwrap();
    let zero = |t: &toml::Table| t["load_cell"]["zero_ratio"].as_float().unwrap();
    // A mean of 16 x 20 readings with 0.76 codes of noise each: 1e-5 of the reference, five times that.
    assert!((zero(&after) - zero(&before) - 0.003).abs() < 5e-5, "{before} {after}");
}

#[test]
fn boards_that_are_not_there_are_named() {
    let error = palpate(&["board", "status", "--board", "serial:/dev/no-such-port"]);
    assert_eq!(error.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&error.stderr).contains("cannot open serial:/dev/no-such-port"));
    let error = palpate(&["board", "status", "--board", "usb"]);
    assert!(String::from_utf8_lossy(&error.stderr).contains("expected sim, auto, tcp:HOST:PORT or serial:PATH"));
}

#[test]
fn flash_refuses_what_is_no_firmware_and_no_table() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("notes.txt");
    std::fs::write(&file, "not an ELF file, and no table either").unwrap();
    let error = palpate(&["flash", file.to_str().unwrap()]);
    assert_eq!(error.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&error.stderr).contains("not firmware for this board"));
    let error = palpate(&["flash", "--table", file.to_str().unwrap()]);
    assert!(String::from_utf8_lossy(&error.stderr).contains("the first 8 bytes are not PALPLUT"));
    let error = palpate(&["flash"]);
    assert!(String::from_utf8_lossy(&error.stderr).contains("nothing to write"));
}

#[test]
fn the_self_test_drives_nothing_without_a_yes_and_knows_the_display_board() {
    let served = Served::start();
    let asked = palpate(&["selftest", "--board", &served.1]);
    let text = String::from_utf8_lossy(&asked.stderr).replace("\n  │", "");
    assert_eq!(asked.status.code(), Some(2));
    assert!(text.contains("nothing was driven") && text.contains("--yes"), "{text}");
    let other = palpate(&["selftest", "--yes", "--board", &served.1]);
    let text = String::from_utf8_lossy(&other.stderr).replace("\n  │", "");
    assert_eq!(other.status.code(), Some(2));
    assert!(text.contains("the firmware of the display board runs there"), "{text}");
    let status = stdout(&palpate(&["board", "status", "--board", &served.1]));
    assert!(status.contains("state      Idle") && status.contains("faults     none"), "{status}");
}

#[test]
fn a_raw_image_is_made_from_an_elf_only() {
    let folder = tempfile::tempdir().unwrap();
    let (elf, bin) = (folder.path().join("board.elf"), folder.path().join("board.bin"));
    std::fs::write(&elf, "no ELF").unwrap();
    let refused = palpate(&["flash", elf.to_str().unwrap(), "--bin", bin.to_str().unwrap()]);
    assert_eq!(refused.status.code(), Some(2));
    let text = String::from_utf8_lossy(&refused.stderr).replace("\n  │", "");
    assert!(text.contains("it is not an ELF file") && !bin.exists(), "{text}");
}
