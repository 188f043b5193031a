//! What effects explain of the misfit, in newtons as a user would see it.
//!
//! The misfit is what a plain fit of the base leaves of the model's own forces: with the effects, at
//! the amounts that the evidence has, and with the discrepancy that it puts beside them. The share
//! of some effects is the part of its square that goes without them. Noise and the scatter of spots
//! are in neither, and contact points stay where they are.

use lut_gen::chain::Model;
use nalgebra::{DMatrix, DVector};

use super::discrepancy::Group;
use super::weigh::{Weighed, beside_its_solve};
use crate::diagnose::coordinate::Coordinate;
use crate::diagnose::design::Design;
use crate::diagnose::fit::{explained, freedom, predicted};
use crate::diagnose::plain::Plainly;
use crate::diagnose::search::Search;
use crate::infer::evidence::{Discrepancy, amounts};

/// Root mean square of a misfit, as a part of the largest force, below which it shows in no force:
/// the base takes it up, and runs without a ball on the specimen tell.
const SEEN: f64 = 1e-4;

/// Share of an effect below which the discrepancy takes it back: without it the square of the misfit
/// would be larger by half.
const CANCELLED: f64 = -0.5;

/// What is needed to tell shares of sets.
pub(super) struct Shares<'a> {
    search: &'a Search<'a>,
    discrepancy: &'a Discrepancy,
    /// Columns of the discrepancy, N.
    forces_n: DMatrix<f64>,
}

impl<'a> Shares<'a> {
    /// Of a search, whose sets are weighed beside groups of discrepancies.
    pub fn new(search: &'a Search<'a>, groups: &[Group], discrepancy: &'a Discrepancy) -> Self {
        let columns: Vec<_> = groups.iter().flat_map(|group| group.forces_n.column_iter()).collect();
        let rows = search.problem.whitening.residuals();
        let forces_n = if columns.is_empty() { DMatrix::zeros(rows, 0) } else { DMatrix::from_columns(&columns) };
        Self { search, discrepancy, forces_n }
    }

    /// Of effects of some codes, in the likeliest set that has as many of them as any; none where no
    /// set has one, or nothing is left without them.
    pub fn of(&self, sets: &[Weighed], codes: &[&'static str]) -> Option<f64> {
        let has = |set: &Weighed| codes.iter().filter(|code| set.fit.codes().any(|c| c == **code)).count();
        let most = sets.iter().map(has).max().filter(|most| *most > 0)?;
        let own = sets.iter().filter(|set| has(set) == most);
        let set = own.max_by(|a, b| a.log.total_cmp(&b.log))?;
        match self.misfits(set).seen() {
            Some(misfits) => Some(misfits.share(&|at| codes.contains(&set.fit.candidates[at].effect.code))),
            None => {
                let base = sets.iter().find(|set| set.fit.candidates.is_empty())?;
                let expected = freedom(&self.search.problem.used, &self.search.base);
                explained(base.fit.square, expected, set.fit.square)
            }
        }
    }

    /// True where the discrepancy takes an effect of a set back, at least in part. The two know nothing
    /// of each other, and large ones that cancel are two wrongs.
    pub fn cancels(&self, set: &Weighed) -> bool {
        let Some(misfits) = self.misfits(set).seen() else { return false };
        (0..set.fit.candidates.len()).any(|effect| misfits.share(&|at| at == effect) < CANCELLED)
    }

    fn misfits<'s>(&'s self, set: &'s Weighed) -> Misfits<'s> {
        let problem = beside_its_solve(self.search, &set.fit);
        let (fit, found) = (&set.fit, &set.evidence.x);
        // the discrepancy takes most of a step of the base back: told together they stay small
        let is_base = |at: usize| !matches!(fit.coordinates[at], Coordinate::Of(..));
        let x = DVector::from_fn(found.len(), |at, _| if is_base(at) { fit.x[at] } else { found[at] });
        let model = problem.model(&fit.coordinates, &fit.candidates, &x);
        let amounts = amounts(&set.linearised(), &set.evidence, self.discrepancy);
        let mut beside_n = amounts.map_or_else(|| DVector::zeros(self.forces_n.nrows()), |of| &self.forces_n * of);
        let forces_n = |model: &Model| predicted(problem.design, problem.chain, model, &problem.contacts_mm).concat();
        let here_n = forces_n(&model);
        for at in (0..found.len()).filter(|at| is_base(*at)) {
            let mut moved = x.clone();
            let step = fit.coordinates[at].step();
            moved[at] += step;
            let there_n = forces_n(&problem.model(&fit.coordinates, &fit.candidates, &moved));
            let by = (found[at] - fit.x[at]) / step;
            beside_n
                .iter_mut()
                .zip(there_n.iter().zip(&here_n))
                .for_each(|(n, (there, here))| *n += by * (there - here));
        }
        let effects = set.fit.candidates.len();
        let misfit_n = self.left_n(&model, &beside_n);
        Misfits { shares: self, effects, model, beside_n, misfit_n }
    }

    /// Root mean square of what a plain fit of the base leaves of a model's forces with a discrepancy
    /// beside them, N.
    fn left_n(&self, model: &Model, beside_n: &DVector<f64>) -> f64 {
        let problem = &self.search.problem;
        let forces_n = predicted(problem.design, problem.chain, model, &problem.contacts_mm);
        let mut data: Design = problem.design.clone();
        for (s, (series, forces_n)) in data.series.iter_mut().zip(&forces_n).enumerate() {
            let first = problem.whitening.first(s);
            for (k, node) in series.nodes.iter_mut().enumerate() {
                node.force_n = forces_n[k] + beside_n[first + k];
            }
        }
        let with = Model::base(model.mu_mpa, model.alpha);
        Plainly { design: &data, chain: problem.chain, with: &with }.left_of_base_n()
    }
}

/// What one set leaves to explain.
struct Misfits<'a> {
    shares: &'a Shares<'a>,
    effects: usize,
    model: Model,
    beside_n: DVector<f64>,
    misfit_n: f64,
}

impl Misfits<'_> {
    /// None where the misfit shows in no force.
    fn seen(self) -> Option<Self> {
        (self.misfit_n > SEEN * self.shares.search.problem.largest_n()).then_some(self)
    }

    /// Share of the misfit that goes without some effects.
    fn share(&self, of: &dyn Fn(usize) -> bool) -> f64 {
        let kept: Vec<usize> = (0..self.effects).filter(|at| !of(*at)).collect();
        let without_n = self.shares.left_n(&only(&self.model, &kept, self.effects), &self.beside_n);
        1.0 - (without_n / self.misfit_n).powi(2)
    }
}

/// A model that has some of its effects only. What finite elements add is known of all together.
fn only(model: &Model, places: &[usize], effects: usize) -> Model {
    let is_kept = |at: usize| at >= effects || places.contains(&at);
    let settings: Vec<_> = model.settings.iter().enumerate().filter(|(at, _)| is_kept(*at)).collect();
    let settings: Vec<_> = settings.into_iter().map(|(_, setting)| setting.clone()).collect();
    let whole = model.whole.clone().filter(|_| settings.len() == model.settings.len());
    Model { settings, whole, ..model.clone() }
}
