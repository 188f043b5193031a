#![allow(clippy::unwrap_used)]
use clap::Parser;

use super::*;

#[derive(Parser)]
struct Line {
    #[command(flatten)]
    arguments: Arguments,
}

fn parsed(words: &str) -> Arguments {
    Line::parse_from(std::iter::once("tune").chain(words.split_whitespace())).arguments
}

#[test]
fn what_cannot_be_asked_is_refused_with_what_was_expected() {
    for (words, expected) in [
        ("--u-max 0", "--u-max is 0; expected 0.001 to 1000 V"),
        ("--overshoot=-0.1", "--overshoot is -0.1; expected 0 to 1 of the step"),
        ("--overshoot=nan", "--overshoot is NaN; expected 0 to 1 of the step"),
        ("--box 60", "--box is 60; expected 0 to 50 %"),
        ("--numerator 86 --denominator 0,1", "the first number of both not 0"),
        ("--numerator 1,2,3 --denominator 1,2", "expected an order of 1 to 6, a numerator of lower order"),
        (
            "--loop sampled --send",
            "--send with --loop sampled; expected --loop delayed, which is what runs on the board",
        ),
        ("--tick 0.01 --send", "--send with --tick 0.01; expected 0.02, the board's own"),
        ("--actuator nowhere.toml", "no such file: nowhere.toml"),
        ("--numerator 86 --denominator 1,-23.4,86", "the plant is not stable: it has a pole at 18.8"),
        ("--u-max 0.9", "takes 1.0000 V at rest, and the limit is 0.9 V"),
        ("--numerator=-86 --denominator 1,23.4,86", "a positive command pulls the shaft in"),
        ("--loop sampled --appendix-e", "expected --loop continuous"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let mut arguments = parsed(words);
        arguments.out = folder.path().join("out");
        let text = run(&arguments).unwrap_err().to_string();
        assert!(text.contains(expected), "{words}: {text}");
        assert!(!arguments.out.exists(), "{words}: nothing is written for a refusal");
    }
}

/// Gains go over the link to a board, and the page is written beside its pictures.
#[test]
fn gains_are_written_and_set_on_a_board() {
    let folder = tempfile::tempdir().unwrap();
    let mut arguments = parsed("--samples 200 --send --board sim");
    arguments.out = folder.path().join("out");
    run(&arguments).unwrap();
    let page = std::fs::read_to_string(arguments.out.join("tuning.html")).unwrap();
    assert!(
        page.contains("certified") && page.contains("gains of the thesis") && page.matches("<figure>").count() >= 5
    );
    assert!(arguments.out.join("nyquist.svg").is_file());
}
