//! The answer, the table and the page of the study of depth.

use serde_json::{Value, json};

use crate::identify::fe::Progress;
use crate::report::number;
use crate::study::findings::{Findings, Table};
use crate::study::{StudyError, Subject};

use super::{Ball, DRAWS, Depths, EARLY_MM, Point, SHARES, depths, picture};

/// A meeting point whose interval of alpha is this many times longer than the joint fit's is called poorly known.
const VAGUE: f64 = 2.0;

/// The study.
///
/// # Errors
/// As [`depths`].
pub fn study(subject: &Subject, seed: u64, progress: &Progress<'_>) -> Result<Findings, StudyError> {
    let found = depths(subject, seed, progress)?;
    let mut table = Table::new(&[
        "ball",
        "depth (mm)",
        "mu (MPa)",
        "from",
        "to",
        "alpha",
        "from",
        "to",
        "mu, early contact",
        "alpha, early contact",
    ]);
    for ball in &found.balls {
        for point in &ball.points {
            table.rows.push(row(ball, point));
        }
    }
    Ok(Findings {
        study: "depth",
        title: "What is identified from how deep".to_owned(),
        subject: subject.sentence(),
        method: vec![
            format!("Each ball alone; its runs are cut at seven depths past the guessed contact, and mu, alpha and the contact points are identified from what is left (Gauss-Newton on force models of {} finite-element solves).", found.solves),
            "Intervals: 95 %, profile likelihood, as identify gives them.".to_owned(),
            "Trend: the principal axis of a ball's points in the logarithms of alpha and mu; meeting point: where the first two balls' axes cross.".to_owned(),
            format!("Interval of the meeting point: 95 % of {DRAWS} draws of the noise, carried through the linearised fits of all depths together, because deeper cuts contain the shallower ones (seed {seed})."),
            format!("Early contact: the same fits with every contact point held {EARLY_MM} mm before its best value."),
        ],
        answer: answer(&found, subject),
        tables: vec![table],
        pictures: picture::all(&found, subject),
        json: [
            ("balls".to_owned(), found.balls.iter().map(of_json).collect()),
            ("meeting".to_owned(), json!(found.meeting.as_ref().map(|m| json!({
                "mu_MPa": m.value[0], "mu_interval95": [m.interval[0].0, m.interval[0].1],
                "alpha": m.value[1], "alpha_interval95": [m.interval[1].0, m.interval[1].1],
            })))),
            ("joint".to_owned(), json!(found.joint.map(|[mu, alpha]| json!({
                "mu_MPa": mu.0, "mu_interval95": [mu.1, mu.2], "alpha": alpha.0, "alpha_interval95": [alpha.1, alpha.2],
            })))),
            ("early_contact_mm".to_owned(), json!(EARLY_MM)),
            ("early_meeting".to_owned(), json!(found.early_meeting.map(|[mu, alpha]| json!({"mu_MPa": mu, "alpha": alpha})))),
            ("fe_solves".to_owned(), json!(found.solves)),
        ]
        .into_iter()
        .collect(),
    })
}

fn row(ball: &Ball, point: &Point) -> Vec<String> {
    let mut row = vec![ball.name.clone(), number(point.depth_mm)];
    for at in 0..2 {
        row.extend([point.value[at], point.interval[at].0, point.interval[at].1].map(number));
    }
    row.extend(point.early.map(number));
    row
}

fn of_json(ball: &Ball) -> Value {
    let points = ball.points.iter().map(|point| {
        json!({
            "depth_mm": point.depth_mm,
            "mu_MPa": point.value[0],
            "mu_interval95": [point.interval[0].0, point.interval[0].1],
            "alpha": point.value[1],
            "alpha_interval95": [point.interval[1].0, point.interval[1].1],
            "early": {"mu_MPa": point.early[0], "alpha": point.early[1]},
        })
    });
    json!({"ball": ball.name, "points": points.collect::<Vec<_>>()})
}

fn answer(found: &Depths, subject: &Subject) -> Vec<String> {
    let mut answer = Vec::new();
    for ball in &found.balls {
        let (Some(first), Some(last)) = (ball.points.first(), ball.points.last()) else { continue };
        let width = |point: &Point| (point.interval[1].1 - point.interval[1].0) / point.value[1];
        answer.push(format!(
            "{}: from {} mm on to {} mm the interval of alpha narrows from {} % to {} % of its value",
            ball.name,
            number(first.depth_mm),
            number(last.depth_mm),
            number(100.0 * width(first)),
            number(100.0 * width(last))
        ));
    }
    match &found.meeting {
        Some(meeting) => answer.push(format!(
            "the trends of the balls meet at mu {} MPa (95 %: {} to {}) and alpha {} ({} to {})",
            number(meeting.value[0]),
            number(meeting.interval[0].0),
            number(meeting.interval[0].1),
            number(meeting.value[1]),
            number(meeting.interval[1].0),
            number(meeting.interval[1].1)
        )),
        None => answer.push("there are no two trends that meet".to_owned()),
    }
    if let (Some([mu, alpha]), true) = (found.joint, found.balls.len() > 1) {
        answer.push(format!(
            "one fit to all balls at full depth says mu {} MPa ({} to {}) and alpha {} ({} to {})",
            number(mu.0),
            number(mu.1),
            number(mu.2),
            number(alpha.0),
            number(alpha.1),
            number(alpha.2)
        ));
    }
    if let (Some(meeting), Some([_, alpha])) = (&found.meeting, found.joint) {
        let (low, high) = meeting.interval[1];
        if (high / low).ln() > VAGUE * (alpha.2 / alpha.1).ln() {
            answer.push(
                "both trends run along the same valley of the objective, so that where they cross is poorly known; the joint fit is the better answer".to_owned(),
            );
        }
    }
    for ball in found.balls.iter().filter(|ball| ball.points.len() < SHARES.len()) {
        answer.push(format!(
            "{}: {} of {} cuts are too shallow to identify anything from",
            ball.name,
            SHARES.len() - ball.points.len(),
            SHARES.len()
        ));
    }
    let percent = |point: &Point| number(100.0 * (point.early[1] / point.value[1] - 1.0));
    let shift = |ball: &Ball| {
        let (first, last) = (ball.points.first()?, ball.points.last()?);
        let (from, to) = (number(first.depth_mm), number(last.depth_mm));
        Some(format!("{}: {} % at {from} mm, {} % at {to} mm", ball.name, percent(first), percent(last)))
    };
    answer.push(format!(
        "a contact point {EARLY_MM} mm early alone makes alpha depend on depth and ball; it moves it by ({})",
        found.balls.iter().filter_map(shift).collect::<Vec<_>>().join("; ")
    ));
    if let (Some([mu, alpha]), true) = (found.early_meeting, subject.foam.is_some()) {
        answer.push(format!("with early contact the trends meet at mu {} MPa and alpha {}", number(mu), number(alpha)));
    }
    answer
}
