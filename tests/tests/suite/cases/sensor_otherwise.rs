//! More of what a sensor does, on the recordings of the control: the answer stays that of the control, or the message names the key.

use std::fs;
use std::sync::LazyLock;

use palpate::identify::spec::FitSpec;
use palpate::identify::{Identification, identify};
use tempfile::TempDir;

use super::case::{input, message, read};

/// The control with every row of its recordings changed: time (s), depth (mm), force (N).
fn control(change: impl Fn(&mut Vec<[f64; 3]>)) -> Option<TempDir> {
    let folder = input("00-control")?;
    let copy = TempDir::new().unwrap();
    fs::copy(folder.join("experiment.toml"), copy.path().join("experiment.toml")).unwrap();
    for run in &read(&folder).runs {
        let own = &run.recording;
        let columns = own.time_s.iter().zip(&own.depth_mm).zip(&own.force_n);
        let mut rows: Vec<[f64; 3]> = columns.map(|((time, depth), force)| [*time, *depth, *force]).collect();
        change(&mut rows);
        let lines = rows.iter().map(|[time, depth, force]| format!("{time},{depth},{force}\n"));
        let text: String = std::iter::once("time_s,depth_mm,force_N\n".to_owned()).chain(lines).collect();
        fs::write(copy.path().join(&run.file), text).unwrap();
    }
    Some(copy)
}

fn found(folder: &TempDir) -> Identification {
    identify(&read(folder.path()), &FitSpec::default(), &|_, _, _| {}).unwrap().remove(0)
}

fn values(of: &Identification) -> [(f64, f64, f64); 2] {
    ["mu_MPa", "alpha"].map(|name| {
        let fit = of.fit.as_ref().expect("a fit");
        let own = fit.parameters.iter().find(|parameter| parameter.name == name).expect("the parameter");
        (own.value, own.interval95.low, own.interval95.high)
    })
}

/// The control's own answer, which all others are compared with.
static SOUND: LazyLock<Option<[(f64, f64, f64); 2]>> =
    LazyLock::new(|| control(|_| {}).map(|sound| values(&found(&sound))));

/// The control's answer: within a third of its interval, and a message with all parts.
#[track_caller]
fn stays(change: impl Fn(&mut Vec<[f64; 3]>), parts: &[&str]) {
    let (Some(before), Some(changed)) = (*SOUND, control(change)) else { return };
    let after = found(&changed);
    for ((value, low, high), (now, ..)) in before.into_iter().zip(values(&after)) {
        assert!((now - value).abs() < (high - low) / 3.0, "{now} for {value} [{low}, {high}]: {:#?}", after.messages);
    }
    let told = after.messages.iter().any(|message| parts.iter().all(|part| message.contains(part)));
    assert!(told || parts.is_empty(), "{parts:?} in {:#?}", after.messages);
}

#[track_caller]
fn refused(change: impl Fn(&mut Vec<[f64; 3]>), part: &str) {
    let Some(folder) = control(change) else { return };
    let said = message(folder.path());
    assert!(said.contains(part), "{said}\nlacks\n{part}");
}

/// A cell that was never tared, by a tenth of the peak; one whose cable pulls as it goes down.
#[test]
fn zeros() {
    stays(|rows| rows.iter_mut().for_each(|row| row[2] -= 0.26), &["force zero: the sensor reads -0.2", "taken off"]);
    stays(
        |rows| rows.iter_mut().for_each(|row| row[2] += 0.02 + 0.02 * row[1]),
        &["force zero: the sensor reads ", "more each mm"],
    );
}

/// Two wrong readings in a row; a wrong reading of the depth; codes of another device in the press itself.
#[test]
fn glitches() {
    stays(
        |rows| {
            let at = rows.len() - 20;
            (rows[at][2], rows[at + 1][2]) = (-4.0, -3.5);
        },
        &["2 readings of force_N, up to -4, far off their neighbours"],
    );
    stays(
        |rows| {
            let at = rows.len() - 30;
            rows[at][1] += 6.0;
        },
        &["depth_mm is ", "far off its neighbours"],
    );
    stays(
        |rows| [10, 60, 80].into_iter().for_each(|at| rows[at][2] = 32767.0),
        &["3 readings of force_N, up to 32767"],
    );
}

