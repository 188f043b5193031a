//! Parameters against the depth they were identified from, for each ball, and where the balls' trends meet (thesis section 2.9, Fig. 11).

use lut_gen::model::ForceModel;
use serde_json::{Value, json};

use crate::experiment::{Experiment, motion};
use crate::identify::data::{Height, Selection};
use crate::identify::fe::{FeModel, Progress};
use crate::identify::fit::{Fit, Parameter};
use crate::identify::model::ForwardModel;
use crate::identify::newton::condition::{Condition, Source};
use crate::identify::spec::FitSpec;
use crate::identify::{Identification, identify_from};
use crate::report::number;

use super::findings::{Findings, Table};
use super::trend::{self, Meeting, Sensitivity};
use super::{StudyError, Subject};

mod picture;

/// Depths, as shares of the least of the balls' largest depths.
const SHARES: [f64; 7] = [0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1.0];
/// A contact point taken this much too early (mm) is one sample and a half at 1 mm/s and 50 Hz.
pub const EARLY_MM: f64 = 0.03;
/// A meeting point whose interval of alpha is this many times longer than the joint fit's is called poorly known.
const VAGUE: f64 = 2.0;
/// Draws behind the interval of the meeting point.
const DRAWS: usize = 1000;

/// What was identified from the runs of one ball down to one depth.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// Depth past the guessed contact, mm.
    pub depth_mm: f64,
    /// mu in MPa, alpha.
    pub value: [f64; 2],
    /// Their 95 % intervals.
    pub interval: [(f64, f64); 2],
    /// The same with every contact point held [`EARLY_MM`] before its best.
    pub early: [f64; 2],
}

/// All depths of one ball.
#[derive(Debug, Clone, PartialEq)]
pub struct Ball {
    /// "ball of 4 mm".
    pub name: String,
    /// Shallow to deep.
    pub points: Vec<Point>,
}

/// What the study found.
#[derive(Debug, Clone, PartialEq)]
pub struct Depths {
    /// Balls, smallest first.
    pub balls: Vec<Ball>,
    /// Where the trends of the first two meet, if they do.
    pub meeting: Option<Meeting>,
    /// The same with early contact points.
    pub early_meeting: Option<[f64; 2]>,
    /// All balls at their full depths together: mu in MPa and alpha, each with the ends of its 95 % interval.
    pub joint: Option<[(f64, f64, f64); 2]>,
    /// Finite-element solves.
    pub solves: usize,
}

/// The force model of a condition's specimen and ball.
fn model_of<'a>(model: &'a FeModel, selection: &Selection, specimen: usize, indenter: usize) -> Option<&'a ForceModel> {
    let same = |p: &crate::identify::data::Pairing| p.specimen == specimen && p.indenter == indenter;
    selection.pairings.iter().position(same).map(|at| model.force_model(at))
}

/// Runs of one ball alone, each cut where it passes a depth below its guessed contact.
fn cut(subject: &Subject, selection: &Selection, ball: usize, depth_mm: f64) -> Experiment {
    let mut experiment = subject.experiment.clone();
    let mut runs = Vec::new();
    for curve in selection.curves.iter().filter(|c| selection.pairings[c.pairing].indenter == ball && !c.hold_out) {
        let mut run = experiment.runs[curve.run].clone();
        let end = curve.contact.contact_mm + depth_mm;
        let recording = &run.recording;
        let from = motion::of(recording).map_or(0, |motion| motion.loading.start);
        let past = recording.depth_mm.iter().skip(from).position(|depth| *depth > end);
        let to = past.map_or(recording.depth_mm.len(), |at| from + at);
        let part = |values: &[f64]| values[..to].to_vec();
        run.recording = crate::experiment::Recording::from_samples(
            part(&recording.time_s),
            part(&recording.depth_mm),
            part(&recording.force_n),
        );
        runs.push(run);
    }
    experiment.runs = runs;
    experiment
}

fn parameter<'a>(fit: &'a Fit, name: &str) -> Option<&'a Parameter> {
    fit.parameters.iter().find(|parameter| parameter.name == name)
}

