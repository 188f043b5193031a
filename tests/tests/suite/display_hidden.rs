//! A part of the score of the display's diagnosis (`cargo run --release -p tests --example display`), its negative controls, and the
//! folder on disk.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate::diagnose::Verdict;
use palpate::diagnose::display::channel::Channel;
use palpate::diagnose::display::{self, ChannelDiagnosis, Diagnosis, answer};
use palpate::experiment::{self, Experiment};
use palpate::extended::display::DisplayModel;
use palpate::simulate::display::{DisplayEffect, DisplayRun, DisplaySpec, Subject, parse};
use tests::display::{Case, Gains, Outcome, Plan, Scored, Validated, is_right};

fn found(experiment: &Experiment) -> Diagnosis {
    display::diagnose(experiment, &|_, _, _| {}).unwrap()
}

fn scored(plan: Plan, seed: u64, hidden: &[&'static str], level: usize) -> Scored {
    let scored = Scored::of(&Case::clean(plan, seed).hiding(hidden, level)).unwrap();
    println!("{}", scored.line());
    scored
}

#[test]
fn clean_displays_raise_no_alarm() {
    for (plan, seed) in
        [(Plan::Full, 501), (Plan::Full, 502), (Plan::Short, 503), (Plan::Short, 504), (Plan::Short, 505)]
    {
        let one = scored(plan, seed, &[], 0);
        assert_eq!(one.outcome, Outcome::Clean, "{}", one.line());
    }
}

/// Strengths that a full plan sees well: three of four are named, as in the score (18 of 23), the fourth may be "unknown" but not wrong. (The
/// delay of seed 512 is found at its true size, but leaves a margin 2 % over its threshold.)
#[test]
fn the_first_four_effects_are_named() {
    let cases = [(511, "rate-limit"), (512, "delay"), (513, "creep"), (514, "sensor-nonlinearity")];
    let all: Vec<Scored> = cases.iter().map(|(seed, name)| scored(Plan::Full, *seed, &[name], 2)).collect();
    let named = all.iter().filter(|one| matches!(one.outcome, Outcome::Exact | Outcome::InSet)).count();
    assert!(named >= 3 && all.iter().all(|one| one.outcome != Outcome::Wrong), "{named} of 4 named");
}

#[test]
fn what_is_in_no_catalogue_is_unknown() {
    for (seed, name) in [(521, "outside-wobble"), (522, "outside-viscous")] {
        let one = scored(Plan::Full, seed, &[name], 3);
        assert_eq!(one.outcome, Outcome::Unknown, "{}", one.line());
    }
}

/// A strong vibration leads the base's fit astray, and a delay then takes up most of what is left. What it leaves is no
/// discrepancy: it is not named.
#[test]
fn a_name_that_leaves_more_than_a_discrepancy_is_withdrawn() {
    let one = scored(Plan::Full, 196_007, &["outside-wobble"], 3);
    assert!(one.outcome == Outcome::Unknown && one.named.is_empty());
}

/// A short plan cannot see everything, but what it says is right.
#[test]
fn few_runs_give_no_wrong_name() {
    for (seed, name) in
        [(531, "rate-limit"), (532, "delay"), (533, "stiction"), (534, "creep"), (535, "outside-ripple")]
    {
        let one = scored(Plan::Short, seed, &[name], 2);
        assert_ne!(one.outcome, Outcome::Wrong, "{}", one.line());
    }
}

/// What is printed as the gain is what new sessions show, within a tenth of the error that was there before; measured on as many
/// runs as the program asks for, within a tenth of itself.
#[test]
fn a_printed_gain_is_that_of_another_session() {
    /// The true gain is known to a few percent of itself.
    const DAYS: u64 = 32;
    for (seed, name) in [(541, "backlash"), (542, "delay")] {
        let case = Case::clean(Plan::Full, seed).hiding(&[name], 2);
        let found = found(&case.spec(true).experiment());
        let model = DisplayModel::of(&found).unwrap();
        let gains = |one: &ChannelDiagnosis| Some((one.channel, Gains::of(one, &model, &case, DAYS)?));
        let gains: Vec<(Channel, Gains)> = found.channels.iter().filter_map(gains).collect();
        assert!(!gains.is_empty() && gains.iter().all(|(_, own)| own.is_near()), "{name}: {gains:?}");
        for (channel, own) in gains {
            let validated = Validated::of(channel, &model, &case).unwrap();
            let (part, truth) = (validated.gain.part(), own.truth);
            assert!(
                validated.is_close() && is_right(part, truth),
                "{name}: {part} of {} runs, true {truth}",
                validated.runs()
            );
        }
    }
}

fn steps(replicates: usize) -> DisplaySpec {
    let mut spec = DisplaySpec::new("steps", 7);
    spec.runs.push(DisplayRun::new(Subject::Position, vec![4.0, 12.0, 6.0, 7.0], 0.8).times(replicates));
    spec
}

#[test]
fn without_repeats_the_answer_is_refused_with_what_to_do() {
    let found = found(&steps(1).experiment());
    assert_eq!(found.verdict, Verdict::Refused);
    let told = answer::json(&found, None);
    let reason = told["channels"][0]["reason"].as_str().unwrap();
    assert!(reason.contains("no two runs repeat a command") && reason.contains("better three times"), "{reason}");
}

#[test]
fn a_dead_sensor_is_reported_as_one() {
    let mut experiment = steps(3).experiment();
    let dead = experiment.runs[1].recording.others.get_mut("position_mm").unwrap();
    dead.fill(4.0);
    let found = found(&experiment);
    assert_eq!(found.verdict, Verdict::Refused);
    let reason = found.channels[0].refusal.as_ref().unwrap().to_string();
    assert!(reason.contains("position-1-2.csv") && reason.contains("a dead sensor"), "{reason}");
}

/// The order of the runs in the file changes nothing.
#[test]
fn another_order_gives_the_same_verdict() {
    let mut spec = steps(3);
    spec.effects.push(DisplayEffect::Delay { seconds: 0.03 });
    let mut experiment = spec.experiment();
    let before = found(&experiment);
    experiment.runs.reverse();
    let after = found(&experiment);
    let codes = |found: &Diagnosis| -> Vec<_> {
        found.channels.iter().flat_map(|c| &c.findings).map(|f| (f.code, f.ambiguous_with.clone())).collect()
    };
    assert_eq!((before.verdict, codes(&before)), (after.verdict, codes(&after)));
}

/// What is written is what was simulated, whatever reads it, and the answer has the keys of the contract.
#[test]
fn a_folder_on_disk_gives_the_same_answer() {
    let folder = tempfile::tempdir().unwrap();
    let mut spec = steps(3);
    spec.effects.push(DisplayEffect::RateLimit { mm_per_s: 12.0 });
    spec.write(folder.path()).unwrap();
    let read = experiment::read(folder.path()).unwrap();
    let told = answer::json(&found(&read), None);
    let direct = answer::json(&found(&spec.experiment()), None);
    assert_eq!(told["effects"], direct["effects"]);
    assert_eq!(told["effects"][0]["code"], "rate-limit", "{told}");
    for key in [
        "verdict",
        "effects",
        "ambiguous_with",
        "shows_in",
        "blind_to",
        "next_experiment",
        "held_out",
        "base",
        "extended",
        "report",
        "seconds",
    ] {
        assert!(told.get(key).is_some(), "{key} is missing");
    }
    let limit = told["effects"][0]["parameters"]["limit_mm_per_s"]["value"].as_f64().unwrap();
    // noise of 0.02 mm over a flank of 8 mm
    assert!((limit - 12.0).abs() < 0.5, "{limit}");
}

#[test]
fn mistakes_in_a_display_run_are_told_with_their_place() {
    let folder = tempfile::tempdir().unwrap();
    let wrong = |csv: &str| {
        std::fs::write(folder.path().join("a.csv"), csv).unwrap();
        let toml = "[[run]]\nfile = \"a.csv\"\ntest = \"display\"\n";
        std::fs::write(folder.path().join("experiment.toml"), toml).unwrap();
        experiment::read(folder.path()).unwrap_err().to_string()
    };
    let lone = wrong("time_s,command_mm\n0,1\n1,2\n");
    assert!(lone.contains("at least one pair of columns: command_mm with position_mm, or reference_N"), "{lone}");
    let cell = wrong("time_s,command_mm,position_mm\n0,1,1\n1,2,x\n");
    assert!(cell.contains("line 3, column 3 (position_mm): \"x\" is not a number"), "{cell}");
    let spec =
        parse(std::path::Path::new("d.toml"), "test = \"display\"\n[[run]]\nsubject = \"position\"\nvalues = [30.0]\n");
    assert!(spec.unwrap_err().to_string().contains("expected a list of positions of 0 to 20 mm"));
}
