//! Identification with the extended model: mu and alpha fitted again with the effects in the chain, these fixed or freed.

use std::time::Instant;

use lut_gen::chain::{LibraryError, Model, Setting};
use nalgebra::DVector;
use serde_json::{Map, Value, json};

use crate::diagnose::Models;
use crate::diagnose::coordinate::{Candidate, Coordinate, coordinates};
use crate::diagnose::design::Design;
use crate::diagnose::fit::{self, Problem};
use crate::diagnose::plain::Plainly;
use crate::experiment::{Experiment, motion};
use crate::identify::Outcome;
use crate::infer::covariance::Z95;
use crate::infer::covariance::covariance;
use crate::infer::product::inner;

use super::fitting::{self, Descent};
use super::{ExtendedError, ExtendedModel};

/// Why there is no identification.
#[derive(Debug, thiserror::Error)]
pub enum IdentifyError {
    /// The model does not belong to the experiment.
    #[error(transparent)]
    Model(#[from] ExtendedError),
    /// A force model could not be made.
    #[error("no force model: {0}")]
    Force(#[from] LibraryError),
    /// The noise has no covariance.
    #[error("the noise of {0} has no positive definite covariance")]
    Covariance(String),
}

/// A parameter that was found, or taken from the file.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Name with unit.
    pub name: String,
    /// Value.
    pub value: f64,
    /// 95 % interval; that of the file where the value is the file's, none where it holds none.
    pub interval: Option<(f64, f64)>,
    /// Least and largest value.
    pub bounds: (f64, f64),
    /// True when it was not fitted.
    pub fixed: bool,
}

/// An effect with its parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct IdentifiedEffect {
    /// Code.
    pub code: &'static str,
    /// Form.
    pub form: &'static str,
    /// Ball or specimen that it belongs to.
    pub owner: Option<String>,
    /// Its parameters.
    pub parameters: Vec<Parameter>,
}

/// What was found.
#[derive(Debug, Clone, PartialEq)]
pub struct Identified {
    /// Name of the material.
    pub material: String,
    /// How it ended.
    pub outcome: Outcome,
    /// mu (MPa) and alpha; empty if nothing could be fitted.
    pub parameters: Vec<Parameter>,
    /// The effects.
    pub effects: Vec<IdentifiedEffect>,
    /// Root mean square of what is left, N.
    pub rmse_n: f64,
    /// Standard deviation of a sample's noise, N.
    pub noise_n: f64,
    /// Where that is from.
    pub noise_from: &'static str,
    /// Starts and ends of the search.
    pub starts: Vec<Start>,
    /// Each run: number in the experiment, what is left of it (N), whether it was held out.
    pub runs: Vec<(usize, f64, bool)>,
    /// Finite-element solves behind the force models.
    pub fe_solves: usize,
    /// What the reader should know.
    pub messages: Vec<String>,
    /// Wall time, s.
    pub seconds: f64,
}

/// One search: from (mu in MPa, alpha) to (mu, alpha), sum of squares a residual, evaluations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Start {
    /// Begin.
    pub from: (f64, f64),
    /// End.
    pub to: (f64, f64),
    /// Mean square of the whitened residuals.
    pub objective: f64,
    /// Evaluations of the model.
    pub evaluations: usize,
}

/// Fits mu and alpha of the model's material with the model's effects; with `freed` their parameters as well.
///
/// # Errors
/// [`IdentifyError`]; data that cannot be used are no error but an outcome.
pub fn identify(
    experiment: &Experiment,
    model: &ExtendedModel,
    freed: bool,
    models: &Models,
    progress: &crate::diagnose::Progress<'_>,
) -> Result<Identified, IdentifyError> {
    let start = Instant::now();
    let material = fitting::material(experiment, model)?;
    fitting::known_lengths(experiment, &material)?;
    let settings = model.chain_model(experiment)?.settings;
    let mut out = empty(&material, model);
    match Design::of(experiment, &material) {
        Err(refusal) => {
            out.outcome = unusable(experiment, &material);
            out.messages.push(refusal.to_string());
        }
        Ok(design) => {
            out.messages.extend_from_slice(&design.messages);
            let chain = fitting::chain(&design, models, progress)?;
            out.messages.extend(chain.library.missing().map(ToString::to_string));
            out.fe_solves = chain.library.solves();
            let (prepared, from) = fitting::prepared(&design, &chain, experiment.sensor.noise_n, &settings)
                .ok_or_else(|| IdentifyError::Covariance(material.clone()))?;
            (out.noise_n, out.noise_from) = (prepared.noise.sensor.sigma_n, from);
            out.fit(&prepared.problem, &settings, freed);
        }
    }
    out.seconds = start.elapsed().as_secs_f64();
    Ok(out)
}

