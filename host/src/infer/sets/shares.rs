//! What effects explain of the misfit, as a user would see it.
//!
//! The misfit is what a plain fit of the base leaves of the model's own readings: with the effects, at
//! the amounts that the evidence has, and with the discrepancy that it puts beside them. The share
//! of some effects is the part of its square that goes without them. Noise and the scatter of repeats
//! are in neither.

use std::cell::OnceCell;

use nalgebra::{DMatrix, DVector};

use super::weigh::Weighed;
use super::{BEHIND, Fitted, Forward, Groups};
use crate::infer::evidence::amounts;

/// Share of an effect below which the discrepancy takes it back: without it the square of the misfit
/// would be larger by half.
const CANCELLED: f64 = -0.5;

/// What is asked of a model to tell what its effects explain.
pub trait Misfits: Forward {
    /// The model at some amounts.
    type Model;

    /// Number of readings.
    fn readings(&self) -> usize;

    /// The model of a set at the amounts of its evidence, and what the columns of a discrepancy, of
    /// some amounts, add to its readings. Where there are no amounts nothing is beside it.
    fn model(
        &self,
        set: &Weighed<Self::Fit>,
        columns: &DMatrix<f64>,
        amounts: Option<&DVector<f64>>,
    ) -> (Self::Model, DVector<f64>);

    /// Root mean square of what a plain fit of the base leaves of a model's readings, those of its
    /// effects, by number, that are kept, with something beside them.
    fn left(&self, model: &Self::Model, is_kept: &dyn Fn(usize) -> bool, beside: &DVector<f64>) -> f64;

    /// The same of what a plain fit of the base's parameters beside all effects leaves, as a share of the
    /// readings.
    fn left_share(&self, model: &Self::Model, beside: &DVector<f64>) -> f64;

    /// Root mean square of a misfit below which it shows in no reading.
    fn seen(&self) -> f64;

    /// What a fit takes off the sum of squares of the base, as a share of what that leaves beyond noise;
    /// none where it leaves no more.
    fn explained(&self, fit: &Self::Fit) -> Option<f64>;
}

/// Sets that were weighed, with what their effects explain.
pub struct Shares<'a, F: Misfits> {
    of: &'a F,
    groups: &'a Groups,
    known: Known<F>,
}

/// What is known of sets, apart from what they were weighed in.
pub struct Known<F: Misfits> {
    /// The likeliest first.
    pub sets: Vec<Weighed<F::Fit>>,
    /// What each leaves to explain, once that is asked for.
    misfits: Vec<OnceCell<Misfit<F::Model>>>,
    /// Columns of the discrepancy, in the unit of the readings; nothing of scatter.
    columns: DMatrix<f64>,
}

/// What a set leaves to explain.
struct Misfit<M> {
    model: M,
    /// Amounts of the discrepancy's columns; none where a number is none.
    amounts: Option<DVector<f64>>,
    /// The discrepancy.
    beside: DVector<f64>,
    /// Root mean square beyond the base.
    left: f64,
}

impl<'a, F: Misfits> Shares<'a, F> {
    /// Of sets that were weighed beside groups of discrepancies; without those likely ones in which an
    /// effect and the discrepancy cancel.
    #[must_use]
    pub fn new(of: &'a F, groups: &'a Groups, mut sets: Vec<Weighed<F::Fit>>) -> Self {
        sets.sort_by(|a, b| b.log.total_cmp(&a.log));
        let columns = groups.readings(of.readings());
        let misfits = sets.iter().map(|_| OnceCell::new()).collect();
        Self::of_known(of, groups, Known { sets, misfits, columns }).sound()
    }

    /// The same of what is known already.
    #[must_use]
    pub fn of_known(of: &'a F, groups: &'a Groups, known: Known<F>) -> Self {
        Self { of, groups, known }
    }

    /// What is known of the sets.
    #[must_use]
    pub fn into_known(self) -> Known<F> {
        self.known
    }

