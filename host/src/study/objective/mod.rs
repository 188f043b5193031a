//! The valley of Eq. 14 and the ways down it: one term over mu and alpha (thesis Fig. 9), two terms over four parameters (Fig. 10), Poisson's ratio and
//! friction on the way (Fig. 13), with what Gauss-Newton makes of the same data.

mod pictures;

use lut_gen::model::Resolution;
use serde_json::{Value, json};

use crate::experiment::replicate;
use crate::identify::data::Selection;
use crate::identify::fe::{ModelError, Progress};
use crate::identify::multistart::{self, Effort, STARTS, Search};
use crate::identify::newton::condition::{Condition, Source};
use crate::identify::newton::coordinate::Kind;
use crate::identify::newton::fit::{Demand, Newton, fit};
use crate::identify::newton::setup;
use crate::identify::spec::{Extra, FitSpec};
use crate::report::number;

use super::findings::{Findings, Table};
use super::subject::of_balls;
use super::{StudyError, Subject};

/// What is mapped.
#[derive(Debug, Clone, PartialEq)]
pub struct Asked {
    /// Terms of the foam, 1 or 2.
    pub terms: usize,
    /// Free besides: Poisson's ratio, friction.
    pub free: Vec<Extra>,
    /// Most simplex searches a map.
    pub starts: usize,
    /// Most finite-element solves a map, and again for Gauss-Newton beside it.
    pub most_solves: usize,
}

impl Default for Asked {
    fn default() -> Self {
        Self { terms: 1, free: Vec::new(), starts: STARTS, most_solves: 400 }
    }
}

/// The map of one choice of balls.
#[derive(Debug, Clone)]
pub struct Panel {
    /// Which balls.
    pub balls: String,
    /// Map, threshold, starts and their paths.
    pub search: Search,
    /// Its finite-element solves.
    pub solves: usize,
    /// Gauss-Newton on the same data.
    pub newton: Newton,
    /// Finite-element solves of that.
    pub newton_solves: usize,
}

/// Maps each ball alone, and all together.
///
/// # Errors
/// Data that cannot be used, or a failing solve.
pub fn panels(subject: &Subject, asked: &Asked, progress: &Progress<'_>) -> Result<Vec<Panel>, StudyError> {
    let selection = subject.foam_selection("objective", true)?;
    let balls = subject.balls(&selection);
    let mut choices: Vec<(String, Vec<usize>)> =
        balls.iter().map(|&ball| (subject.ball_name(ball), vec![ball])).collect();
    if balls.len() > 1 {
        let all = if balls.len() == 2 { "both balls" } else { "all balls" };
        choices.push((all.to_owned(), balls.clone()));
    }
    choices
        .into_iter()
        .map(|(name, chosen)| panel(subject, name, &of_balls(&selection, &chosen), asked, progress))
        .collect()
}

fn panel(
    subject: &Subject,
    balls: String,
    selection: &Selection,
    asked: &Asked,
    progress: &Progress<'_>,
) -> Result<Panel, StudyError> {
    let spec = FitSpec { terms: Some(asked.terms), free: asked.free.clone(), ..FitSpec::default() };
    let source = |_: &Condition| Source::Solves(Resolution::Standard);
    let failed = |cause| ModelError::Solve { what: subject.material.clone(), cause };
    let mut problem = setup::problem(&subject.experiment, selection, &subject.material, &spec, &source);
    let told = |solves: usize| progress(&format!("MultiStart, {balls}"), solves, 0);
    let effort = Effort { most_solves: asked.most_solves, starts: asked.starts };
    let search = multistart::search(&mut problem, effort, &told).map_err(failed)?;
    let solves = problem.solves();
    if search.starts.is_empty() {
        let reason = "no material pushes back like these data";
        return Err(StudyError::NothingToFit { material: subject.material.clone(), reason });
    }
    let mut problem = setup::problem(&subject.experiment, selection, &subject.material, &spec, &source);
    let told = |solves: usize| progress(&format!("Gauss-Newton, {balls}"), solves, 0);
    let groups = replicate::groups(&subject.experiment, &subject.motions);
    let demand = Demand {
        groups: &groups,
        stated_n: subject.experiment.sensor.noise_n,
        most_solves: asked.most_solves,
        until: None,
        told: &told,
    };
    let newton = fit(&mut problem, &demand).map_err(failed)?;
    Ok(Panel { balls, search, solves, newton, newton_solves: problem.solves() })
}