/// A cell at its limit that the ball leaves again, and one whose converter has steps.
#[test]
fn limits() {
    let clipped = |limit: f64| {
        move |rows: &mut Vec<[f64; 3]>| {
            let back: Vec<[f64; 3]> = rows.iter().rev().skip(1).copied().collect();
            let end = rows[rows.len() - 1][0];
            rows.extend(back.iter().map(|[time, depth, force]| [2.0 * end - time, *depth, 0.9 * force]));
            rows.iter_mut().for_each(|row| row[2] = row[2].min(limit));
        }
    };
    let parts = ["the force sensor is saturated", "stands at 1.9 N", "the run is used up to there"];
    stays(clipped(1.9), &parts);
    let stepped = move |rows: &mut Vec<[f64; 3]>| {
        clipped(2.0)(rows);
        rows.iter_mut().for_each(|row| row[2] = (row[2] / 0.01).round() * 0.01);
    };
    stays(stepped, &["the force sensor is saturated", "stands at 2 N"]);
}

/// The depth alone counts the other way; both do, from a zero of the machine's.
#[test]
fn directions() {
    refused(
        |rows| rows.iter_mut().for_each(|row| row[1] = -row[1]),
        "write depth_mm = { name = \"...\", sign = -1 } in [columns]",
    );
    stays(
        |rows| rows.iter_mut().for_each(|row| (row[1], row[2]) = (120.0 - row[1], -row[2])),
        &["compression counts negative: both are turned"],
    );
}

/// Depths in metres, forces in millinewtons that say nothing of it.
#[test]
fn units() {
    refused(|rows| rows.iter_mut().for_each(|row| row[1] *= 1e-3), "is `depth_mm` in metres? Then write scale = 1000");
    let Some(folder) = control(|rows| rows.iter_mut().for_each(|row| row[2] *= 1e3)) else { return };
    let of = found(&folder);
    let asked = |message: &String| message.contains("is `force_N` in mN? Then write scale = 0.001");
    assert!(of.messages.iter().any(asked), "{:#?}", of.messages);
}

/// Two cycles as deep as the first; an approach of another speed that is not much faster.
#[test]
fn motions() {
    let cycled = |rows: &mut Vec<[f64; 3]>| {
        let (once, end) = (rows.clone(), rows[rows.len() - 1][0]);
        for cycle in 0..2 {
            let from = end * (1.0 + 2.0 * f64::from(cycle));
            rows.extend(once.iter().rev().skip(1).map(|[time, depth, force]| [from + end - time, *depth, *force]));
            rows.extend(once.iter().skip(1).map(|[time, depth, force]| [from + end + time, *depth, *force]));
        }
    };
    stays(cycled, &["3 loadings are recorded and the first is used", "from_s and to_s in its [[run]] choose another"]);
    let slower = |rows: &mut Vec<[f64; 3]>| {
        let above: Vec<[f64; 3]> = (0..80).map(|i| [0.05 * f64::from(i), -18.0 + 0.2 * f64::from(i), 0.0]).collect();
        let (first, noise) = (rows[0], [0.002, -0.003, 0.001, 0.004, -0.002]);
        let shift = 0.05 * 80.0 - first[0] + (-18.0 + 0.2 * 80.0 - first[1]).abs() / 4.0;
        rows.iter_mut().for_each(|row| row[0] += shift);
        let noisy = above.iter().enumerate().map(|(i, [time, depth, _])| [*time, *depth, noise[i % 5]]);
        *rows = noisy.filter(|row| row[1] < first[1]).chain(rows.iter().copied()).collect();
    };
    stays(slower, &[]);
}

/// A hold in which the force falls is told, one in which it does not is not.
#[test]
fn holds() {
    let held = |falls: f64| {
        move |rows: &mut Vec<[f64; 3]>| {
            let [end, depth, force] = rows[rows.len() - 1];
            let later = (1..200).map(|i| 0.05 * f64::from(i));
            rows.extend(later.map(|t| [end + t, depth, force * (1.0 - falls * (1.0 - (-t / 2.0).exp()))]));
        }
    };
    stays(held(0.3), &["falls by 29 % in the hold of ", "--relax 1"]);
    let Some(folder) = control(held(0.0)) else { return };
    let of = found(&folder);
    assert!(!of.messages.iter().any(|message| message.contains("in the hold")), "{:#?}", of.messages);
}
