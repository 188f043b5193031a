//! The answer, the table and the pictures of appendix C.

use lut_gen::solid::model::Resolution;
use serde_json::{Value, json};

use crate::identify::fe::Progress;
use crate::identify::identify_from;
use crate::identify::newton::condition::{Condition, Source};
use crate::identify::spec::{FitSpec, FittedLaw};
use crate::report::figure::{Axis, Figure, Series, Stroke};
use crate::report::number;
use crate::study::StudyError;
use crate::study::findings::{Findings, Picture, Table};

use super::simplex::{NO_GAIN, PATIENCE, STEP};
use super::{LIVER, Liver, NAMES, Press, START, Visit, searched};

/// The study: the script's search with at most so many evaluations, and `identify` on the same recording.
///
/// # Errors
/// When the recording, or no start of `identify`, can be solved.
pub fn study(press: Press, most: usize, progress: &Progress<'_>) -> Result<Findings, StudyError> {
    let mut liver = Liver::recorded(press)?;
    let visits = searched(&mut liver, most, progress);
    let script_solves = liver.solves();
    let best = visits.iter().min_by(|a, b| a.value.total_cmp(&b.value)).map_or(START.to_vec(), |v| v.x.clone());
    let end: Vec<f64> = best.iter().map(|x| x.abs()).collect();
    let at_truth = liver.objective_n(&LIVER);
    progress("identify, for comparison", 0, 0);
    let spec = FitSpec { law: Some(FittedLaw::Ogden), relaxation: 1, ..FitSpec::default() };
    let source = |_: &Condition| Source::Solves(Resolution::Refined(press.refinement));
    let found = identify_from(&liver.experiment(), "liver", &spec, &source)?;
    let value = |name: &str| {
        let all = found.fit.iter().flat_map(|fit| &fit.parameters);
        all.filter(|p| p.name == name).map(|p| (p.value, p.interval95.low, p.interval95.high)).next()
    };
    let mut table = Table::new(&[
        "parameter",
        "script's start",
        "script's end",
        "truth, section 2.11",
        "identify",
        "95 % from",
        "to",
    ]);
    for (at, name) in NAMES.iter().enumerate() {
        let ours = value(name);
        let cell = |of: fn((f64, f64, f64)) -> f64| ours.map_or(String::new(), |all| number(of(all)));
        table.rows.push(vec![
            (*name).to_owned(),
            number(START[at]),
            number(end[at]),
            number(LIVER[at]),
            cell(|v| v.0),
            cell(|v| v.1),
            cell(|v| v.2),
        ]);
    }
    let lowest = liver.objective_n(&end);
    let ended = if visits.len() >= most { "its evaluations are spent" } else { "it ends by its own rule" };
    let of_identify = found.fit.as_ref().map_or(f64::NAN, |fit| fit.objective_n);
    let answer = vec![
        format!(
            "the script leaves {} N after {} evaluations ({script_solves} solves), where {ended}; from its start, at {} N; the truth itself leaves {} N",
            number(lowest),
            visits.len(),
            number(visits.first().map_or(f64::NAN, |v| v.value)),
            number(at_truth)
        ),
        format!(
            "identify leaves {} N on the same samples and those of the air before, after {} solves: {}",
            number(of_identify),
            found.fe_solves,
            found.outcome.word()
        ),
    ];
    Ok(Findings {
        study: "script",
        title: "The script of appendix C".to_owned(),
        subject: format!(
            "simulated liver of section 2.11: ball of {} mm to {} mm at {} mm/s, hold of {} s, block of {} mm, noise {} % of the largest force, seed {}",
            number(press.ball_mm),
            number(press.depth_mm),
            number(press.rate_mm_s),
            number(press.hold_s),
            number(press.height_mm),
            number(100.0 * press.noise),
            press.seed
        ),
        method: how(most),
        answer,
        tables: vec![table],
        pictures: vec![way(&visits, at_truth), ahead(&mut liver, &end)],
        json: of_json(&visits, &end, lowest, at_truth, script_solves, &found, &liver),
    })
}

