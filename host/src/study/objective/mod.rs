//! The valley of Eq. 14 and the ways down it: one term over mu and alpha (thesis Fig. 9), two terms over four parameters (Fig. 10), Poisson's ratio and
//! friction on the way (Fig. 13), with what Gauss-Newton makes of the same data.

mod asked;
mod panel;
mod pictures;

use lut_gen::solid::model::Resolution;
use serde_json::json;

use crate::experiment::replicate;
use crate::identify::data::Selection;
use crate::identify::fe::{ModelError, Progress};
use crate::identify::multistart::{self, Effort};
use crate::identify::newton::condition::{Condition, Source};
use crate::identify::newton::coordinate::Kind;
use crate::identify::newton::fit::{Demand, fit};
use crate::identify::newton::setup;
use crate::identify::spec::FitSpec;

use super::findings::{Findings, Table};
use super::subject::of_balls;
use super::{StudyError, Subject};
pub use asked::Asked;
pub use panel::Panel;

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