    /// What the sets were weighed beside.
    #[must_use]
    pub fn groups(&self) -> &'a Groups {
        self.groups
    }

    /// The model that the sets are of.
    pub(super) fn forward(&self) -> &'a F {
        self.of
    }

    /// The sets, the likeliest first.
    #[must_use]
    pub fn sets(&self) -> &[Weighed<F::Fit>] {
        &self.known.sets
    }

    /// Of effects of some names, in the likeliest set that has as many of them as any; none where no
    /// set has one, or nothing is left without them.
    #[must_use]
    pub fn share(&self, names: &[F::Name]) -> Option<f64> {
        let at = self.likeliest_with(names)?;
        let fit = &self.known.sets[at].fit;
        match self.seen(at) {
            Some(misfit) => {
                let is_one = |effect: usize| names.contains(&self.of.name(&fit.effects()[effect]));
                Some(self.without(misfit, is_one))
            }
            None => self.of.explained(fit),
        }
    }

    /// Root mean square of what some effects explain; none where that is nothing.
    #[must_use]
    pub fn explained(&self, names: &[F::Name]) -> Option<f64> {
        let at = self.likeliest_with(names)?;
        let share = self.share(names).filter(|share| *share > 0.0)?;
        Some(share.sqrt() * self.seen(at)?.left)
    }

    /// What the likeliest set leaves without a name: root mean square of what stays of its readings, and
    /// of the discrepancy beside them, once the base's parameters are fitted again beside its effects,
    /// as a share of the readings; none where nothing is beside it but scatter.
    #[must_use]
    pub fn left_share(&self) -> Option<f64> {
        self.known.sets.first().filter(|set| !set.is_alone(&self.groups.discrepancy))?;
        let Misfit { model, beside, .. } = self.misfit(0);
        let share = self.of.left_share(model, beside);
        (share.is_finite() && share > 0.0).then_some(share)
    }

    /// What the discrepancies of the likeliest set vary with, the largest first.
    #[must_use]
    pub fn left_over(&self) -> Vec<&'static str> {
        let best = self.known.sets.first().map(|_| self.misfit(0));
        let amounts = best.and_then(|misfit| misfit.amounts.as_ref());
        amounts.map_or_else(Vec::new, |amounts| self.groups.largest(amounts))
    }

    /// The likeliest set that has as many of some names as any.
    fn likeliest_with(&self, names: &[F::Name]) -> Option<usize> {
        let has = |set: &Weighed<F::Fit>| {
            let is_there = |name: &&F::Name| set.fit.effects().iter().any(|effect| self.of.name(effect) == **name);
            names.iter().filter(is_there).count()
        };
        let most = self.known.sets.iter().map(has).max().filter(|most| *most > 0)?;
        self.known.sets.iter().position(|set| has(set) == most)
    }

    /// Takes out what cancels; what is unlikely anyway counts for nothing.
    fn sound(mut self) -> Self {
        let mut best = f64::NEG_INFINITY;
        let mut kept = Vec::new();
        for (at, set) in self.known.sets.iter().enumerate() {
            let is_kept = set.is_base() || set.log < best - BEHIND || !self.cancels(at);
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
        if set.is_alone(&self.groups.discrepancy) {
            return false;
        }
        let Some(misfit) = self.seen(at) else { return false };
        let left = |own: Option<usize>| self.of.left(&misfit.model, &|effect| Some(effect) == own, &misfit.beside);
        let without = left(None);
        // of what effects do to each other this says nothing
        (0..set.fit.effects().len()).any(|own| 1.0 - (without / left(Some(own))).powi(2) < CANCELLED)
    }

    /// Share of a misfit that goes without some effects.
    fn without(&self, misfit: &Misfit<F::Model>, is_one: impl Fn(usize) -> bool) -> f64 {
        let left = self.of.left(&misfit.model, &|effect| !is_one(effect), &misfit.beside);
        1.0 - (left / misfit.left).powi(2)
    }

    fn misfit(&self, at: usize) -> &Misfit<F::Model> {
        self.known.misfits[at].get_or_init(|| self.found(&self.known.sets[at]))
    }

    /// The misfit of a set; none where it shows in no reading.
    fn seen(&self, at: usize) -> Option<&Misfit<F::Model>> {
        let misfit = self.misfit(at);
        (misfit.left > self.of.seen()).then_some(misfit)
    }

    fn found(&self, set: &Weighed<F::Fit>) -> Misfit<F::Model> {
        let discrepancy = &self.groups.discrepancy;
        let amounts = amounts(&set.linearised(), &set.evidence, discrepancy);
        let told = amounts.as_ref().filter(|_| !set.is_alone(discrepancy));
        let (model, beside) = self.of.model(set, &self.known.columns, told);
        let left = self.of.left(&model, &|_| true, &beside);
        Misfit { model, amounts, beside, left }
    }
}

/// Keeps what is marked.
fn retain<T>(list: &mut Vec<T>, kept: &[bool]) {
    let mut kept = kept.iter();
    list.retain(|_| kept.next().is_some_and(|is_kept| *is_kept));
}
