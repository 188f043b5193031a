//! Tells the program which commit it was built from, where that is known.

use std::env;
use std::process::Command;

fn main() {
    println!("cargo:rerun-if-env-changed=PALPATE_COMMIT");
    // Results that people keep come from release builds; a debug build for each commit costs minutes.
    let released = env::var("PROFILE").is_ok_and(|profile| profile == "release");
    let stated = env::var("PALPATE_COMMIT").ok();
    if let Some(commit) = stated.or_else(|| if released { commit() } else { None }) {
        println!("cargo:rustc-env=PALPATE_COMMIT={commit}");
    }
}

/// The commit that is checked out; none for sources outside their repository.
fn commit() -> Option<String> {
    git(&["ls-files", "--error-unmatch", "build.rs"])?;
    let log = git(&["rev-parse", "--git-path", "logs/HEAD"])?;
    println!("cargo:rerun-if-changed={log}");
    git(&["rev-parse", "HEAD"])
}

fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok().filter(|output| output.status.success())?;
    let text = String::from_utf8(output.stdout).ok()?.trim().to_owned();
    (!text.is_empty()).then_some(text)
}