fn empty(material: &str, model: &ExtendedModel) -> Identified {
    let mut messages = Vec::new();
    if material != model.material {
        messages
            .push(format!("the model is of {}, the experiment of {material}: its effects are used", model.material));
    }
    Identified {
        material: material.to_owned(),
        outcome: Outcome::TooFewPoints,
        parameters: Vec::new(),
        effects: model
            .effects
            .iter()
            .map(|added| IdentifiedEffect {
                code: added.effect.code,
                form: added.effect.form,
                owner: added.owner.clone(),
                parameters: added
                    .effect
                    .quantities
                    .iter()
                    .enumerate()
                    .map(|(i, q)| Parameter {
                        name: q.name.to_owned(),
                        value: added.values[i],
                        interval: added.intervals.get(i).copied().flatten(),
                        bounds: (q.low, q.high),
                        fixed: true,
                    })
                    .collect(),
            })
            .collect(),
        rmse_n: f64::NAN,
        noise_n: f64::NAN,
        noise_from: "",
        starts: Vec::new(),
        runs: Vec::new(),
        fe_solves: 0,
        messages,
        seconds: 0.0,
    }
}

/// Fewest samples on a way down that could be a press.
const LEAST_SAMPLES: usize = 8;

/// What to call it when no run can be used.
fn unusable(experiment: &Experiment, material: &str) -> Outcome {
    let own = |at: usize| experiment.specimens.get(at).is_some_and(|s| s.material == material);
    let mut runs = experiment.runs.iter().filter(|run| run.specimen.is_some_and(own));
    let long = runs.any(|run| motion::of(&run.recording).is_some_and(|m| m.loading.len() >= LEAST_SAMPLES));
    if long { Outcome::NoContact } else { Outcome::TooFewPoints }
}

/// A parameter may lie this close to a bound, as a part of the range, and counts as on it.
const ON_BOUND: f64 = 1e-3;

impl Identified {
    /// Values are those of the plain best fit, as `palpate identify` without a model makes it and as a diagnosis prints them;
    /// intervals are those of the fit that weighs residuals by their noise, and hold the values.
    fn fit(&mut self, problem: &Problem<'_>, settings: &[Setting], freed: bool) {
        let descents = fitting::search(problem, settings);
        let used = problem.used.iter().filter(|used| **used).count().max(1) as f64;
        self.starts = descents.iter().map(|d| start_of(d, used)).collect();
        let Some(best) = descents.into_iter().next() else { return };
        let design = problem.design;
        let (model, intervals) = if freed && !settings.is_empty() {
            self.freed(problem, settings, &best.x)
        } else {
            let list = coordinates(design, &[]);
            let covariance = covariance(&inner(&best.jacobian, &best.jacobian));
            let of = |i: usize| {
                let sigma = covariance.as_ref().map_or(f64::NAN, |c| c[(i, i)].sqrt());
                list[i].interval(best.x[i], Z95 * sigma)
            };
            (fitting::extended(design, &best.x, settings), [of(0), of(1)])
        };
        let plainly = Plainly { design, chain: problem.chain, with: &model };
        let plain = plainly.best();
        let values = [plain.model.mu_mpa, plain.model.alpha];
        let parameter = |at: usize| {
            let (name, coordinate) = [("mu_MPa", Coordinate::LnMu), ("alpha", Coordinate::LnAlpha)][at];
            let (value, (low, high)) = (values[at], intervals[at]);
            Parameter {
                name: name.to_owned(),
                value,
                interval: Some((value.min(low), value.max(high))),
                bounds: (coordinate.bounds().0.exp(), coordinate.bounds().1.exp()),
                fixed: false,
            }
        };
        self.parameters = vec![parameter(0), parameter(1)];
        let at_edge = on_bound(&Coordinate::LnAlpha, plain.model.alpha.ln());
        self.outcome = if at_edge { Outcome::OutsideGrid } else { Outcome::Fitted };
        self.rmse_n = plain.rmse_n;
        let forces = fit::predicted(design, problem.chain, &plain.model, &plainly.contacts_of_runs(&plain));
        for (series, force) in design.series.iter().zip(&forces) {
            let square: f64 = series.nodes.iter().zip(force).map(|(n, f)| (n.force_n - f).powi(2)).sum();
            self.runs.push((series.run, (square / series.nodes.len().max(1) as f64).sqrt(), series.hold_out));
        }
    }

