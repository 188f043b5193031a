//! Fits of mu and alpha with effects that stay as they are.

use std::cell::Cell;

use lut_gen::chain::{Chain, Model, Setting};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::diagnose::coordinate::{self, Coordinate, coordinates};
use crate::diagnose::design::Design;
use crate::diagnose::fit::Problem;
use crate::diagnose::noise::Source;
use crate::diagnose::{Models, Prepared};
use crate::experiment::Experiment;
use crate::identify;
use crate::infer::descent::{Region, Residuals, Rule, minimise};

use super::{ExtendedError, ExtendedModel};

/// Exponents that a search begins with.
pub(super) const ALPHAS: [f64; 3] = [4.0, 9.0, 16.0];
/// Level of the noise where nothing tells it and nothing is fitted yet, as a part of the largest force.
const FIRST_NOISE: f64 = 0.01;
const MOST_STEPS: usize = 40;
/// A search has ended when a step changes the sum of squares by less than this part of the number of residuals.
const SETTLED: f64 = 1e-7;

/// Where a search ended.
#[derive(Debug, Clone)]
pub(super) struct Descent {
    /// Where it began.
    pub start: DVector<f64>,
    /// Where it ended.
    pub x: DVector<f64>,
    /// Sum of the squares of the whitened residuals there.
    pub square: f64,
    /// Derivative of the whitened prediction.
    pub jacobian: DMatrix<f64>,
    /// Evaluations of the model.
    pub evaluations: usize,
}

/// The material of an experiment that a model is of: that of the same name, or the only one.
pub(super) fn material(experiment: &Experiment, model: &ExtendedModel) -> Result<String, ExtendedError> {
    let mut known = identify::materials(experiment);
    if known.contains(&model.material) {
        return Ok(model.material.clone());
    }
    match known.len() {
        1 => Ok(known.swap_remove(0)),
        _ => Err(ExtendedError::UnknownMaterial { material: model.material.clone(), known: known.join(", ") }),
    }
}

/// Lengths that every fit with a model needs.
pub(super) fn known_lengths(experiment: &Experiment, material: &str) -> Result<(), ExtendedError> {
    let refused = |what: String| {
        Err(ExtendedError::Contradiction(format!("{what} is unknown; expected a length in mm for a fit with a model")))
    };
    for specimen in experiment.specimens.iter().filter(|s| s.material == material) {
        if specimen.height_mm.known().is_none() {
            return refused(format!("height_mm of specimen \"{}\"", specimen.name));
        }
    }
    let used = |at: usize| experiment.runs.iter().any(|run| run.indenter == Some(at));
    for (at, ball) in experiment.indenters.iter().enumerate() {
        if ball.radius_mm.known().is_none() && used(at) {
            return refused(format!("radius_mm of indenter \"{}\"", ball.name));
        }
    }
    Ok(())
}

/// Force models of a design's geometries.
pub(super) fn chain(
    design: &Design,
    models: &Models,
    progress: &crate::diagnose::Progress<'_>,
) -> Result<Chain, lut_gen::chain::LibraryError> {
    let library = models.of(&design.geometries, &|done, total| progress("force models", done, total))?;
    Ok(Chain { library, passages: design.passages() })
}

/// The problem of a design with its noise: that of replicates, or as stated, or else what a fit with `settings` leaves. The second
/// value says which, in words.
pub(super) fn prepared<'a>(
    design: &'a Design,
    chain: &'a Chain,
    stated_n: Option<f64>,
    settings: &[Setting],
) -> Option<(Prepared<'a>, &'static str)> {
    if let Some(found) = Prepared::new(design, chain, stated_n) {
        let from = match found.noise.source {
            Source::Replicates => "differences between replicates",
            Source::Stated => "stated in [sensor] noise_N",
        };
        return Some((found, from));
    }
    let largest = design.series.iter().flat_map(|s| &s.nodes).map(|n| n.force_n).fold(0.0, f64::max);
    let first = Prepared::new(design, chain, Some(FIRST_NOISE * largest))?;
    let best = search(&first.problem, settings).into_iter().next()?;
    let left = rmse_n(&first.problem, &extended(design, &best.x, settings));
    Some((
        Prepared::new(design, chain, Some(left.max(1e-6 * largest)))?,
        "what the fit leaves: nothing repeats and none is stated",
    ))
}

/// The model of a point with its settings. A zero that is fitted comes first: it is what moves the contact.
pub(super) fn extended(design: &Design, x: &DVector<f64>, settings: &[Setting]) -> Model {
    let mut model = coordinate::model(&coordinates(design, &[]), &[], x);
    model.settings.extend_from_slice(settings);
    model
}

/// Root mean square of what is left at the nodes that are fitted, N.
pub(super) fn rmse_n(problem: &Problem<'_>, model: &Model) -> f64 {
    let used = problem.used.iter().filter(|used| **used).count().max(1);
    (problem.plain(model).norm_squared() / used as f64).sqrt()
}

/// Searches mu and alpha from every start, the best first.
pub(super) fn search(problem: &Problem<'_>, settings: &[Setting]) -> Vec<Descent> {
    let list = coordinates(problem.design, &[]);
    let mu_mpa = 0.05 * problem.largest_n().max(1e-6);
    let mut all: Vec<Descent> = ALPHAS
        .par_iter()
        .map(|alpha| {
            let start = DVector::from_fn(list.len(), |i, _| match list[i] {
                Coordinate::LnMu => mu_mpa.ln(),
                Coordinate::LnAlpha => alpha.ln(),
                _ => 0.0,
            });
            descend(problem, settings, start)
        })
        .collect();
    all.sort_by(|a, b| a.square.total_cmp(&b.square));
    all
}

/// Searches within the bounds of the parameters.
pub(super) fn descend(problem: &Problem<'_>, settings: &[Setting], start: DVector<f64>) -> Descent {
    let list = coordinates(problem.design, &[]);
    let evaluations = Cell::new(0);
    let residual = |x: &DVector<f64>| {
        evaluations.set(evaluations.get() + 1);
        problem.residual(&extended(problem.design, x, settings))
    };
    let objective = Residuals {
        residual: |x: &[f64]| residual(&DVector::from_column_slice(x)),
        jacobian: |x: &[f64], here: &DVector<f64>| slope(&list, &DVector::from_column_slice(x), here, &residual),
    };
    let region = Region::of(list.iter().map(Coordinate::bounds));
    let settled = SETTLED * problem.whitening.residuals() as f64;
    let rule = Rule { most_steps: MOST_STEPS, settled, settled_share: 0.0, rival: None };
    let end = minimise(&objective, &region, start.as_slice(), &rule);
    let (_, jacobian) = end.kept.into_parts();
    Descent { start, x: DVector::from_vec(end.x), square: end.value, jacobian, evaluations: evaluations.get() }
}

fn slope(
    list: &[Coordinate],
    x: &DVector<f64>,
    here: &DVector<f64>,
    residual: &dyn Fn(&DVector<f64>) -> DVector<f64>,
) -> DMatrix<f64> {
    const STEP: f64 = 1e-3;
    let mut out = DMatrix::zeros(here.len(), list.len());
    for (j, coordinate) in list.iter().enumerate() {
        let step = if x[j] + STEP > coordinate.bounds().1 { -STEP } else { STEP };
        let mut moved = x.clone();
        moved[j] += step;
        out.set_column(j, &((here - residual(&moved)) / step));
    }
    out
}
