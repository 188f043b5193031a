//! Material parameters from indentation, compression and tension: thesis sections 2.4 to 2.8.
//!
//! The first loading branch of every run (and the hold after it, for a relaxing material) is compared with
//! finite elements. Two searches lead to the parameters: Gauss-Newton on the finite elements' sensitivities
//! ([`newton`], the default), and the thesis' MultiStart on Eq. 14 ([`multistart`]). Both ask the same forward problems ([`newton::problem`]): force is
//! linear in the modulus, and the contact point of every run is found inside the objective.

mod answer;
pub mod contact;
mod coupon;
pub mod data;
pub mod fe;
pub mod fit;
pub mod grip;
mod inside;
pub mod interval;
pub mod model;
pub mod multistart;
pub mod newton;
pub mod noise;
mod samples;
pub mod simplex;
pub mod spec;
mod unused;
pub mod zero;

use std::time::{Duration, Instant};

pub use answer::json;
pub use inside::deepest_field;

use crate::experiment::motion::{self, Motion};
use crate::experiment::{BaseLaw, Experiment, Length, Test, replicate};

use data::{LeftOut, Selection};
use fe::{ModelError, Progress};
use fit::Fit;
use lut_gen::solid::model::Resolution;
use multistart::Effort;
use newton::condition::{Condition, Source};
use newton::coordinate::{Kind, Unknown};
use newton::problem::Problem;
use spec::{FitSpec, FittedLaw, Method};

/// How an identification ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// Parameters were found.
    Fitted,
    /// No run has enough samples on its way down.
    TooFewPoints,
    /// Force never rises above its noise.
    NoContact,
    /// The best alpha lies at the edge of what the model covers, or no alpha that the engine is tested at explains the data.
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
    /// The law that was fitted.
    pub law: FittedLaw,
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
/// If no finite element solve succeeds, a ball's radius is unknown, or more terms are asked for than are fitted.
pub fn identify(
    experiment: &Experiment,
    spec: &FitSpec,
    progress: &Progress<'_>,
) -> Result<Vec<Identification>, ModelError> {
    refuse_unknown_balls(experiment)?;
    let motions = motions(experiment);
    materials(experiment).iter().map(|material| one_material(experiment, &motions, material, spec, progress)).collect()
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
    spec: &FitSpec,
    progress: &Progress<'_>,
) -> Result<Identification, ModelError> {
    let start = Instant::now();
    let (law, terms) = spec.resolved(experiment, material);
    if terms > 2 || spec.relaxation > 2 {
        return Err(ModelError::TooManyTerms { law: law.word(), terms, relaxation: spec.relaxation });
    }
    let mut found = Identification::before_fit(experiment, motions, material, spec);
    if found.selection.curves.iter().any(|curve| !curve.hold_out) {
        match spec.method {
            Method::GaussNewton => {
                let source = |_: &Condition| Source::Solves(Resolution::Standard);
                found.fit_by_newton(experiment, motions, spec, &source, progress)?;
            }
            Method::Simplex => {
                let source = |_: &Condition| Source::Solves(Resolution::Standard);
                found.fit_by_multistart(experiment, motions, spec, &source, progress)?;
            }
        }
    }
    found.seconds = start.elapsed().as_secs_f64();
    Ok(found)
}

/// Identifies one material with forces from any source: a force model of each condition that was made before, or solves.
///
/// # Errors
/// As [`identify`].
pub fn identify_from(
    experiment: &Experiment,
    material: &str,
    spec: &FitSpec,
    source: &dyn Fn(&Condition) -> Source,
) -> Result<Identification, ModelError> {
    let start = Instant::now();
    let motions = motions(experiment);
    let mut found = Identification::before_fit(experiment, &motions, material, spec);
    if found.selection.curves.iter().any(|curve| !curve.hold_out) {
        match spec.method {
            Method::GaussNewton => found.fit_by_newton(experiment, &motions, spec, source, &|_, _, _| {})?,
            Method::Simplex => found.fit_by_multistart(experiment, &motions, spec, source, &|_, _, _| {})?,
        }
    }
    found.seconds = start.elapsed().as_secs_f64();
    Ok(found)
}

