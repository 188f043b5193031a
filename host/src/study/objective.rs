//! The valley of Eq. 14 over mu and alpha, with the ways of all starts of MultiStart and of Gauss-Newton (thesis Figs. 9, 10, 13).

use lut_gen::model::Resolution;
use serde_json::{Value, json};

use crate::experiment::replicate;
use crate::identify::data::Selection;
use crate::identify::fe::{FeModel, ModelError, Progress};
use crate::identify::interval;
use crate::identify::model::ForwardModel;
use crate::identify::multistart::{self, Search};
use crate::identify::newton::condition::{Condition, Source};
use crate::identify::newton::coordinate::{Kind, Unknown};
use crate::identify::newton::fit::{Demand, fit};
use crate::identify::newton::setup;
use crate::identify::objective::{ALPHA, LN_MU, Objective};
use crate::identify::simplex::Descent;
use crate::identify::spec::FitSpec;
use crate::report::map::{self, Overlay};
use crate::report::number;

use super::findings::{Findings, Picture, Table};
use super::subject::of_balls;
use super::{StudyError, Subject};

/// Most finite-element solves of one Gauss-Newton path.
const MOST_SOLVES: usize = 400;

/// The map of one choice of balls.
#[derive(Debug, Clone)]
pub struct Panel {
    /// Which balls.
    pub balls: String,
    /// Grid, threshold, starts and their paths.
    pub search: Search,
    /// Points that Gauss-Newton solved, `(alpha, mu in MPa)`, in order.
    pub newton: Vec<(f64, f64)>,
    /// Where it ended: alpha, mu in MPa.
    pub newton_end: (f64, f64),
    /// Standard errors of ln alpha and ln mu there.
    pub newton_errors: (f64, f64),
    /// Finite-element solves of that path.
    pub newton_solves: usize,
    /// Evaluations of all simplex searches and of the grid.
    pub evaluations: usize,
}

/// Maps each ball alone, and all together.
///
/// # Errors
/// Data that cannot be used, or a failing solve.
pub fn panels(subject: &Subject, progress: &Progress<'_>) -> Result<(Vec<Panel>, usize), StudyError> {
    let selection = subject.foam_selection("objective", true)?;
    let model = FeModel::build(&subject.experiment, &selection, progress)?;
    let balls = subject.balls(&selection);
    let mut choices: Vec<(String, Vec<usize>)> =
        balls.iter().map(|&ball| (subject.ball_name(ball), vec![ball])).collect();
    if balls.len() > 1 {
        let all = if balls.len() == 2 { "both balls" } else { "all balls" };
        choices.push((all.to_owned(), balls.clone()));
    }
    let mut panels = Vec::new();
    for (name, chosen) in choices {
        panels.push(panel(subject, name, &of_balls(&selection, &chosen), &model, progress)?);
    }
    Ok((panels, model.solves()))
}

fn panel(
    subject: &Subject,
    balls: String,
    selection: &Selection,
    model: &FeModel,
    progress: &Progress<'_>,
) -> Result<Panel, StudyError> {
    let objective = Objective { selection, model };
    let search = multistart::search(&objective).ok_or_else(|| StudyError::NothingToFit {
        material: subject.material.clone(),
        reason: "no material pushes back like these data",
    })?;
    let spec = FitSpec { law: None, terms: Some(1), ..FitSpec::default() };
    let source = |_: &Condition| Source::Solves(Resolution::Standard);
    let mut problem = setup::problem(&subject.experiment, selection, &subject.material, &spec, &source);
    let told = |solves: usize| progress(&format!("Gauss-Newton, {balls}"), solves, 0);
    let groups = replicate::groups(&subject.experiment, &subject.motions);
    let demand = Demand {
        groups: &groups,
        stated_n: subject.experiment.sensor.noise_n,
        most_solves: MOST_SOLVES,
        until: None,
        told: &told,
    };
    let newton =
        fit(&mut problem, &demand).map_err(|cause| ModelError::Solve { what: subject.material.clone(), cause })?;
    let place = |kind: Kind| problem.unknowns.iter().position(|u: &Unknown| u.kind == kind).unwrap_or(0);
    let (alpha, mu) = (place(Kind::Alpha(0)), place(Kind::Modulus));
    let shown = |x: &[f64]| (problem.unknowns[alpha].value(x[alpha]), problem.unknowns[mu].value(x[mu]));
    let grid = search.map.alpha.len() * search.map.mu_mpa.len();
    Ok(Panel {
        balls,
        newton: newton.path.iter().map(|visit| shown(&visit.point)).collect(),
        newton_end: shown(&newton.minimum.x),
        newton_errors: (newton.errors[alpha], newton.errors[mu]),
        newton_solves: problem.solves(),
        evaluations: grid + search.descents.iter().map(|descent| descent.evaluations).sum::<usize>(),
        search,
    })
}

impl Panel {
    /// Best end of MultiStart: alpha, mu in MPa.
    #[must_use]
    pub fn best(&self) -> (f64, f64) {
        self.search.descents.first().map_or((f64::NAN, f64::NAN), |d| (d.point[ALPHA], d.point[LN_MU].exp()))
    }

