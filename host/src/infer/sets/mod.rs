//! Sets of effects, compared by their evidence. What a model is, its parameters and its effects are
//! the user's; here is what they have in common.
//!
//! ```text
//! weigh    a set with its evidence and its odds before the data
//! search   which sets are compared: those that the evidence leads to
//! shares   what effects explain of the misfit
//! judged   from the evidence of sets to what is believed of effects
//! visible  whether a plausible amount would be believed
//! verdict  from what is believed to names
//! weighing the whole of it in one noise
//! ```

mod judged;
mod search;
mod shares;
mod verdict;
mod visible;
mod weigh;
mod weighing;

use nalgebra::{DMatrix, DVector};

use super::evidence::{Discrepancy, Linearised, Parameter, Sizes};
use super::product::beside;

pub use judged::{Belief, Judged, Told, Wider};
pub use search::led;
pub use shares::{Known, Misfits, Shares};
pub use verdict::Outcome;
pub use weigh::{Weighed, level};
pub use weighing::Weighing;

/// How far (logarithm) behind the likeliest set another may lie to count: one in a million.
pub const BEHIND: f64 = 14.0;

/// A fit of a base with some effects.
pub trait Fitted: Clone + Send + Sync {
    /// One effect in one form.
    type Effect: Copy + PartialEq + Send + Sync;

    /// The effects of the set.
    fn effects(&self) -> &[Self::Effect];

    /// The model about the fit; `known` are columns of what its effects may be wrong by.
    fn linearised<'a>(&'a self, known: &'a DMatrix<f64>) -> Linearised<'a>;
}

/// What is asked of a model whose effects are to be found, in one noise.
pub trait Forward: Sync {
    /// A fit of the base with effects.
    type Fit: Fitted;
    /// What the forms of an effect share.
    type Name: Copy + Eq + Send + Sync;

    /// The base, fitted.
    fn base(&self) -> &Self::Fit;

    /// Effects that may be there, each form and each owner by itself.
    fn effects(&self) -> &[Effect<Self>];

    /// Name of an effect.
    fn name(&self, effect: &Effect<Self>) -> Self::Name;

    /// True for two forms of one effect of one owner.
    fn is_form_of(&self, one: &Effect<Self>, other: &Effect<Self>) -> bool;

    /// True where an effect may stand beside others.
    fn may_join(&self, set: &[Effect<Self>], effect: &Effect<Self>) -> bool;

    /// Logarithm of the odds before the data.
    fn log_odds(&self, effect: &Effect<Self>) -> f64;

    /// The best fit of a set with one effect more; none where there is none.
    fn extended(&self, from: &Self::Fit, effect: &Effect<Self>) -> Option<Self::Fit>;

    /// A fit that was made in another noise, where it stands.
    fn again(&self, fit: &Self::Fit) -> Self::Fit;

    /// Whitened columns of what the effects of a fit may be wrong by as they are written down.
    fn form_error(&self, fit: &Self::Fit) -> DMatrix<f64>;

    /// What an effect changes beside a fit, whitened, a column for each shape that it may have, and its
    /// amount in the unit of these.
    fn signature(&self, at: &Self::Fit, effect: &Effect<Self>) -> (DMatrix<f64>, Parameter);
}

/// An effect of a model.
pub type Effect<F> = <<F as Forward>::Fit as Fitted>::Effect;

/// What a group is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// The model.
    Misfit,
    /// What differs between repeats: no misfit of the model.
    Scatter,
    /// Noise that few repeats may have told too small: nothing is wrong.
    Noise,
}

/// What a model may be wrong by without a name: one smooth function of what was varied, with a size of
/// its own.
#[derive(Debug, Clone)]
pub struct Group {
    /// What it varies with, for reports.
    pub over: &'static str,
    /// What it is of.
    pub kind: Kind,
    /// Columns for a size of one, in the unit of the readings.
    pub readings: DMatrix<f64>,
    /// The same whitened.
    pub columns: DMatrix<f64>,
}

/// All groups of a design.
#[derive(Debug, Clone)]
pub struct Groups {
    /// The groups, in the order of the sizes of a set's evidence.
    pub each: Vec<Group>,
    /// What sets are weighed beside.
    pub discrepancy: Discrepancy,
}

impl Groups {
    /// Of some rows, with the sizes that each group may have.
    #[must_use]
    pub fn new(rows: usize, each: Vec<Group>, sizes: Sizes) -> Self {
        let noise = (0..each.len()).filter(|at| each[*at].kind == Kind::Noise).collect();
        let discrepancy = Discrepancy::new(rows, each.iter().map(|group| &group.columns), sizes).with_noise(noise);
        Self { each, discrepancy }
    }

    /// Columns of all groups in the unit of the readings; nothing of what is no misfit.
    fn readings(&self, rows: usize) -> DMatrix<f64> {
        let mut all = beside(rows, self.each.iter().map(|group| &group.readings));
        let mut at = 0;
        for group in &self.each {
            let own = group.readings.ncols();
            if group.kind != Kind::Misfit {
                all.columns_mut(at, own).fill(0.0);
            }
            at += own;
        }
        all
    }

    /// What groups vary with whose columns, of some amounts, move the readings, the largest first.
    #[must_use]
    pub fn largest(&self, amounts: &DVector<f64>) -> Vec<&'static str> {
        let mut at = 0;
        let mut all: Vec<(&'static str, f64)> = Vec::new();
        for group in &self.each {
            let own = amounts.rows(at, group.readings.ncols());
            at += group.readings.ncols();
            if group.kind != Kind::Noise {
                all.push((group.over, (&group.readings * own).norm()));
            }
        }
        all.retain(|(_, size)| *size > 0.0);
        all.sort_by(|a, b| b.1.total_cmp(&a.1));
        all.into_iter().map(|(over, _)| over).collect()
    }
}