/// Identifies from every ball and depth.
///
/// # Errors
/// Data that cannot be used, or a failing solve.
pub fn depths(subject: &Subject, seed: u64, progress: &Progress<'_>) -> Result<Depths, StudyError> {
    let selection = subject.foam_selection("depth")?;
    let model = FeModel::build(&subject.experiment, &selection, progress)?;
    let balls = subject.balls(&selection);
    let reach = |ball: &usize| {
        let of_ball = selection.curves.iter().filter(|c| selection.pairings[c.pairing].indenter == *ball);
        let deepest = of_ball.map(|c| c.depth_mm.iter().copied().fold(0.0, f64::max) - c.contact.contact_mm);
        deepest.fold(f64::INFINITY, f64::min)
    };
    let largest_mm = balls.iter().map(reach).fold(f64::INFINITY, f64::min);
    let source = |c: &Condition| match model_of(&model, &selection, c.specimen, c.indenter) {
        Some(model) => Source::Model(Box::new(model.clone())),
        None => Source::Solves(lut_gen::model::Resolution::Standard),
    };
    let spec = FitSpec { terms: Some(1), ..FitSpec::default() };
    let mut found = Vec::new();
    let mut sensitivities = Vec::new();
    for (at, &ball) in balls.iter().enumerate() {
        let mut points = Vec::new();
        let mut deepest = None;
        for (step, share) in SHARES.into_iter().enumerate() {
            progress("depths", at * SHARES.len() + step, balls.len() * SHARES.len());
            let depth_mm = share * largest_mm;
            let experiment = cut(subject, &selection, ball, depth_mm);
            let identified = identify_from(&experiment, &subject.material, &spec, &source)?;
            if let Some(point) = point(&identified, &model, &selection, ball, depth_mm) {
                points.push(point);
            }
            deepest = Some(identified);
        }
        let name = subject.ball_name(ball);
        if let Some(sensitivity) = deepest.and_then(|one| sensitivity(&one, &model, &selection, ball)) {
            sensitivities.push(sensitivity);
        }
        found.push(Ball { name, points });
    }
    progress("depths", balls.len() * SHARES.len(), balls.len() * SHARES.len());
    let (meeting, early_meeting) = meetings(&found, &sensitivities, seed);
    let together = identify_from(&subject.experiment, &subject.material, &spec, &source)?;
    let shown = |p: &Parameter| (p.value, p.interval95.low, p.interval95.high);
    let both = |fit: &Fit| Some([shown(parameter(fit, "mu_MPa")?), shown(parameter(fit, "alpha")?)]);
    let joint = together.fit.as_ref().and_then(both);
    Ok(Depths { balls: found, meeting, early_meeting, joint, solves: model.solves() })
}

/// Logarithms of alpha and mu of a ball's points.
fn logarithms(ball: &Ball, of: &dyn Fn(&Point) -> [f64; 2]) -> Vec<[f64; 2]> {
    ball.points.iter().map(|point| of(point)).map(|[mu, alpha]| [alpha.ln(), mu.ln()]).collect()
}

fn meetings(balls: &[Ball], sensitivities: &[Sensitivity], seed: u64) -> (Option<Meeting>, Option<[f64; 2]>) {
    let ([first, second, ..], [of_first, of_second, ..]) = (balls, sensitivities) else { return (None, None) };
    let depths = |ball: &Ball| ball.points.iter().map(|point| point.depth_mm).collect::<Vec<f64>>();
    let value = |ball: &Ball| logarithms(ball, &|point| point.value);
    let early = |ball: &Ball| logarithms(ball, &|point| point.early);
    let pair = [(value(first), depths(first), of_first), (value(second), depths(second), of_second)];
    let shown = |[alpha, mu]: [f64; 2]| [mu.exp(), alpha.exp()];
    (trend::meeting(&pair, DRAWS, seed), trend::crossing(&early(first), &early(second)).map(shown))
}

fn point(
    identified: &Identification,
    model: &FeModel,
    selection: &Selection,
    ball: usize,
    depth_mm: f64,
) -> Option<Point> {
    let fit = identified.fit.as_ref()?;
    let (mu, alpha) = (parameter(fit, "mu_MPa")?, parameter(fit, "alpha")?);
    let interval = |p: &Parameter| (p.interval95.low, p.interval95.high);
    let start = [mu.value.ln(), alpha.value.ln()];
    let runs = runs_of(identified, model, selection, ball);
    let early = trend::with_contacts_held(&runs, start, -EARLY_MM);
    Some(Point {
        depth_mm,
        value: [mu.value, alpha.value],
        interval: [interval(mu), interval(alpha)],
        early: early.map(f64::exp),
    })
}

/// The fitted runs of an identification with their force models and fitted contact points.
fn runs_of<'a>(
    identified: &'a Identification,
    model: &'a FeModel,
    selection: &Selection,
    ball: usize,
) -> Vec<trend::Run<'a>> {
    let Some(fit) = identified.fit.as_ref() else { return Vec::new() };
    let own = &identified.selection;
    let runs = fit.runs.iter().filter_map(|run| {
        let data = &own.curves[run.curve];
        let pairing = &own.pairings[data.pairing];
        let model = model_of(model, selection, pairing.specimen, ball)?;
        let height_mm = match pairing.height {
            Height::Known(mm) => mm,
            Height::Free(_) => return None,
        };
        let noise = fit.newton.as_ref().map(|newton| newton.noises[run.curve]);
        let sigma_n = noise.map_or(fit.noise.sigma_n, |noise| noise.sigma_n * noise.correlated_samples.sqrt());
        Some(trend::Run { data, model, height_mm, contact_mm: run.contact_mm, sigma_n })
    });
    runs.collect()
}

fn sensitivity(
    identified: &Identification,
    model: &FeModel,
    selection: &Selection,
    ball: usize,
) -> Option<Sensitivity> {
    let fit = identified.fit.as_ref()?;
    let (mu, alpha) = (parameter(fit, "mu_MPa")?.value, parameter(fit, "alpha")?.value);
    Some(Sensitivity::of(&runs_of(identified, model, selection, ball), mu, alpha))
}

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