impl Panel {
    /// Best end of MultiStart, in the search's coordinates.
    #[must_use]
    pub fn best(&self) -> &[f64] {
        self.search.starts.first().map_or(&[], |start| &start.descent.point)
    }

    /// Distance between MultiStart's and Gauss-Newton's optimum in standard errors, parameter by parameter.
    #[must_use]
    pub fn apart(&self) -> Vec<f64> {
        let ends = self.best().iter().zip(&self.newton.minimum.x);
        ends.zip(&self.newton.errors).map(|((a, b), error)| (a - b).abs() / error).collect()
    }

    /// The largest of these.
    #[must_use]
    pub fn farthest(&self) -> f64 {
        self.apart().into_iter().fold(0.0, f64::max)
    }

    /// Ends that are the best one, and all.
    fn agreeing(&self) -> (usize, usize) {
        let starts = &self.search.starts;
        let best = starts.first().map_or(0.0, |start| start.descent.value);
        (starts.iter().filter(|start| start.descent.value <= best * (1.0 + ONE_END)).count(), starts.len())
    }

    fn rows(&self) -> Vec<Vec<String>> {
        let (agreeing, starts) = self.agreeing();
        let apart = self.apart();
        let one = |(axis, unknown): (usize, &crate::identify::newton::coordinate::Unknown)| {
            let x = self.newton.minimum.x[axis];
            let first = axis == 0;
            let once = |text: String| if first { text } else { String::new() };
            let error = if unknown.is_logarithmic() {
                format!("{} %", number(100.0 * self.newton.errors[axis]))
            } else {
                number(self.newton.errors[axis])
            };
            vec![
                once(self.balls.clone()),
                once(format!("{agreeing} of {starts}")),
                once(self.search.evaluations().to_string()),
                once(self.solves.to_string()),
                unknown.name.clone(),
                number(unknown.value(self.best()[axis])),
                number(unknown.value(x)),
                error,
                number(apart[axis]),
                once(self.newton_solves.to_string()),
            ]
        };
        self.search.unknowns.iter().enumerate().map(one).collect()
    }

    fn json(&self) -> Value {
        let named = |point: &[f64]| -> Value {
            self.search.named(point).map(|(name, value)| (name.to_owned(), json!(value))).collect()
        };
        let starts: Vec<Value> = self
            .search
            .starts
            .iter()
            .map(|start| {
                let descent = &start.descent;
                json!({
                    "path": descent.path.iter().map(|p| named(p)).collect::<Vec<_>>(),
                    "evaluations_along": descent.counts,
                    "end": named(&descent.point),
                    "objective_N": descent.value,
                    "evaluations": descent.evaluations,
                    "at_rest": start.at_rest,
                })
            })
            .collect();
        let sample = &self.search.sample;
        json!({
            "balls": self.balls,
            "map": {
                "points": sample.iter().map(|s| named(&s.point)).collect::<Vec<_>>(),
                "objective_N": sample.iter().map(|s| s.objective_n).collect::<Vec<_>>(),
            },
            "threshold_N": self.search.threshold_n,
            "starts": starts,
            "converged": self.search.converged(),
            "best": named(self.best()),
            "fe_solves": self.solves,
            "messages": self.search.messages(),
            "gauss_newton": {
                "end": named(&self.newton.minimum.x),
                "converged": self.newton.converged,
                "fe_solves": self.newton_solves,
                "path": self.newton.path.iter().map(|visit| named(&visit.point)).collect::<Vec<_>>(),
                "standard_errors_from_multistart": self.farthest(),
                "verdicts": self.newton.verdicts.iter().map(|v| v.sentence.clone()).collect::<Vec<_>>(),
            },
        })
    }

