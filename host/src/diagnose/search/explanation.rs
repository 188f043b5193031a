//! A fit that may be an explanation, and its score.

use super::form_error::is_rough;
use crate::diagnose::evidence::Adequacy;
use crate::diagnose::fit::Fit;
use crate::infer::presence::CHARGE;

/// Likelihood ratio of 100 as a difference of sums of squares.
pub const RATIO_100: f64 = 9.21;
/// A fit with what was found out about it.
#[derive(Debug, Clone)]
pub struct Explanation {
    /// The fit.
    pub fit: Fit,
    /// What it leaves.
    pub adequacy: Adequacy,
    /// It beats the largest of the catalogue in clean twins.
    pub beats_noise: bool,
    /// It predicts left-out conditions better.
    pub predicts: bool,
    /// It beats placebo effects.
    pub beats_placebo: bool,
    /// By how much (sum of squares, parameters charged) it is likelier than what has no cause in its place.
    pub beyond_causeless: f64,
    /// By how much its last effect lowers the sum of squares, what those before it may be wrong by discounted.
    pub gain: f64,
}

impl Explanation {
    /// Sum of squares with the charge for parameters.
    #[must_use]
    pub fn score(&self) -> f64 {
        score(&self.fit)
    }

    /// Every demand on a name is met.
    #[must_use]
    pub fn holds(&self) -> bool {
        self.adequacy.passes() && self.qualifies()
    }

    /// True when no effect of it is written down roughly only.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        self.fit.candidates.iter().all(|c| !is_rough(c, &self.fit))
    }

    /// Every demand but that of an adequate residual.
    #[must_use]
    pub fn qualifies(&self) -> bool {
        self.beats_noise && self.predicts && self.beats_placebo && !self.fit.at_bound && !self.fit.is_idle()
    }
}

/// Sum of squares of a fit with the charge for its parameters, nothing allowed for.
pub(in crate::diagnose) fn plain(fit: &Fit) -> f64 {
    fit.square + CHARGE * fit.coordinates.len() as f64
}

/// The same with what the effects may be wrong by allowed for and paid for, where that is likelier: an effect that is written down exactly needs no such freedom, and the price of that grows with all
/// that it adds, not with what is seen of it.
pub(in crate::diagnose) fn score(fit: &Fit) -> f64 {
    fit.discounted.min(fit.square) + CHARGE * fit.coordinates.len() as f64
}

/// What a fit's effects are, whatever their form.
pub(in crate::diagnose) fn names(fit: &Fit) -> Vec<(&'static str, usize)> {
    let mut names: Vec<_> = fit.candidates.iter().map(|c| (c.effect.code, c.owner)).collect();
    names.sort_unstable();
    names
}

/// The best first.
pub(super) fn sorted(mut list: Vec<Explanation>) -> Vec<Explanation> {
    list.sort_by(|a, b| a.score().total_cmp(&b.score()));
    list
}
