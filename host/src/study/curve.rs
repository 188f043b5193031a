//! Measured against predicted force with what is left over (thesis Figs. 12, 14): fitted to all balls, and predicted for each ball from
//! the others alone.

use lut_gen::solid::model::Resolution;
use serde_json::{Value, json};

use crate::identify::fe::Progress;
use crate::identify::fit::RunFit;
use crate::identify::newton::condition::{Condition, Source};
use crate::identify::spec::FitSpec;
use crate::identify::{Identification, identify_from};
use crate::report::figure::{Axis, Figure, Series, Stroke};
use crate::report::number;

use super::findings::{Findings, Picture, Table};
use super::{StudyError, Subject};

/// Most circles drawn a run.
const DRAWN: usize = 90;

/// One run beside its curves.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Name of the run.
    pub run: String,
    /// Index of its ball.
    pub ball: usize,
    /// Depth past the fitted contact point in mm, or time since the peak in s where holds are fitted.
    pub place: Vec<f64>,
    /// Measured force, N.
    pub measured_n: Vec<f64>,
    /// Fitted to all balls, N.
    pub fitted_n: Vec<f64>,
    /// Predicted from the other balls, N; empty when there is one ball.
    pub predicted_n: Vec<f64>,
}

fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (count, sum) = values.fold((0.0_f64, 0.0), |(count, sum), value| (count + 1.0, sum + value * value));
    (sum / count.max(1.0)).sqrt()
}

impl Curve {
    fn peak_n(&self) -> f64 {
        self.measured_n.iter().copied().fold(f64::MIN_POSITIVE, f64::max)
    }

    fn left<'a>(&'a self, model_n: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        self.measured_n.iter().zip(model_n).map(|(measured, model)| measured - model)
    }
}

/// Fits all balls together, and all but each.
///
/// # Errors
/// Data that cannot be used, or a failing solve.
pub fn curves(
    subject: &Subject,
    relaxation: usize,
    progress: &Progress<'_>,
) -> Result<(Vec<Curve>, Identification), StudyError> {
    let selection = subject.selection()?;
    let spec = FitSpec { relaxation, ..FitSpec::default() };
    let source = |_: &Condition| Source::Solves(Resolution::Standard);
    progress("fit to all balls", 0, 0);
    let whole = identify_from(&subject.experiment, &subject.material, &spec, &source)?;
    let Some(fit) = whole.fit.as_ref() else {
        return Err(StudyError::NothingToFit { material: subject.material.clone(), reason: whole.outcome.word() });
    };
    let mut curves: Vec<Curve> =
        fit.runs.iter().filter_map(|run| curve(subject, &whole, run, relaxation > 0)).collect();
    let balls = subject.balls(&selection);
    for &ball in balls.iter().filter(|_| balls.len() > 1) {
        progress(&format!("prediction, {}", subject.ball_name(ball)), 0, 0);
        let mut experiment = subject.experiment.clone();
        experiment.runs.iter_mut().for_each(|run| run.hold_out |= run.indenter == Some(ball));
        let others = identify_from(&experiment, &subject.material, &spec, &source)?;
        for run in others.fit.iter().flat_map(|fit| &fit.runs) {
            let data = &others.selection.curves[run.curve];
            let name = &experiment.runs[data.run].file;
            if let Some(own) = curves.iter_mut().find(|curve| curve.ball == ball && curve.run == *name) {
                own.predicted_n.clone_from(&run.model_n);
            }
        }
    }
    Ok((curves, whole))
}

/// `None` for a run without a ball.
fn curve(subject: &Subject, whole: &Identification, run: &RunFit, over_time: bool) -> Option<Curve> {
    let data = &whole.selection.curves[run.curve];
    let place = if over_time {
        data.time_s.clone()
    } else {
        data.depth_mm.iter().map(|depth| depth - run.contact_mm).collect()
    };
    Some(Curve {
        run: subject.experiment.runs[data.run].file.clone(),
        ball: whole.selection.pairings[data.pairing].grip.indenter()?,
        place,
        measured_n: data.force_n.clone(),
        fitted_n: run.model_n.clone(),
        predicted_n: Vec::new(),
    })
}

/// The study.
///
/// # Errors
/// As [`curves`].
pub fn study(subject: &Subject, relaxation: usize, progress: &Progress<'_>) -> Result<Findings, StudyError> {
    let (curves, whole) = curves(subject, relaxation, progress)?;
    let mut table =
        Table::new(&["run", "peak (N)", "left over, rms (N)", "of peak (%)", "predicted, rms (N)", "of its peak (%)"]);
    table.rows = curves.iter().map(row).collect();
    let parameters = whole.fit.iter().flat_map(|fit| &fit.parameters);
    let mut answer: Vec<String> = parameters
        .map(|p| {
            format!(
                "{} {} (95 %: {} to {})",
                p.name,
                number(p.value),
                number(p.interval95.low),
                number(p.interval95.high)
            )
        })
        .collect();
    answer.extend(verdict(&curves));
    Ok(Findings {
        study: "curve",
        title: "Measured against predicted".to_owned(),
        subject: subject.sentence(),
        method: vec![
            format!("Fitted: Gauss-Newton to all balls together, {} finite-element solves.", whole.fe_solves),
            "Predicted: parameters from the other balls alone; only the contact point is this run's own.".to_owned(),
        ],
        answer,
        tables: vec![table],
        pictures: pictures(subject, &curves, relaxation > 0),
        json: [
            ("runs".to_owned(), curves.iter().map(of_json).collect()),
            ("fe_solves".to_owned(), json!(whole.fe_solves)),
        ]
        .into_iter()
        .collect(),
    })
}