    /// Fits the effects' parameters as well, from those of the file.
    fn freed(&mut self, problem: &Problem<'_>, settings: &[Setting], x: &DVector<f64>) -> (Model, [(f64, f64); 2]) {
        let candidates: Vec<Candidate> =
            settings.iter().map(|s| Candidate { effect: s.effect, owner: s.owner }).collect();
        let list = coordinates(problem.design, &candidates);
        let values: Vec<f64> = settings.iter().flat_map(|s| s.values.iter().copied()).collect();
        let known = x.len();
        let start = DVector::from_fn(list.len(), |i, _| if i < known { x[i] } else { list[i].of(values[i - known]) });
        let found = problem.fit(&candidates, &start);
        for (at, effect) in self.effects.iter_mut().enumerate() {
            for (parameter, (_, value, interval)) in effect.parameters.iter_mut().zip(found.quantities(at)) {
                (parameter.value, parameter.interval, parameter.fixed) = (value, Some(interval), false);
            }
        }
        (found.model.clone(), found.base().map(|known| known.1))
    }

    /// The answer of `palpate identify` with a model: the keys of the contract, and `model` with the effects.
    #[must_use]
    pub fn json(&self, experiment: &Experiment, file: &str) -> Value {
        let starts: Vec<Value> = self
            .starts
            .iter()
            .map(|s| {
                json!({
                    "mu_MPa": s.from.0, "alpha": s.from.1, "end": { "mu_MPa": s.to.0, "alpha": s.to.1 },
                    "objective": s.objective, "evaluations": s.evaluations,
                })
            })
            .collect();
        let runs: Vec<Value> = self
            .runs
            .iter()
            .map(|(run, rmse_n, hold_out)| {
                json!({ "file": experiment.runs[*run].file, "rmse_N": rmse_n, "hold_out": hold_out })
            })
            .collect();
        let effects: Vec<Value> = self
            .effects
            .iter()
            .map(|e| json!({ "code": e.code, "form": e.form, "owner": e.owner, "parameters": told(&e.parameters) }))
            .collect();
        json!({
            "outcome": self.outcome.word(), "material": self.material, "law": "hyperfoam",
            "parameters": told(&self.parameters),
            "rmse_N": finite(self.rmse_n), "noise_N": finite(self.noise_n), "noise_from": self.noise_from,
            "method": "chain", "fe_solves": self.fe_solves, "seconds": self.seconds, "starts": starts, "runs": runs,
            "model": { "file": file, "effects": effects }, "messages": self.messages,
        })
    }
}

fn start_of(descent: &Descent, used: f64) -> Start {
    Start {
        from: (descent.start[0].exp(), descent.start[1].exp()),
        to: (descent.x[0].exp(), descent.x[1].exp()),
        objective: descent.square / used,
        evaluations: descent.evaluations,
    }
}

fn on_bound(coordinate: &Coordinate, x: f64) -> bool {
    let (low, high) = coordinate.bounds();
    (x - low).min(high - x) < ON_BOUND * (high - low)
}

fn finite(value: f64) -> Value {
    if value.is_finite() { json!(value) } else { Value::Null }
}

fn told(parameters: &[Parameter]) -> Value {
    let one = |p: &Parameter| {
        let at_bound = !p.fixed && ((p.value - p.bounds.0).abs() < 1e-9 || (p.value - p.bounds.1).abs() < 1e-9);
        let interval = p.interval.map(|(low, high)| [low, high]);
        (
            p.name.clone(),
            json!({
                "value": p.value, "interval95": interval, "bounds": [p.bounds.0, p.bounds.1], "at_bound": at_bound, "fixed": p.fixed,
            }),
        )
    };
    Value::Object(parameters.iter().map(one).collect::<Map<String, Value>>())
}