fn how(most: usize) -> Vec<String> {
    vec![
        format!(
            "Appendix C: Eq. 14 over (mu, alpha, D, g, k, tau) by a solve of ramp and hold an evaluation, the absolute value of every coordinate; first simplex {STEP} in each, whatever its unit; end after {PATIENCE} iterations without a gain of {NO_GAIN} N, or {most} evaluations, of which the script sets no limit."
        ),
        "It assigns m = fabs(x[0]) and goes on with mu, read as one name. A point without a material ends Abaqus and the script with it; here it is infinitely bad.".to_owned(),
        "The thesis' recording is not printed: ours is simulated with what section 2.11 found, on a mesh 1.5 times finer; the contact point is known to the script, and found by identify.".to_owned(),
    ]
}

fn of_json(
    visits: &[Visit],
    end: &[f64],
    lowest: f64,
    at_truth: f64,
    solves: usize,
    found: &crate::identify::Identification,
    liver: &Liver,
) -> serde_json::Map<String, Value> {
    let named = |x: &[f64]| -> Value { NAMES.iter().zip(x).map(|(name, x)| ((*name).to_owned(), json!(x))).collect() };
    let parameters: serde_json::Map<String, Value> = found
        .fit
        .iter()
        .flat_map(|fit| &fit.parameters)
        .map(|p| (p.name.clone(), json!({"value": p.value, "interval95": [p.interval95.low, p.interval95.high]})))
        .collect();
    [
        ("start".to_owned(), named(&START)),
        ("end".to_owned(), named(end)),
        ("truth".to_owned(), named(&LIVER)),
        ("objective_N".to_owned(), json!(lowest)),
        ("objective_of_truth_N".to_owned(), json!(at_truth)),
        ("fe_solves".to_owned(), json!(solves)),
        (
            "evaluations".to_owned(),
            visits.iter().map(|v| json!({"point": named(&v.x), "objective_N": v.value})).collect(),
        ),
        ("failures".to_owned(), json!(liver.failures)),
        (
            "identify".to_owned(),
            json!({
                "outcome": found.outcome.word(),
                "objective_N": found.fit.as_ref().map(|fit| fit.objective_n),
                "parameters": parameters,
                "fe_solves": found.fe_solves,
                "messages": found.messages,
            }),
        ),
    ]
    .into_iter()
    .collect()
}

/// Eq. 14 at every evaluation.
fn way(visits: &[Visit], at_truth: f64) -> Picture {
    let each: Vec<(f64, f64)> =
        visits.iter().enumerate().map(|(i, v)| (i as f64 + 1.0, v.value)).filter(|p| p.1.is_finite()).collect();
    let mut lowest = f64::INFINITY;
    let so_far: Vec<(f64, f64)> = each
        .iter()
        .map(|(i, value)| {
            lowest = lowest.min(*value);
            (*i, lowest)
        })
        .collect();
    let end = visits.len() as f64;
    let figure =
        Figure::new("The script's way down Eq. 14", Axis::new("evaluation"), Axis::new("Eq. 14 (N)").logarithmic())
            .with(Series::new("", each, Stroke::Circles, 0))
            .with(Series::new("best", so_far, Stroke::Solid, 1))
            .with(Series::new("truth", vec![(1.0, at_truth), (end, at_truth)], Stroke::Dashed, 2));
    Picture {
        file: "study-script".to_owned(),
        svg: figure.svg(),
        caption: "Every evaluation of the script, the best so far, and what the truth itself leaves of the noise. Points without a material are left out.".to_owned(),
    }
}

/// Measured force, that of the script's end, and that of its start.
fn ahead(liver: &mut Liver, end: &[f64]) -> Picture {
    let curve = |forces: Vec<f64>, times: &[f64]| times.iter().copied().zip(forces).collect::<Vec<_>>();
    let times = liver.time_s.clone();
    let measured: Vec<(f64, f64)> = curve(liver.force_n.clone(), &times).into_iter().step_by(3).collect();
    let mut figure = Figure::new("The liver under the ball", Axis::new("time since touch (s)"), Axis::new("force (N)"))
        .with(Series::new("measured", measured, Stroke::Circles, 0));
    for (label, x, stroke, colour) in [("script", end, Stroke::Solid, 1), ("truth", &LIVER[..], Stroke::Dashed, 2)] {
        if let Some(forces) = liver.forces_at(x) {
            figure = figure.with(Series::new(label, curve(forces, &times), stroke, colour));
        }
    }
    Picture {
        file: "study-script-force".to_owned(),
        svg: figure.svg(),
        caption: "Simulated recording (every third sample), the force of the script's end, and that of the truth on the mesh of the evaluations.".to_owned(),
    }
}