fn verdict(curves: &[Curve]) -> Option<String> {
    let worst = |of: &dyn Fn(&Curve) -> f64| curves.iter().map(of).fold(0.0, f64::max);
    let fitted = worst(&|curve| rms(curve.left(&curve.fitted_n)) / curve.peak_n());
    let predicted = worst(&|curve| rms(curve.left(&curve.predicted_n)) / curve.peak_n());
    (!curves.is_empty()).then(|| {
        let across = if curves.iter().any(|curve| !curve.predicted_n.is_empty()) {
            format!("; predicted from the other balls at most {} %", number(100.0 * predicted))
        } else {
            String::new()
        };
        format!("what is left over of a run is at most {} % of its peak (rms){across}", number(100.0 * fitted))
    })
}

fn row(curve: &Curve) -> Vec<String> {
    let both = |model: &[f64]| {
        let left = rms(curve.left(model));
        if model.is_empty() {
            [String::new(), String::new()]
        } else {
            [left, 100.0 * left / curve.peak_n()].map(number)
        }
    };
    let mut row = vec![curve.run.clone(), number(curve.peak_n())];
    row.extend(both(&curve.fitted_n));
    row.extend(both(&curve.predicted_n));
    row
}

fn of_json(curve: &Curve) -> Value {
    json!({
        "run": curve.run,
        "peak_N": curve.peak_n(),
        "rms_N": rms(curve.left(&curve.fitted_n)),
        "predicted_rms_N": (!curve.predicted_n.is_empty()).then(|| rms(curve.left(&curve.predicted_n))),
        "place": curve.place,
        "measured_N": curve.measured_n,
        "fitted_N": curve.fitted_n,
        "predicted_N": curve.predicted_n,
    })
}

fn pictures(subject: &Subject, curves: &[Curve], over_time: bool) -> Vec<Picture> {
    let x = || Axis::new(if over_time { "time since the peak (s)" } else { "depth past contact (mm)" });
    let mut forces = Figure::new("Measured and predicted force", x(), Axis::new("force (N)"));
    let mut left = Figure::new("Measured minus fitted", x(), Axis::new("force (% of the run's peak)"));
    left.size.1 = 280.0;
    let mut named: Vec<usize> = Vec::new();
    for curve in curves {
        // Runs that repeat each other share colour and name.
        let new = !named.contains(&curve.ball);
        if new {
            named.push(curve.ball);
        }
        let colour = named.iter().position(|ball| *ball == curve.ball).unwrap_or(0);
        let name = |what: &str| if new { format!("{}{what}", subject.ball_name(curve.ball)) } else { String::new() };
        let over =
            |values: &[f64]| -> Vec<(f64, f64)> { curve.place.iter().copied().zip(values.iter().copied()).collect() };
        let every = curve.place.len().div_ceil(DRAWN).max(1);
        let circles = over(&curve.measured_n).into_iter().step_by(every).collect();
        let share = |difference: f64| 100.0 * difference / curve.peak_n();
        let scatter: Vec<f64> = curve.left(&curve.fitted_n).map(share).collect();
        forces = forces.with(Series::new("", circles, Stroke::Circles, colour)).with(Series::new(
            &name(""),
            over(&curve.fitted_n),
            Stroke::Solid,
            colour,
        ));
        left = left.with(Series::new(&name(""), over(&scatter), Stroke::Circles, colour));
        if !curve.predicted_n.is_empty() {
            let between = curve.predicted_n.iter().zip(&curve.fitted_n).map(|(p, f)| share(p - f)).collect::<Vec<_>>();
            forces = forces.with(Series::new(&name(", others"), over(&curve.predicted_n), Stroke::Dashed, colour));
            left = left.with(Series::new(&name(", others"), over(&between), Stroke::Dashed, colour));
        }
    }
    let caption = "Circles: measured; solid: fitted to all balls; dashed: predicted from the other balls alone.";
    vec![
        Picture { file: "study-curve-force".to_owned(), svg: forces.svg(), caption: caption.to_owned() },
        Picture {
            file: "study-curve-residual".to_owned(),
            svg: left.svg(),
            caption: "Circles: what the fit leaves over; circles that wave instead of scattering are misfit, not noise. Dashed: the prediction from the other balls minus the fit.".to_owned(),
        },
    ]
}
