//! Standard output and error of `palpate` that nobody reads, or that take nothing more.
#![allow(clippy::unwrap_used)]

use std::process::{Command, Output, Stdio};

fn palpate(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_palpate"));
    command.args(arguments).stdin(Stdio::null());
    command
}

/// What a command did whose standard output was closed before it wrote to it.
fn unread(arguments: &[&str]) -> Output {
    let mut child = palpate(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    child.wait_with_output().unwrap()
}

#[test]
fn a_reader_who_has_left_ends_nothing() {
    for arguments in [&["simulate", "--example"][..], &["board", "status"], &["board", "status", "--json"]] {
        let output = unread(arguments);
        let told = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{arguments:?}: {:?}: {told}", output.status);
        assert_eq!(told, "", "{arguments:?}");
    }
}

#[test]
fn what_is_written_to_files_is_written_though_nobody_reads_the_rest() {
    let folder = tempfile::tempdir().unwrap();
    let spec = folder.path().join("example.toml");
    std::fs::write(&spec, palpate(&["simulate", "--example"]).output().unwrap().stdout).unwrap();
    let experiment = folder.path().join("experiment");
    let output = unread(&["simulate", spec.to_str().unwrap(), "--out", experiment.to_str().unwrap()]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(experiment.join("experiment.toml").is_file());
}

#[test]
fn an_error_that_nobody_reads_is_still_told_by_the_exit_status() {
    let mut child = palpate(&["simulate", "absent.toml", "--out", "nowhere"]).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stderr.take());
    assert_eq!(child.wait().unwrap().code(), Some(2));
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_under_standard_output_is_an_error() {
    let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let output = palpate(&["simulate", "--example"]).stdout(full).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(told.contains("standard output") && told.contains("No space left"), "{told}");
}
