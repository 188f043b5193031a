//! Material parameters from indentation: thesis sections 2.4 to 2.8.
//!
//! The first loading branch of every indentation run is compared with finite elements of a
//! one-term Hyperfoam (nu = 0). The objective is Eq. 14, the search the MultiStart of section
//! 2.7. Three things make it fast and keep it correct: force is linear in mu, the contact point of every
//! run is found by a one-dimensional search inside the objective, and the finite elements stand
//! behind an interpolant in alpha (and in the height, where it is unknown) that carries an error
//! bound and is checked by a direct solve at the end.

mod answer;
pub mod contact;
pub mod data;
pub mod fe;
pub mod fit;
mod inside;
pub mod interval;
pub mod model;
pub mod multistart;
pub mod noise;
pub mod objective;
pub mod simplex;

use std::time::Instant;

pub use answer::json;
pub use inside::deepest_field;

use crate::experiment::motion::{self, Motion};
use crate::experiment::{BaseLaw, Experiment, Length, Test, replicate};

use data::{Height, LeftOut, Selection};
use fe::{FeModel, ModelError, Progress};
use fit::Fit;
use model::{ForwardModel, Shape};

/// How an identification ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// Parameters were found.
    Fitted,
    /// No run has enough samples on its way down.
    TooFewPoints,
    /// Force never rises above its noise.
    NoContact,
    /// The best alpha lies at the edge of what the model covers.
    OutsideGrid,
    /// All samples lie deeper than the model reaches.
    DeeperThanTable,
}

impl Outcome {
    /// The word in the answer.
    pub fn word(self) -> &'static str {
        match self {
            Outcome::Fitted => "fitted",
            Outcome::TooFewPoints => "too-few-points",
            Outcome::NoContact => "no-contact",
            Outcome::OutsideGrid => "outside-grid",
            Outcome::DeeperThanTable => "deeper-than-table",
        }
    }
}

/// What was found for one material.
#[derive(Debug, Clone)]
pub struct Identification {
    /// Name of the material; one a `material` key of the specimens.
    pub material: String,
    /// How it ended.
    pub outcome: Outcome,
    /// The data that were used.
    pub selection: Selection,
    /// Parameters and curves, if anything could be fitted.
    pub fit: Option<Fit>,
    /// Largest relative difference between the interpolated model and a direct solve at the
    /// optimum.
    pub direct_check: Option<f64>,
    /// What was taken for granted.
    pub assumptions: Vec<String>,
    /// What the reader should know.
    pub messages: Vec<String>,
    /// Finite element solves spent.
    pub fe_solves: usize,
    /// Wall time, s.
    pub seconds: f64,
}

/// Motions of all runs of an experiment.
pub fn motions(experiment: &Experiment) -> Vec<Option<Motion>> {
    experiment.runs.iter().map(|run| motion::of(&run.recording)).collect()
}

/// Names of the materials that were indented, in order of appearance.
pub fn materials(experiment: &Experiment) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for run in &experiment.runs {
        let Some(specimen) = run.specimen.and_then(|at| experiment.specimens.get(at)) else {
            continue;
        };
        if specimen.base_law != BaseLaw::Rigid && !names.contains(&specimen.material) {
            names.push(specimen.material.clone());
        }
    }
    names
}

/// Identifies every material of an experiment with finite elements.
///
/// # Errors
/// If a finite element solve fails, or a ball's radius is unknown.
pub fn identify(experiment: &Experiment, progress: &Progress<'_>) -> Result<Vec<Identification>, ModelError> {
    refuse_unknown_balls(experiment)?;
    let motions = motions(experiment);
    materials(experiment).iter().map(|material| one_material(experiment, &motions, material, progress)).collect()
}

/// A loading curve cannot tell the ball's radius from mu: said at once, not as a missing contact.
fn refuse_unknown_balls(experiment: &Experiment) -> Result<(), ModelError> {
    let soft = |at: usize| experiment.specimens.get(at).is_some_and(|s| s.base_law != BaseLaw::Rigid);
    let runs = experiment.runs.iter().filter(|run| run.test == Test::Indentation && run.specimen.is_some_and(soft));
    for ball in runs.filter_map(|run| experiment.indenters.get(run.indenter?)) {
        if ball.radius_mm.known().is_none() {
            return Err(ModelError::UnknownBall(ball.name.clone()));
        }
    }
    Ok(())
}

fn one_material(
    experiment: &Experiment,
    motions: &[Option<Motion>],
    material: &str,
    progress: &Progress<'_>,
) -> Result<Identification, ModelError> {
    let start = Instant::now();
    let mut found = Identification::before_fit(experiment, motions, material);
    if found.selection.curves.iter().any(|curve| !curve.hold_out) {
        let model = FeModel::build(experiment, &found.selection, progress)?;
        found.messages.extend_from_slice(model.messages());
        found.fit_with(experiment, motions, &model);
        found.check(experiment, &model)?;
        found.fe_solves = model.solves();
    }
    found.seconds = start.elapsed().as_secs_f64();
    Ok(found)
}

