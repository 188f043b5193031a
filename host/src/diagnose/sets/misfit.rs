//! The misfit of a set, in newtons as a user would see it. Contact points stay where they are.

use lut_gen::chain::Model;
use nalgebra::{DMatrix, DVector};

use super::Weighed;
use super::forward::beside_its_solve;
use crate::diagnose::check::Check;
use crate::diagnose::coordinate::Coordinate;
use crate::diagnose::design::Design;
use crate::diagnose::fit::{Fit, explained, freedom, predicted};
use crate::diagnose::plain::Plainly;
use crate::diagnose::search::Search;
use crate::infer::sets::Misfits;

/// Root mean square of a misfit, as a part of the largest force, below which it shows in no force:
/// the base takes it up, and runs without a ball on the specimen tell.
const SEEN: f64 = 1e-4;

impl Misfits for Search<'_> {
    /// The base at its fit with the effects at the amounts of the evidence, and how many these are.
    type Model = (Model, usize);

    fn readings(&self) -> usize {
        self.problem.whitening.residuals()
    }

    fn model(
        &self,
        set: &Weighed,
        columns_n: &DMatrix<f64>,
        amounts: Option<&DVector<f64>>,
    ) -> (Self::Model, DVector<f64>) {
        let problem = beside_its_solve(self, &set.fit);
        let (fit, found) = (&set.fit, &set.evidence.x);
        // the discrepancy takes most of a step of the base back: told together they stay small
        let is_base = |at: usize| amounts.is_some() && !matches!(fit.coordinates[at], Coordinate::Of(..));
        let x = DVector::from_fn(found.len(), |at, _| if is_base(at) { fit.x[at] } else { found[at] });
        let model_at = |x: &DVector<f64>| problem.model(&fit.coordinates, &fit.candidates, x);
        let model = model_at(&x);
        let here_n = forces_n(self, &model);
        let mut beside_n = amounts.map_or_else(|| DVector::zeros(columns_n.nrows()), |amounts| columns_n * amounts);
        for at in (0..found.len()).filter(|at| is_base(*at)) {
            let step = fit.coordinates[at].step();
            let mut moved = x.clone();
            moved[at] += step;
            let by = (found[at] - fit.x[at]) / step;
            let there_n = forces_n(self, &model_at(&moved));
            let rows = beside_n.iter_mut().zip(there_n.iter().zip(&here_n));
            rows.for_each(|(n, (there, here))| *n += by * (there - here));
        }
        ((model, fit.candidates.len()), beside_n)
    }

    /// With what a plain fit leaves of readings without a ball on the specimen, N.
    fn left(&self, (model, effects): &Self::Model, is_kept: &dyn Fn(usize) -> bool, beside_n: &DVector<f64>) -> f64 {
        // a contact point that is fitted stands behind the effects
        let model = only(model, |setting| setting >= *effects || is_kept(setting));
        let data = self.problem.design;
        let with = Model::base(model.mu_mpa, model.alpha);
        let (base, square, samples) = near(self, &with, &forces_n(self, &model), beside_n);
        let beside: Vec<f64> = data.checks.iter().flat_map(|check| apart_n(check, &model, &base)).collect();
        // a reading counts as much as a window of a run on the specimen does
        let nodes = data.series.iter().map(|series| series.nodes.len()).sum::<usize>().max(1) as f64;
        let weight = samples / nodes;
        let more: f64 = beside.iter().map(|n| weight * n * n).sum();
        ((square + more) / (samples + weight * beside.len() as f64).max(1.0)).sqrt()
    }

    fn left_share(&self, (model, _): &Self::Model, beside_n: &DVector<f64>) -> f64 {
        let forces_n = forces_n(self, model);
        let nodes = self.problem.design.series.iter().flat_map(|series| &series.nodes);
        let counted = nodes.zip(&forces_n).filter(|(node, _)| !node.lifted);
        let whole: f64 = counted.map(|(node, n)| node.samples.max(1) as f64 * n * n).sum();
        let (_, left, _) = near(self, model, &forces_n, beside_n);
        (left / whole).sqrt()
    }

    fn seen(&self) -> f64 {
        SEEN * self.problem.largest_n()
    }

    fn explained(&self, fit: &Fit) -> Option<f64> {
        explained(self.base.square, freedom(&self.problem.used, &self.base), fit.square)
    }
}

/// Forces of a model at the nodes of all runs, one after the other, N. Contact points of runs lie where the
/// model has them all: what spots differ by is no misfit.
fn forces_n(search: &Search<'_>, model: &Model) -> Vec<f64> {
    let problem = &search.problem;
    predicted(problem.design, problem.chain, model, &vec![0.0; problem.design.series.len()]).concat()
}

/// A plain fit of a model's `mu` and `alpha` to forces with a discrepancy beside them: the model, its sum of
/// squares, N2, and the number of samples.
fn near(search: &Search<'_>, with: &Model, forces_n: &[f64], beside_n: &DVector<f64>) -> (Model, f64, f64) {
    let mut data: Design = search.problem.design.clone();
    let nodes = data.series.iter_mut().flat_map(|series| &mut series.nodes);
    let rows = nodes.zip(forces_n.iter().zip(beside_n.iter()));
    rows.for_each(|(node, (force_n, more_n))| node.force_n = force_n + more_n);
    Plainly { design: &data, chain: search.problem.chain, with }.base_near()
}

/// What readings of a run without a ball on the specimen differ by between two models, N.
fn apart_n(check: &Check, one: &Model, other: &Model) -> Vec<f64> {
    let readings = check.readings();
    let each = check.predicted(one).into_iter().zip(check.predicted(other)).take(readings);
    each.map(|(one, other)| one - other).collect()
}

/// A model that has some of its settings only. What finite elements add is known of all together.
fn only(model: &Model, is_kept: impl Fn(usize) -> bool) -> Model {
    let kept = model.settings.iter().enumerate().filter(|(at, _)| is_kept(*at));
    let settings: Vec<_> = kept.map(|(_, setting)| setting.clone()).collect();
    let whole = model.whole.clone().filter(|_| settings.len() == model.settings.len());
    Model { settings, whole, ..model.clone() }
}