impl Identification {
    /// What can be said of a material before anything is fitted.
    fn before_fit(experiment: &Experiment, motions: &[Option<Motion>], material: &str, spec: &FitSpec) -> Self {
        let mut selection = data::select(experiment, motions, material, spec.relaxation > 0);
        // Eq. 14 knows no priors: it takes the zero as it is.
        if spec.loss == spec::Loss::Absolute || spec.method == Method::Simplex {
            selection.trust_zeros();
        }
        Identification {
            material: material.to_owned(),
            law: spec.resolved(experiment, material).0,
            outcome: outcome_without_fit(&selection),
            assumptions: assumptions(experiment, &selection, material, spec),
            messages: selection.messages.clone(),
            selection,
            fit: None,
            direct_check: None,
            fe_solves: 0,
            seconds: 0.0,
        }
    }

    fn fit_by_multistart(
        &mut self,
        experiment: &Experiment,
        motions: &[Option<Motion>],
        spec: &FitSpec,
        source: &dyn Fn(&Condition) -> Source,
        progress: &Progress<'_>,
    ) -> Result<(), ModelError> {
        let groups = replicate::groups(experiment, motions);
        let mut problem = newton::setup::problem(experiment, &self.selection, &self.material, spec, source);
        // A simplex follows no slopes: kinks do not stop it.
        problem.sharpen();
        let told = |solves: usize| progress(&self.material, solves, 0);
        let search = multistart::search(&mut problem, Effort::of(spec.most_solves), &told);
        let search = search.map_err(|cause| ModelError::Solve { what: self.material.clone(), cause })?;
        let solves = problem.solves();
        let end = search.starts.first().map(|best| best.descent.point.clone()).unwrap_or_default();
        let spans: Vec<(f64, f64)> = end.iter().map(|x| (*x, *x)).collect();
        let outside = Tested::all(&problem.unknowns, &end, &spans).iter().any(|one| one.outside);
        let fit = fit::by_multistart(&mut problem, search, &groups, experiment.sensor.noise_n);
        self.fe_solves = solves;
        let Some(fit) = fit else {
            self.outcome = Outcome::NoContact;
            return Ok(());
        };
        self.outcome = if outside { Outcome::OutsideGrid } else { Outcome::Fitted };
        let messages = fit.messages(experiment, &self.selection);
        self.messages.extend(other_radius(experiment, &problem, &fit));
        self.messages.extend(messages);
        self.fit = Some(fit);
        Ok(())
    }

    fn fit_by_newton(
        &mut self,
        experiment: &Experiment,
        motions: &[Option<Motion>],
        spec: &FitSpec,
        source: &dyn Fn(&Condition) -> Source,
        progress: &Progress<'_>,
    ) -> Result<(), ModelError> {
        let groups = replicate::groups(experiment, motions);
        let mut problem = newton::setup::problem(experiment, &self.selection, &self.material, spec, source);
        let told = |solves: usize| progress(&self.material, solves, 0);
        let demand = newton::fit::Demand {
            groups: &groups,
            stated_n: experiment.sensor.noise_n,
            most_solves: spec.most_solves,
            until: spec.budget_s.and_then(|s| Instant::now().checked_add(Duration::try_from_secs_f64(s).ok()?)),
            told: &told,
        };
        let outcome = newton::fit::fit(&mut problem, &demand);
        let found = outcome.map_err(|cause| ModelError::Solve { what: self.material.clone(), cause })?;
        let spans: Vec<(f64, f64)> = found.spans.iter().map(|span| (span.low, span.high)).collect();
        let tested = Tested::all(&problem.unknowns, &found.minimum.x, &spans);
        let outside = tested.iter().any(|one| one.outside);
        let reaching = tested.into_iter().filter_map(|one| one.told).collect::<Vec<_>>();
        let solves = problem.solves();
        let expected = found.expected_within;
        let fit = fit::by_newton(&problem, found);
        let messages = fit.messages(experiment, &self.selection);
        self.outcome = if outside { Outcome::OutsideGrid } else { Outcome::Fitted };
        self.fe_solves = solves;
        self.direct_check = expected.is_finite().then_some(expected);
        self.messages.extend(reaching);
        self.messages.extend(messages);
        self.fit = Some(fit);
        Ok(())
    }
}