/// Identifies with any forward model, which must cover the pairings that
/// [`data::select`] finds for that material.
pub fn identify_with(experiment: &Experiment, material: &str, model: &dyn ForwardModel) -> Identification {
    let start = Instant::now();
    let motions = motions(experiment);
    let mut found = Identification::before_fit(experiment, &motions, material);
    found.fe_solves = model.solves();
    if found.selection.curves.iter().any(|curve| !curve.hold_out) {
        found.fit_with(experiment, &motions, model);
    }
    found.seconds = start.elapsed().as_secs_f64();
    found
}

impl Identification {
    /// What can be said of a material before anything is fitted.
    fn before_fit(experiment: &Experiment, motions: &[Option<Motion>], material: &str) -> Self {
        let selection = data::select(experiment, motions, material);
        Identification {
            material: material.to_owned(),
            outcome: outcome_without_fit(&selection),
            assumptions: assumptions(experiment, &selection),
            messages: selection.messages.clone(),
            selection,
            fit: None,
            direct_check: None,
            fe_solves: 0,
            seconds: 0.0,
        }
    }

    fn fit_with(&mut self, experiment: &Experiment, motions: &[Option<Motion>], model: &dyn ForwardModel) {
        let groups = replicate::groups(experiment, motions);
        self.fit = fit::fit(&self.selection, model, &groups, experiment.sensor.noise_n);
        self.outcome = match &self.fit {
            None => Outcome::NoContact,
            Some(fit) if interval::outside(&fit.point, &fit.search.bounds) => Outcome::OutsideGrid,
            Some(_) => Outcome::Fitted,
        };
        if let Some(fit) = &self.fit {
            self.messages.extend(fit.messages(experiment, &self.selection));
        }
    }

    /// One direct solve at the optimum, and one at the other bound of an unknown radius.
    fn check(&mut self, experiment: &Experiment, model: &FeModel) -> Result<(), ModelError> {
        let Some(fit) = &self.fit else { return Ok(()) };
        let Some(pairing) = self.selection.pairings.first() else { return Ok(()) };
        let height_mm = match pairing.height {
            Height::Known(mm) => mm,
            Height::Free(at) => fit.point[objective::FIRST_HEIGHT + at],
        };
        let shape = Shape { alpha: fit.point[objective::ALPHA], height_mm };
        self.direct_check = Some(model.direct_check(0, shape)?);
        if experiment.specimens[pairing.specimen].radius_mm == Length::Unknown {
            let (low, high) = fe::UNKNOWN_RADIUS_IN_BALLS;
            let (low_mm, high_mm) = (low * pairing.ball_mm, high * pairing.ball_mm);
            let change = model.other_radius(0, shape, low_mm)?;
            self.messages.push(format!(
                "the specimen's radius is unknown, bounds {low_mm} to {high_mm} mm; it is set to the upper one, and the lower one would change the largest force by {:+.2} %",
                100.0 * change
            ));
        }
        Ok(())
    }
}

/// The commonest reason for which no curve is left.
fn outcome_without_fit(selection: &Selection) -> Outcome {
    let has = |why: LeftOut| selection.left_out.iter().any(|(_, reason)| *reason == why);
    if has(LeftOut::NoContact) {
        Outcome::NoContact
    } else if has(LeftOut::TooDeep) {
        Outcome::DeeperThanTable
    } else {
        Outcome::TooFewPoints
    }
}

fn assumptions(experiment: &Experiment, selection: &Selection) -> Vec<String> {
    let mut list = vec![
        "one-term Hyperfoam (thesis Eq. 1) with nu = 0; a loading curve cannot tell nu from alpha".to_owned(),
        "no friction between ball and specimen, no rate dependence: only the first loading branch is used".to_owned(),
        "force zero and gain of the sensor are trusted; the contact point of every run is fitted".to_owned(),
    ];
    let mut specimens: Vec<usize> = selection.pairings.iter().map(|p| p.specimen).collect();
    specimens.sort_unstable();
    specimens.dedup();
    for &at in &specimens {
        let specimen = &experiment.specimens[at];
        if specimen.base_law == BaseLaw::Ogden || specimen.terms > 1 {
            list.push(format!(
                "{} declares another law; it is fitted as a one-term Hyperfoam all the same",
                specimen.name
            ));
        }
    }
    if specimens.len() > 1 {
        list.push(format!(
            "all {} specimens are of one material; give them different `material` keys if not",
            specimens.len()
        ));
    }
    for height in &selection.heights {
        list.push(format!(
            "height of {} is unknown: a free parameter between {:.1} and {:.1} mm",
            experiment.specimens[height.specimen].name, height.low_mm, height.high_mm
        ));
    }
    list
}
