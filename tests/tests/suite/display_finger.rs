//! Pulp and fluid under a finger as links of the display's diagnosis: hidden flaws, a finger of others.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use palpate::diagnose::Verdict;
use palpate::diagnose::display::channel::Channel;
use palpate::diagnose::display::{self, ChannelDiagnosis};
use palpate::experiment::{self, Experiment};
use tests::display::{Case, Followed, Outcome, Plan, Scored};

fn scored(seed: u64, hidden: &[&'static str], level: usize) -> Scored {
    let scored = Scored::of(&Case::clean(Plan::Finger, seed).hiding(hidden, level)).unwrap();
    println!("{}", scored.line());
    scored
}

#[test]
fn a_finger_as_simulated_raises_no_alarm() {
    let all = [611, 612, 613].map(|seed| scored(seed, &[], 0));
    // of 36 fresh ones two had an alarm, none a name
    assert!(
        all.iter().filter(|one| one.outcome != Outcome::Clean).count() <= 1
            && all.iter().all(|one| one.named.is_empty())
    );
}

/// At a size that these presses see well, and never another name.
#[test]
fn what_is_wrong_with_pulp_and_fluid_has_its_name() {
    let cases = [
        (621, "pulp-relaxation"),
        (622, "pulp-size"),
        (623, "fluid-response"),
        (624, "yield-law"),
        (625, "fluid-rest"),
        (626, "fluid-viscosity"),
        (627, "outside-ridges"),
        (628, "outside-cup"),
    ];
    let all: Vec<Scored> = cases.iter().map(|(seed, name)| scored(*seed, &[name], 3)).collect();
    let named = all[..6].iter().filter(|one| matches!(one.outcome, Outcome::Exact | Outcome::InSet)).count();
    assert!(named >= 4 && all.iter().all(|one| one.outcome != Outcome::Wrong), "{named} of 6 named");
    assert!(all[6..].iter().all(|one| one.outcome == Outcome::Unknown), "what is in no catalogue is unknown");
}

/// Three currents tell a rest from a bend of the yield stress too little to name it. What is proposed is what tells them apart, and
/// when it is done the rest has its name.
#[test]
fn what_is_unknown_is_named_by_the_run_that_it_proposes() {
    let case = Case::clean(Plan::Finger, 194_125).hiding(&["fluid-rest"], 2);
    let found = display::diagnose(&case.spec(true).experiment(), &|_, _, _| {}).unwrap();
    let first = Scored::judged(&case, &found);
    assert_eq!(first.outcome, Outcome::Unknown, "{}", first.line());
    let followed = Followed::of(&case, &found, &first).unwrap();
    println!("{} {:?}", followed.scored.line(), followed.commands);
    assert!(followed.commands[0].ends_with("without current"), "{:?}", followed.commands);
    assert_eq!(followed.scored.outcome, Outcome::Exact);
}

/// A fingerpad of others on a plate that stands: force exponential in the compression, three times of relaxation (form and times of
/// Pawluk and Howe 1999, doi:10.1115/1.2835100; amounts assumed). `elastic` leaves the relaxation out.
fn fingerpad(elastic: bool) -> Experiment {
    const TICK_S: f64 = 0.02;
    let parts: [(f64, f64); 3] = if elastic { [(0.0, 1.0); 3] } else { [(0.15, 0.004), (0.2, 0.07), (0.2, 1.4)] };
    let rest = 1.0 - parts.iter().map(|(part, _)| part).sum::<f64>();
    let instant = |mm: f64| if mm > 0.0 { 0.3 * (((1.3 * mm).exp() - 1.0) / 1.3) } else { 0.0 };
    // down, hold, up: s, and how deep, mm
    let ways = [(1.5, 1.0, 2.0), (0.3, 3.0, 2.0), (0.6, 1.0, 1.2)];
    let folder = tempfile::tempdir().unwrap();
    let mut toml = String::new();
    // a fixed pattern in place of noise: neighbours differ, repeats too
    let mut wiggle = 7_u32;
    let mut noise = || {
        wiggle = wiggle.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(wiggle >> 8) / f64::from(1 << 24) - 0.5
    };
    for (way, (way_s, hold_s, deep_mm)) in ways.into_iter().enumerate() {
        for repeat in 0..3 {
            let place =
                |t: f64| deep_mm * ((t - 0.2) / way_s).min((0.2 + 2.0 * way_s + hold_s - t) / way_s).clamp(0.0, 1.0);
            let gain = 1.0 + 0.02 * noise();
            let mut late = [0.0; 3];
            let mut csv = "time_s,finger_mm,position_mm,reference_N\n".to_owned();
            for k in 0..((0.6 + 2.0 * way_s + hold_s) / TICK_S) as usize {
                let t = k as f64 * TICK_S;
                let force = rest * instant(place(t))
                    + parts.iter().zip(&late).map(|((part, _), late)| part * (instant(place(t)) - late)).sum::<f64>();
                let read = gain * force.max(0.0) + 0.01 * noise();
                csv.push_str(&format!("{t:.2},{:.4},0,{read:.4}\n", place(t) + 0.01 * noise()));
                for i in 0..200 {
                    let dt_s = TICK_S / 200.0;
                    let now = instant(place(t + (f64::from(i) + 0.5) * dt_s));
                    for ((_, tau_s), late) in parts.iter().zip(&mut late) {
                        *late += (now - *late) * (1.0 - (-dt_s / tau_s).exp());
                    }
                }
            }
            let file = format!("{way}-{repeat}.csv");
            std::fs::write(folder.path().join(&file), csv).unwrap();
            toml.push_str(&format!("[[run]]\nfile = \"{file}\"\ntest = \"display\"\n"));
        }
    }
    std::fs::write(folder.path().join("experiment.toml"), toml).unwrap();
    experiment::read(folder.path()).unwrap()
}

fn pulp(experiment: &Experiment) -> ChannelDiagnosis {
    let found = display::diagnose(experiment, &|_, _, _| {}).unwrap();
    found.channels.into_iter().find(|one| one.channel == Channel::Pulp).unwrap()
}

/// What relaxes with three times, and stiffens otherwise than the round finger, is seen to relax; what only stiffens otherwise is not.
#[test]
fn a_fingerpad_of_others_relaxes_where_it_does() {
    let found = pulp(&fingerpad(false));
    let evidence = found.evidence.as_deref().unwrap();
    let believed = |of: &ChannelDiagnosis, code: &str| {
        let beliefs = &of.evidence.as_deref().unwrap().judged.beliefs;
        beliefs.iter().find(|belief| belief.name == code).map_or(0.0, |belief| belief.probability)
    };
    println!("{:?} {:?}", found.verdict, evidence.judged.beliefs);
    assert!(believed(&found, "pulp-relaxation") > 0.99 && found.verdict != Verdict::Clean);
    let elastic = pulp(&fingerpad(true));
    println!("{:?} {:?}", elastic.verdict, elastic.findings);
    assert!(elastic.findings.iter().all(|finding| finding.code != "pulp-relaxation"));
    assert!(elastic.verdict != Verdict::Clean, "an exponential is no round finger");
}

/// A press without a field, which a fluid that bears something at rest is asked for, is no dead sensor; and a fast logger's presses are
/// compared as a slow one's.
#[test]
fn a_fluid_without_a_field_and_a_fast_logger_are_judged() {
    let folder = tempfile::tempdir().unwrap();
    let mut toml = String::new();
    for (at, flux_t) in [0.0, 0.08, 0.0, 0.08, 0.0, 0.08].into_iter().enumerate() {
        let mut csv = "time_s,finger_mm,flux_T,reference_N\n".to_owned();
        for k in 0..1600 {
            let t = 0.0025 * f64::from(k);
            let mm = (1.5 * (t - 0.5)).clamp(0.0, 3.0);
            let wiggle = [1.0, -0.6, 0.3, -1.0, 0.8, -0.2, 0.5][(k as usize + 3 * at) % 7];
            let force = 0.02 * mm + if flux_t > 0.0 { 0.1 * mm * mm } else { 0.0 } + 0.004 * wiggle;
            csv.push_str(&format!("{t:.4},{mm:.4},{flux_t},{force:.5}\n"));
        }
        std::fs::write(folder.path().join(format!("{at}.csv")), csv).unwrap();
        toml.push_str(&format!("[[run]]\nfile = \"{at}.csv\"\ntest = \"display\"\n"));
    }
    std::fs::write(folder.path().join("experiment.toml"), toml).unwrap();
    let found = display::diagnose(&experiment::read(folder.path()).unwrap(), &|_, _, _| {}).unwrap();
    let fluid = found.channels.iter().find(|one| one.channel == Channel::Fluid).unwrap();
    assert!(fluid.refusal.is_none(), "{:?}", fluid.refusal);
    let compared = fluid.evidence.as_deref().unwrap().design.series.iter();
    // 2 s of the way down at 400 Hz, less the beginning and the end
    assert!(
        compared.clone().all(|s| s.compared.iter().filter(|one| **one).count() > 700),
        "{}",
        fluid.messages.join(", ")
    );
}

/// A finger needs what lies under it, and repeats.
#[test]
fn a_finger_over_nothing_is_told() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.csv"), "time_s,finger_mm,reference_N\n0,0,0\n0.02,1,0.1\n").unwrap();
    std::fs::write(folder.path().join("experiment.toml"), "[[run]]\nfile = \"a.csv\"\ntest = \"display\"\n").unwrap();
    let told = experiment::read(folder.path()).unwrap_err().to_string();
    assert!(told.contains("finger_mm and reference_N with position_mm or flux_T"), "{told}");
}
