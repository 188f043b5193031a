//! Identification by inverse finite elements: solves and time.

use palpate::identify::spec::FitSpec;
use tests::recovery::{cases, recover};

use super::row::Row;

/// Foams drawn from the thesis' ranges.
const CASES: usize = 12;
const SEED: u64 = 1;

/// Most solves and seconds for (mu, alpha) of one recording.
const GOAL: (usize, f64) = (10, 1.0);

pub fn rows() -> Result<Vec<Row>, Box<dyn std::error::Error>> {
    let (mut cases, _) = cases(SEED, CASES);
    let (mut solves, mut seconds, mut errors) = (Vec::new(), Vec::new(), Vec::new());
    for case in &mut cases {
        case.experiment.runs.truncate(1);
        let found = recover(case, &[], &FitSpec::default())?;
        solves.push(found.solves as f64);
        seconds.push(found.seconds);
        errors.push((found.value[1] / found.truth[1] - 1.0).abs());
    }
    for list in [&mut solves, &mut seconds, &mut errors] {
        list.sort_by(f64::total_cmp);
    }
    let middle = |list: &[f64]| list.get(list.len() / 2).copied().unwrap_or(f64::NAN);
    let most = |list: &[f64]| list.last().copied().unwrap_or(f64::NAN);
    let met = most(&solves) <= GOAL.0 as f64 && most(&seconds) <= GOAL.1;
    Ok(vec![
        Row {
            what: "inverse finite elements",
            case: format!("(mu, alpha) of one recording with 1 % noise, {} foams", solves.len()),
            thesis: "hundreds of Abaqus runs".into(),
            goal: format!("<= {} solves, <= {} s on 2 cores", GOAL.0, GOAL.1),
            measured: format!(
                "{:.0} solves and {:.2} s in the middle, {:.0} and {:.2} s at most",
                middle(&solves),
                middle(&seconds),
                most(&solves),
                most(&seconds)
            ),
            met: Some(met),
        },
        Row {
            what: "inverse finite elements",
            case: "six hyper-viscoelastic parameters".into(),
            thesis: "hundreds of Abaqus runs".into(),
            goal: "<= 60 s".into(),
            measured: "not by this command".into(),
            met: None,
        },
    ])
}
