//! What effects explain of the misfit, in newtons as a user would see it.
//!
//! The misfit is what a plain fit of the base leaves of the model's own forces: with the effects, at
//! the amounts that the evidence has, and with the discrepancy that it puts beside them. The share
//! of some effects is the part of its square that goes without them. Noise and the scatter of spots
//! are in neither, and contact points stay where they are.

use std::cell::OnceCell;

use lut_gen::chain::Model;
use nalgebra::{DMatrix, DVector};

use super::discrepancy::Group;
use super::search::BEHIND;
use super::weigh::{Weighed, beside_its_solve};
use crate::diagnose::check::Check;
use crate::diagnose::coordinate::Coordinate;
use crate::diagnose::design::Design;
use crate::diagnose::fit::{explained, freedom, predicted};
use crate::diagnose::plain::Plainly;
use crate::diagnose::search::Search;
use crate::infer::evidence::{Discrepancy, amounts};
use crate::infer::product::beside;

/// Root mean square of a misfit, as a part of the largest force, below which it shows in no force:
/// the base takes it up, and runs without a ball on the specimen tell.
const SEEN: f64 = 1e-4;

/// Share of an effect below which the discrepancy takes it back: without it the square of the misfit
/// would be larger by half.
const CANCELLED: f64 = -0.5;

/// Sets that were weighed, with what their effects explain.
pub(super) struct Shares<'a> {
    search: &'a Search<'a>,
    discrepancy: &'a Discrepancy,
    known: Known,
}

/// What is known of sets, apart from what they were weighed in.
pub(super) struct Known {
    /// The likeliest first.
    pub sets: Vec<Weighed>,
    /// What each leaves to explain, once that is asked for.
    misfits: Vec<OnceCell<Misfit>>,
    /// Columns of the discrepancy, N; nothing of what differs between spots.
    forces_n: DMatrix<f64>,
}

/// What a set leaves to explain.
struct Misfit {
    /// The base at its fit with the effects at the amounts of the evidence.
    model: Model,
    /// Amounts of the discrepancy's columns; none where a number is none.
    amounts: Option<DVector<f64>>,
    /// The discrepancy, and the step of the base that goes with it, N.
    beside_n: DVector<f64>,
    /// Root mean square beyond the base, N.
    left_n: f64,
}

impl<'a> Shares<'a> {
    /// Of sets that were weighed beside groups of discrepancies; without those likely ones in which an
    /// effect and the discrepancy cancel.
    pub fn new(search: &'a Search<'a>, groups: &[Group], discrepancy: &'a Discrepancy, mut sets: Vec<Weighed>) -> Self {
        sets.sort_by(|a, b| b.log.total_cmp(&a.log));
        let mut forces_n = beside(search.problem.whitening.residuals(), groups.iter().map(|group| &group.forces_n));
        let mut at = 0;
        for group in groups {
            if group.is_scatter {
                forces_n.columns_mut(at, group.forces_n.ncols()).fill(0.0);
            }
            at += group.forces_n.ncols();
        }
        let misfits = sets.iter().map(|_| OnceCell::new()).collect();
        Self::of_known(search, discrepancy, Known { sets, misfits, forces_n }).sound()
    }

    /// The same of what is known already.
    pub fn of_known(search: &'a Search<'a>, discrepancy: &'a Discrepancy, known: Known) -> Self {
        Self { search, discrepancy, known }
    }

    /// What is known of the sets.
    pub fn into_known(self) -> Known {
        self.known
    }

