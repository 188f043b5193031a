//! What explanations predict of a run that could be made, and how far apart that is.

use lut_gen::chain::{Chain, Model, Passage, Setting};
use lut_gen::effect::{friction, radius, relaxation, second_term, softening, thickness};
use nalgebra::{DMatrix, DVector};

use super::super::coordinate;
use super::super::design::{Branch, Design};
use super::super::fit::{self, Fit, Problem};
use super::super::search::Search;
use super::super::whiten::Whitening;
use super::motion::Plan;
use crate::infer::covariance::Factor;
use crate::infer::lowrank::{Fold, LowRank};

/// What a fit predicts of planned runs, by how much each of its parameters moves that, and what the prediction may be wrong by, a column of unit variance each.
pub(super) struct Forecast {
    pub force: DVector<f64>,
    pub slopes: DMatrix<f64>,
    errors: DMatrix<f64>,
}

/// Part of what an effect adds under a ball that the chain misses where no finite elements of the path correct it (docs/diagnosis.md): those of the planned run are not solved.
const MISSED: [(&str, f64); 4] = [
    (relaxation::ONE.code, 0.015),
    (second_term::EFFECT.code, 0.16),
    (softening::EFFECT.code, 0.24),
    (friction::EFFECT.code, 0.31),
];

/// Planned runs with what whitens them.
pub(super) struct Bench {
    plan: Plan,
    design: Design,
    chain: Chain,
    whitening: Whitening,
}

impl Bench {
    pub fn new(search: &Search<'_>, plan: Plan) -> Option<Self> {
        let like = search.problem.design;
        let geometry = like
            .series
            .iter()
            .find(|s| s.specimen == plan.specimen && s.indenter == plan.indenter)
            .map(|s| s.geometry)?;
        let design = plan.design(like, &search.base.model, geometry)?;
        let passages: Vec<Passage> = design.passages();
        let chain = Chain { library: search.problem.chain.library.clone(), passages };
        let model = placed(&plan, &design, &search.base.model);
        let curves = Problem::curves(&design, &chain, &model, &contacts(&design));
        let whitening = Whitening::new(&design, &curves, &search.noise)?;
        Some(Self { plan, design, chain, whitening })
    }

    /// What a model predicts for every row.
    fn rows(&self, model: &Model) -> DVector<f64> {
        fit::rows(&self.design, &self.chain, &placed(&self.plan, &self.design, model), &contacts(&self.design))
    }

    pub fn forces(&self, model: &Model) -> DVector<f64> {
        let mut forces = self.rows(model);
        self.whitening.apply(&mut forces);
        forces
    }

    pub fn forecast(&self, fit: &Fit) -> Forecast {
        let force = self.forces(&fit.model);
        let mut slopes = DMatrix::zeros(force.len(), fit.x.len());
        for j in 0..fit.x.len() {
            let (_, high) = fit.coordinates[j].bounds();
            let step = if fit.x[j] + fit.coordinates[j].step() > high { -1.0 } else { 1.0 } * fit.coordinates[j].step();
            let mut x = fit.x.clone();
            x[j] += step;
            let there = self.forces(&coordinate::model(&fit.coordinates, &fit.candidates, &x));
            slopes.set_column(j, &((there - &force) / step));
        }
        Forecast { force, slopes, errors: self.errors(fit) }
    }

    /// What the chain may be wrong by in the forecast of a fit, smoothly along each branch.
    fn errors(&self, fit: &Fit) -> DMatrix<f64> {
        let mut columns = Vec::new();
        for candidate in &fit.candidates {
            let Some((_, share)) = MISSED.iter().find(|(code, _)| *code == candidate.effect.code) else { continue };
            let mut bare = fit.model.clone();
            bare.settings.retain(|s| s.effect != candidate.effect);
            let added = self.rows(&fit.model) - self.rows(&bare);
            for branch in [Branch::Loading, Branch::Hold, Branch::Unloading] {
                for shape in 0..3 {
                    let mut column = *share * self.along(&added, branch, shape);
                    if column.norm() > 0.0 {
                        self.whitening.apply(&mut column);
                        columns.push(column);
                    }
                }
            }
        }
        if columns.is_empty() { DMatrix::zeros(self.whitening.residuals(), 0) } else { DMatrix::from_columns(&columns) }
    }

    /// Rows of balls on one branch, times a polynomial of depth; 0 elsewhere.
    fn along(&self, rows: &DVector<f64>, branch: Branch, shape: usize) -> DVector<f64> {
        let mut out = DVector::zeros(rows.len());
        for (s, series) in self.design.series.iter().enumerate() {
            for (k, node) in series.nodes.iter().enumerate().filter(|(_, n)| n.branch == branch) {
                let at = self.whitening.first(s) + k;
                let x = 2.0 * node.depth_mm / self.plan.depth_mm - 1.0;
                out[at] = rows[at] * [1.0, x, 1.5 * x * x - 0.5][shape];
            }
        }
        out
    }
}

fn contacts(design: &Design) -> Vec<f64> {
    vec![0.0; design.series.len()]
}

/// A model with the planned height and radius in it: what is declared moves, and errors of the old ones go.
fn placed(plan: &Plan, design: &Design, model: &Model) -> Model {
    // what finite elements of other paths add is nothing here
    let mut placed = Model { whole: None, ..model.clone() };
    let Some(first) = design.series.first() else { return placed };
    let geometry = &design.geometries[first.geometry];
    if plan.radius != 1.0 {
        // a new ball has its own radius
        placed.settings.retain(|s| s.effect.code != radius::EFFECT.code || s.owner != plan.indenter);
        let values = vec![(plan.radius - 1.0) * geometry.ball_mm];
        placed.settings.push(Setting { effect: &radius::EFFECT, owner: plan.indenter, values });
    }
    if plan.height != 1.0 {
        let effect = &thickness::HEIGHT;
        placed.settings.retain(|s| s.effect != effect || s.owner != plan.specimen);
        let values = vec![(plan.height - 1.0) * geometry.specimen.height_mm];
        placed.settings.push(Setting { effect, owner: plan.specimen, values });
    }
    placed
}

/// Distance of a forecast from another one whose parameters are known as far as its fit knows them, and which both may be wrong as the chain is. None (0) where a
/// number is none.
pub(super) fn distance(from: &Forecast, to: &Forecast, fit: &Fit) -> f64 {
    let known = Factor::of(&(&fit.information + coordinate::known_before(&fit.coordinates)));
    let Some(known) = known else { return 0.0 };
    let free = LowRank::unit(known.rooted(&to.slopes), "parameters");
    let errors = [&to.errors, &from.errors].map(|columns| LowRank::unit(columns.clone(), "chain"));
    let fold = Fold::of(free.and(&errors[0]).and(&errors[1]).scaled());
    fold.taken_off(&(&from.force - &to.force)).norm()
}