    fn sentence(&self) -> String {
        let (agreeing, starts) = self.agreeing();
        let ends = if agreeing == starts {
            format!("all {starts} starts end at one value of the objective")
        } else {
            format!("{agreeing} of {starts} starts end at the best value of the objective")
        };
        let found: Vec<String> =
            self.search.named(self.best()).map(|(name, value)| format!("{name} {}", number(value))).collect();
        let rest = if self.search.converged() { "" } else { " (not at rest)" };
        format!(
            "{}: {ends}{rest}, {} after {} solves; Gauss-Newton ends {} standard errors from it after {} solves",
            self.balls,
            found.join(", "),
            self.solves,
            number(self.farthest()),
            self.newton_solves
        )
    }

    /// What can be said of Poisson's ratio or friction, where it was free.
    fn verdict_of(&self, kind: Kind) -> Option<String> {
        let axis = self.search.unknowns.iter().position(|unknown| unknown.kind == kind)?;
        let (unknown, span) = (&self.search.unknowns[axis], &self.newton.spans[axis]);
        Some(format!(
            "{}: the simplex ends at {} {}; the 95 % interval of the same data is {} to {}: {}",
            self.balls,
            unknown.name,
            number(unknown.value(self.best()[axis])),
            number(unknown.value(span.low)),
            number(unknown.value(span.high)),
            self.newton.verdicts.get(axis).map_or("", |verdict| &verdict.sentence)
        ))
    }
}

/// Ends within this share of the best objective are one end.
const ONE_END: f64 = 1e-3;

/// The study.
///
/// # Errors
/// As [`panels`].
pub fn study(subject: &Subject, asked: &Asked, progress: &Progress<'_>) -> Result<Findings, StudyError> {
    let panels = panels(subject, asked, progress)?;
    let mut table = Table::new(&[
        "balls",
        "at the best",
        "evaluations",
        "solves",
        "parameter",
        "MultiStart",
        "Gauss-Newton",
        "standard error",
        "apart (errors)",
        "its solves",
    ]);
    table.rows = panels.iter().flat_map(Panel::rows).collect();
    let mut answer: Vec<String> = panels.iter().map(Panel::sentence).collect();
    for kind in [Kind::Nu, Kind::Friction] {
        answer.extend(panels.iter().filter_map(|panel| panel.verdict_of(kind)));
    }
    Ok(Findings {
        study: "objective",
        title: "The objective and the ways down it".to_owned(),
        subject: subject.sentence(),
        method: how(asked),
        answer,
        tables: vec![table],
        pictures: pictures::pictures(subject, asked, &panels),
        json: [
            ("panels".to_owned(), json!(panels.iter().map(Panel::json).collect::<Vec<_>>())),
            ("fe_solves_of_multistart".to_owned(), json!(panels.iter().map(|p| p.solves).sum::<usize>())),
        ]
        .into_iter()
        .collect(),
    })
}

fn how(asked: &Asked) -> Vec<String> {
    vec![
        "MultiStart as in thesis section 2.8: Eq. 14 (absolute differences, contact points at their best) on a map of the parameters, starts below a threshold, a simplex from each. \
         The map is a grid for one or two parameters besides the modulus, else a space-filling sample."
            .to_owned(),
        "Each point of the map is one finite-element solve a ball with its slopes, for all moduli. A simplex runs between the solves on their values and slopes; where it ends is solved, and it is restarted there until it comes back."
            .to_owned(),
        format!("At most {} starts and {} solves a map.", asked.starts, asked.most_solves),
        "Gauss-Newton weighs runs by their noise and counts far differences less, so that its optimum is another estimate from the same data; it needs no start from the user.".to_owned(),
    ]
}