    /// What the sets were weighed beside.
    pub fn discrepancy(&self) -> &'a Discrepancy {
        self.discrepancy
    }

    /// The sets, the likeliest first.
    pub fn sets(&self) -> &[Weighed] {
        &self.known.sets
    }

    /// Of effects of some codes, in the likeliest set that has as many of them as any; none where no
    /// set has one, or nothing is left without them.
    pub fn of(&self, codes: &[&'static str]) -> Option<f64> {
        let at = self.likeliest_with(codes)?;
        let fit = &self.known.sets[at].fit;
        match self.seen(at) {
            Some(misfit) => Some(self.share(at, misfit, |effect| codes.contains(&fit.candidates[effect].effect.code))),
            None => {
                let base = self.known.sets.iter().find(|set| set.fit.candidates.is_empty())?;
                let expected = freedom(&self.search.problem.used, &self.search.base);
                explained(base.fit.square, expected, fit.square)
            }
        }
    }

    /// Root mean square of what some effects explain, N; none where that is nothing.
    pub fn explained_n(&self, codes: &[&'static str]) -> Option<f64> {
        let at = self.likeliest_with(codes)?;
        let share = self.of(codes).filter(|share| *share > 0.0)?;
        Some(share.sqrt() * self.seen(at)?.left_n)
    }

    /// What the likeliest set leaves without a name: root mean square of what stays of its forces, and of the
    /// discrepancy beside them, once `mu` and `alpha` are fitted again beside its effects, as a share of
    /// the force; none where nothing is beside it but what spots differ by.
    pub fn left_share(&self) -> Option<f64> {
        self.known.sets.first().filter(|set| !set.is_alone(self.discrepancy))?;
        let Misfit { model, beside_n, .. } = self.misfit(0);
        let forces_n = self.forces_n(model);
        let nodes = self.search.problem.design.series.iter().flat_map(|series| &series.nodes);
        let counted = nodes.zip(&forces_n).filter(|(node, _)| !node.lifted);
        let whole: f64 = counted.map(|(node, n)| node.samples.max(1) as f64 * n * n).sum();
        let (_, left, _) = self.near(model, &forces_n, beside_n);
        let share = (left / whole).sqrt();
        (share.is_finite() && share > 0.0).then_some(share)
    }

    /// What the discrepancies of the likeliest set vary with, the largest first.
    pub fn left_over(&self, groups: &[Group]) -> Vec<&'static str> {
        let best = self.known.sets.first().map(|_| self.misfit(0));
        let Some(amounts) = best.and_then(|misfit| misfit.amounts.as_ref()) else { return Vec::new() };
        let mut at = 0;
        let mut all: Vec<(&'static str, f64)> = Vec::new();
        for group in groups {
            let own = amounts.rows(at, group.forces_n.ncols());
            at += group.forces_n.ncols();
            all.push((group.over, (&group.forces_n * own).norm()));
        }
        all.retain(|(_, size)| *size > 0.0);
        all.sort_by(|a, b| b.1.total_cmp(&a.1));
        all.into_iter().map(|(over, _)| over).collect()
    }

    /// The likeliest set that has as many of some effects as any.
    fn likeliest_with(&self, codes: &[&'static str]) -> Option<usize> {
        let has = |set: &Weighed| codes.iter().filter(|code| set.fit.codes().any(|c| c == **code)).count();
        let most = self.known.sets.iter().map(has).max().filter(|most| *most > 0)?;
        self.known.sets.iter().position(|set| has(set) == most)
    }

    /// Takes out what cancels; what is unlikely anyway counts for nothing.
    fn sound(mut self) -> Self {
        let mut best = f64::NEG_INFINITY;
        let mut kept = Vec::new();
        for (at, set) in self.known.sets.iter().enumerate() {
            let is_kept = set.fit.candidates.is_empty() || set.log < best - BEHIND || !self.cancels(at);
            if is_kept {
                best = best.max(set.log);
            }
            kept.push(is_kept);
        }
        retain(&mut self.known.sets, &kept);
        retain(&mut self.known.misfits, &kept);
        self
    }

    /// True where the discrepancy takes an effect of a set back, at least in part. The two know nothing
    /// of each other, and large ones that cancel are two wrongs.
    fn cancels(&self, at: usize) -> bool {
        let set = &self.known.sets[at];
        if set.is_alone(self.discrepancy) {
            return false;
        }
        let Some(misfit) = self.seen(at) else { return false };
        let effects = set.fit.candidates.len();
        let left_n = |own: Option<usize>| {
            let model = only(&misfit.model, |setting| setting >= effects || Some(setting) == own);
            self.left_n(&model, &self.forces_n(&model), &misfit.beside_n)
        };
        let without_n = left_n(None);
        // of what effects do to each other this says nothing
        (0..effects).any(|own| 1.0 - (without_n / left_n(Some(own))).powi(2) < CANCELLED)
    }

    /// Share of a set's misfit that goes without some of its effects.
    fn share(&self, at: usize, misfit: &Misfit, of: impl Fn(usize) -> bool) -> f64 {
        let effects = self.known.sets[at].fit.candidates.len();
        // a contact point that is fitted stands behind the effects
        let others = only(&misfit.model, |setting| setting >= effects || !of(setting));
        1.0 - (self.left_n(&others, &self.forces_n(&others), &misfit.beside_n) / misfit.left_n).powi(2)
    }

    fn misfit(&self, at: usize) -> &Misfit {
        self.known.misfits[at].get_or_init(|| self.found(&self.known.sets[at]))
    }

    /// The misfit of a set; none where it shows in no force.
    fn seen(&self, at: usize) -> Option<&Misfit> {
        let misfit = self.misfit(at);
        (misfit.left_n > SEEN * self.search.problem.largest_n()).then_some(misfit)
    }

    fn found(&self, set: &Weighed) -> Misfit {
        let problem = beside_its_solve(self.search, &set.fit);
        let (fit, found) = (&set.fit, &set.evidence.x);
        // the discrepancy takes most of a step of the base back: told together they stay small
        let is_alone = set.is_alone(self.discrepancy);
        let is_base = |at: usize| !is_alone && !matches!(fit.coordinates[at], Coordinate::Of(..));
        let x = DVector::from_fn(found.len(), |at, _| if is_base(at) { fit.x[at] } else { found[at] });
        let model_at = |x: &DVector<f64>| problem.model(&fit.coordinates, &fit.candidates, x);
        let model = model_at(&x);
        let here_n = self.forces_n(&model);
        let amounts = amounts(&set.linearised(), &set.evidence, self.discrepancy);
        let columns_n = &self.known.forces_n;
        let mut beside_n = match amounts.as_ref().filter(|_| !is_alone) {
            Some(amounts) => columns_n * amounts,
            None => DVector::zeros(columns_n.nrows()),
        };
        for at in (0..found.len()).filter(|at| is_base(*at)) {
            let step = fit.coordinates[at].step();
            let mut moved = x.clone();
            moved[at] += step;
            let by = (found[at] - fit.x[at]) / step;
            let there_n = self.forces_n(&model_at(&moved));
            let rows = beside_n.iter_mut().zip(there_n.iter().zip(&here_n));
            rows.for_each(|(n, (there, here))| *n += by * (there - here));
        }
        let left_n = self.left_n(&model, &here_n, &beside_n);
        Misfit { model, amounts, beside_n, left_n }
    }

    /// Forces of a model at the nodes of all runs, one after the other, N. Contact points of runs lie where the
    /// model has them all: what spots differ by is no misfit.
    fn forces_n(&self, model: &Model) -> Vec<f64> {
        let problem = &self.search.problem;
        predicted(problem.design, problem.chain, model, &vec![0.0; problem.design.series.len()]).concat()
    }

    /// Root mean square of what a plain fit of the base leaves of a model's forces with a discrepancy
    /// beside them, and of its readings without a ball on the specimen, N.
    fn left_n(&self, model: &Model, forces_n: &[f64], beside_n: &DVector<f64>) -> f64 {
        let data = self.search.problem.design;
        let with = Model::base(model.mu_mpa, model.alpha);
        let (base, square, samples) = self.near(&with, forces_n, beside_n);
        let beside: Vec<f64> = data.checks.iter().flat_map(|check| apart_n(check, model, &base)).collect();
        // a reading counts as much as a window of a run on the specimen does
        let nodes = data.series.iter().map(|series| series.nodes.len()).sum::<usize>().max(1) as f64;
        let weight = samples / nodes;
        let more: f64 = beside.iter().map(|n| weight * n * n).sum();
        ((square + more) / (samples + weight * beside.len() as f64).max(1.0)).sqrt()
    }

    /// A plain fit of a model's `mu` and `alpha` to forces with a discrepancy beside them: the model, its sum of
    /// squares, N2, and the number of samples.
    fn near(&self, with: &Model, forces_n: &[f64], beside_n: &DVector<f64>) -> (Model, f64, f64) {
        let mut data: Design = self.search.problem.design.clone();
        let nodes = data.series.iter_mut().flat_map(|series| &mut series.nodes);
        let rows = nodes.zip(forces_n.iter().zip(beside_n.iter()));
        rows.for_each(|(node, (force_n, more_n))| node.force_n = force_n + more_n);
        Plainly { design: &data, chain: self.search.problem.chain, with }.base_near()
    }
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

/// Keeps what is marked.
fn retain<T>(list: &mut Vec<T>, kept: &[bool]) {
    let mut kept = kept.iter();
    list.retain(|_| kept.next().is_some_and(|is_kept| *is_kept));
}