/// What the lower bound of an unknown radius would do to the force of the first such specimen under a ball; one solve.
fn other_radius(experiment: &Experiment, problem: &Problem<'_>, fit: &Fit) -> Option<String> {
    let point = &fit.search.as_ref()?.starts.first()?.descent.point;
    let unknown =
        |c: &&Condition| c.grip.indenter().is_some() && experiment.specimens[c.specimen].radius_mm == Length::Unknown;
    let usual = problem.conditions.iter().find(unknown)?;
    let (low, high) = fe::UNKNOWN_RADIUS_IN_BALLS;
    let (low_mm, high_mm) = (low * usual.grip.ball_mm(), high * usual.grip.ball_mm());
    let mut other = usual.clone();
    other.block.radius_mm = low_mm;
    let told = "the specimen's radius is unknown, bounds";
    let set = "it is set to the upper one, and the lower one";
    match other.solve(&problem.base, &problem.unknowns, point) {
        Ok((node, _)) => {
            let place = usual.local(point);
            let before = usual.surrogate.at(&place);
            let at_peak = |values: &[f64]| {
                let ramp = &values[..lut_gen::solid::model::RAMP_NODES.min(values.len())];
                newton::track::Track::new(usual.depth_mm, 0.0, ramp, 0.0).ramp(usual.depth_mm).0
            };
            let change = 100.0 * (at_peak(&node.value) / at_peak(&before) - 1.0);
            Some(format!("{told} {low_mm} to {high_mm} mm; {set} would change the largest force by {change:+.2} %"))
        }
        Err(cause) => Some(format!("{told} {low_mm} to {high_mm} mm; {set} has no solve: {cause}")),
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

/// Exponents the engine is tested at.
const TESTED_ALPHA: (f64, f64) = (1.0, 24.0);

/// Where an exponent lies beside those the engine is tested at.
struct Tested {
    /// It stands on a bound of its search, or no tested exponent explains the data.
    outside: bool,
    /// What the reader should know where only part of it is outside.
    told: Option<String>,
}

impl Tested {
    /// Of every exponent among the unknowns.
    fn all(unknowns: &[Unknown], point: &[f64], spans: &[(f64, f64)]) -> Vec<Self> {
        let each = unknowns.iter().zip(point.iter().zip(spans));
        let exponents = each.filter(|(unknown, _)| matches!(unknown.kind, Kind::Alpha(_)));
        exponents.map(|(unknown, (x, span))| Self::of(unknown, *x, *span)).collect()
    }

    fn of(unknown: &Unknown, x: f64, (low, high): (f64, f64)) -> Self {
        let (low, high) = (unknown.value(low), unknown.value(high));
        let outside = high < TESTED_ALPHA.0 || low > TESTED_ALPHA.1 || unknown.stands_on_bound(x);
        let reaches = low < TESTED_ALPHA.0 || high > TESTED_ALPHA.1;
        let told = (reaches && !outside).then(|| {
            format!(
                "the interval of {} reaches beyond the exponents that the engine is tested at, {} to {}",
                unknown.name, TESTED_ALPHA.0, TESTED_ALPHA.1
            )
        });
        Self { outside, told }
    }
}

fn assumptions(experiment: &Experiment, selection: &Selection, material: &str, spec: &FitSpec) -> Vec<String> {
    let (law, terms) = spec.resolved(experiment, material);
    let free = |extra| spec.free.contains(&extra);
    let number = if terms == 1 { "one-term" } else { "two-term" };
    let mut list = vec![match law {
        FittedLaw::Ogden => format!("{number} Ogden (thesis Eq. 2) with deviatoric stretches"),
        FittedLaw::Hyperfoam if spec.frees_nu(selection) => format!("{number} Hyperfoam (thesis Eq. 1)"),
        FittedLaw::Hyperfoam => format!(
            "{number} Hyperfoam (thesis Eq. 1) with nu = {}; a loading curve cannot tell nu from alpha",
            spec.nu
        ),
    }];
    list.push(match (spec.relaxation, free(spec::Extra::Friction)) {
        (0, false) => format!(
            "friction between ball and specimen {}, no rate dependence: only the first loading branch is used",
            spec.friction
        ),
        (0, true) => "no rate dependence: only the first loading branch is used".to_owned(),
        (n, _) => {
            format!("{n} Prony terms (thesis Eqs. 10 to 13); the first loading branch and the hold after it are used")
        }
    });
    list.extend(coupon::assumptions(selection, spec));
    list.push(
        "the force zero is what the sensor reads before contact; its gain is trusted; the contact point of every run is fitted"
            .to_owned(),
    );
    let mut specimens: Vec<usize> = selection.pairings.iter().map(|p| p.specimen).collect();
    specimens.sort_unstable();
    specimens.dedup();
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