    /// Distance between MultiStart's and Gauss-Newton's optimum in standard errors, the larger of both parameters'.
    #[must_use]
    pub fn apart(&self) -> f64 {
        let (best, end, errors) = (self.best(), self.newton_end, self.newton_errors);
        ((best.0 / end.0).ln().abs() / errors.0).max((best.1 / end.1).ln().abs() / errors.1)
    }

    fn row(&self) -> Vec<String> {
        let best = self.best();
        vec![
            self.balls.clone(),
            self.search.descents.len().to_string(),
            self.evaluations.to_string(),
            number(best.1),
            number(best.0),
            number(100.0 * self.newton_errors.1),
            number(100.0 * self.newton_errors.0),
            self.newton_solves.to_string(),
            number(self.apart()),
        ]
    }

    fn json(&self) -> Value {
        let pair = |point: &[f64]| json!([point[LN_MU].exp(), point[ALPHA]]);
        let starts: Vec<Value> = self
            .search
            .descents
            .iter()
            .map(|descent| {
                json!({
                    "path_mu_MPa_alpha": descent.path.iter().map(|p| pair(p)).collect::<Vec<_>>(),
                    "objective_N": descent.value,
                    "evaluations": descent.evaluations,
                })
            })
            .collect();
        let best = self.best();
        json!({
            "balls": self.balls,
            "grid": {"alpha": self.search.map.alpha, "mu_MPa": self.search.map.mu_mpa, "objective_N": self.search.map.value},
            "threshold_N": self.search.map.threshold,
            "starts": starts,
            "best": {"mu_MPa": best.1, "alpha": best.0},
            "gauss_newton": {
                "mu_MPa": self.newton_end.1,
                "alpha": self.newton_end.0,
                "fe_solves": self.newton_solves,
                "path_mu_MPa_alpha": self.newton.iter().map(|p| [p.1, p.0]).collect::<Vec<_>>(),
                "standard_errors_from_multistart": self.apart(),
            },
        })
    }
}

/// The study.
///
/// # Errors
/// As [`panels`].
pub fn study(subject: &Subject, progress: &Progress<'_>) -> Result<Findings, StudyError> {
    let (panels, solves) = panels(subject, progress)?;
    let mut table = Table::new(&[
        "balls",
        "starts",
        "evaluations",
        "mu (MPa)",
        "alpha",
        "error of mu (%)",
        "of alpha (%)",
        "Gauss-Newton: solves",
        "apart (errors)",
    ]);
    table.rows = panels.iter().map(Panel::row).collect();
    let truth = subject.foam.as_ref().map(|foam| (foam.alpha, foam.mu_mpa));
    let pictures = panels.iter().enumerate().map(|(at, panel)| {
        let overlay = Overlay { newton: &panel.newton, truth };
        Picture {
            file: format!("study-objective-{}", at + 1),
            svg: map::svg_over(&format!("Eq. 14 over alpha and mu: {}", panel.balls), &panel.search, &overlay),
            caption: format!(
                "{}: dark is good. {} starts below the threshold, their simplex paths (thin; the best one solid), and the points that Gauss-Newton solved (orange).",
                panel.balls,
                panel.search.descents.len()
            ),
        }
    });
    Ok(Findings {
        study: "objective",
        title: "The objective over mu and alpha".to_owned(),
        subject: subject.sentence(),
        method: vec![
            "MultiStart as in thesis section 2.7: Eq. 14 (absolute differences, contact points at their best) on a 12 x 12 grid, starts below a threshold, a simplex from each.".to_owned(),
            format!("MultiStart evaluates a force model interpolated between {solves} finite-element solves; Gauss-Newton solves each of its points, and weighs runs by their noise, so that its optimum is another estimate from the same data."),
            "Gauss-Newton needs no start from the user: its first two points are alpha = 4 and 14 with the best mu for each.".to_owned(),
        ],
        answer: panels.iter().map(sentence).collect(),
        tables: vec![table],
        pictures: pictures.collect(),
        json: [
            ("panels".to_owned(), json!(panels.iter().map(Panel::json).collect::<Vec<_>>())),
            ("fe_solves_of_multistart".to_owned(), json!(solves)),
        ]
        .into_iter()
        .collect(),
    })
}

/// Ends within this share of the best objective are one end.
const ONE_END: f64 = 1e-3;

fn sentence(panel: &Panel) -> String {
    let best = panel.best();
    let descents = &panel.search.descents;
    let same = |d: &&Descent| d.value < descents[0].value * (1.0 + ONE_END);
    let count = descents.iter().filter(same).count();
    let ends = if count == descents.len() {
        format!("all {count} starts end at one point")
    } else {
        let bounds = &panel.search.bounds;
        let on_wall =
            |d: &&Descent| !same(d) && (0..d.point.len()).any(|axis| interval::at_bound(&d.point, bounds, axis));
        let caught = match descents.iter().filter(on_wall).count() {
            0 => String::new(),
            walls => format!(" ({walls} flattened on a wall of the box)"),
        };
        format!("{count} of {} starts end at the best point{caught}", descents.len())
    };
    format!(
        "{}: {ends}, mu {} MPa and alpha {}; Gauss-Newton ends {} standard errors from it after {} solves",
        panel.balls,
        number(best.1),
        number(best.0),
        number(panel.apart()),
        panel.newton_solves
    )
}
