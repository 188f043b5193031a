//! Identification by inverse finite elements: solves and time.

use std::fmt::Write as _;

use palpate::identify::identify;
use palpate::identify::spec::FitSpec;
use palpate::report::number;
use tests::processor::Clock;
use tests::recovery::cases;
use tests::tissue::{LIVER, Pressed, Recovered, recover};

use super::row::Row;

/// Foams drawn from the thesis' ranges.
const CASES: usize = 12;
const SEED: u64 = 1;

/// Most solves and seconds for (mu, alpha) of one recording.
const GOAL: (usize, f64) = (10, 1.0);

/// Most seconds for the six parameters of tissue.
const SIX_GOAL_S: f64 = 60.0;

/// Rows, and the table of the six parameters.
pub fn measure() -> Result<(Vec<Row>, String), Box<dyn std::error::Error>> {
    let experiment = Pressed::default().record(&LIVER, SEED)?;
    let clock = Clock::of_process();
    let (found, recovered) = recover(&experiment, &LIVER)?;
    let six = Row {
        what: "inverse finite elements",
        case: "six hyper-viscoelastic parameters of one ramp and hold with 1 % noise".into(),
        thesis: "hundreds of Abaqus runs".into(),
        goal: format!("<= {SIX_GOAL_S} s"),
        measured: format!(
            "{} solves, {:.1} s ({:.1} s CPU); {} of 6 identified, the others named as not",
            found.fe_solves,
            found.seconds,
            clock.cpu_s(),
            recovered.iter().filter(|r| r.standing.is_some_and(|s| s.word() == "identified")).count()
        ),
        met: Some(found.seconds <= SIX_GOAL_S),
    };
    Ok((vec![two()?, six], table(&recovered)))
}

fn two() -> Result<Row, Box<dyn std::error::Error>> {
    let (mut cases, _) = cases(SEED, CASES);
    let (mut solves, mut seconds, mut cpu) = (Vec::new(), Vec::new(), Vec::new());
    for case in &mut cases {
        case.experiment.runs.truncate(1);
        let clock = Clock::of_process();
        for found in identify(&case.experiment, &FitSpec::default(), &|_, _, _| {})? {
            solves.push(found.fe_solves as f64);
            seconds.push(found.seconds);
            cpu.push(clock.cpu_s());
        }
    }
    for list in [&mut solves, &mut seconds, &mut cpu] {
        list.sort_by(f64::total_cmp);
    }
    let middle = |list: &[f64]| list.get(list.len() / 2).copied().unwrap_or(f64::NAN);
    let most = |list: &[f64]| list.last().copied().unwrap_or(f64::NAN);
    Ok(Row {
        what: "inverse finite elements",
        case: format!("(mu, alpha) of one recording with 1 % noise, {} foams", solves.len()),
        thesis: "hundreds of Abaqus runs".into(),
        goal: format!("<= {} solves, <= {} s on 2 cores", GOAL.0, GOAL.1),
        measured: format!(
            "{:.0} solves and {:.2} s ({:.2} s CPU) in the middle, {:.0} and {:.2} s ({:.2} s CPU) at most",
            middle(&solves),
            middle(&seconds),
            middle(&cpu),
            most(&solves),
            most(&seconds),
            most(&cpu)
        ),
        met: Some(most(&solves) <= GOAL.0 as f64 && most(&seconds) <= GOAL.1),
    })
}

/// Truth, estimate, and how far both are apart against half the interval.
fn table(recovered: &[Recovered]) -> String {
    let mut out = String::from(
        "| parameter | truth | found | 95 % interval | error over half of it | the fit says |\n|---|---|---|---|---|---|\n",
    );
    for r in recovered {
        let half = 0.5 * (r.interval.1 - r.interval.0);
        let said = r.standing.map_or("nothing", |s| s.word());
        let _ = writeln!(
            out,
            "| {} | {} | {} | {} to {}{} | {:.2} | {said} |",
            r.name,
            number(r.truth),
            number(r.value),
            number(r.interval.0),
            number(r.interval.1),
            if r.holds() { "" } else { ", without the truth" },
            (r.value - r.truth).abs() / half
        );
    }
    out
}
