//! From what is believed of a channel to names.

use nalgebra::DVector;

use super::fit::Estimate;
use super::forward::Search;
use super::held_out::HeldOut;
use super::{ChannelDiagnosis, Finding, Judged, Weighed};
use crate::diagnose::Verdict;
use crate::infer::covariance::Z95;
use crate::infer::lowrank::Fold;
use crate::infer::sets::{Groups, Told};

/// Standard deviations beyond which what a set leaves is more than noise.
const IRREGULAR: f64 = 4.0;
/// Twice the amplitude of noise: laws that differ in form leave about as much as noise, and a set that leaves this is not what
/// the data are of.
const GROSS: f64 = 4.0;
/// Names may predict this much worse in the channel's unit, a run's own scatter taken off: they are weighed in the noise.
const WORSE: f64 = 1.1;

/// What the likeliest set and its discrepancies leave: sum of squares, what noise makes of it, and the scatter of that.
pub(super) struct Left {
    square: f64,
    expected: f64,
    scatter: f64,
}

impl Left {
    /// More than the noise of repeats, in no order that a discrepancy has.
    pub(super) fn is_irregular(&self) -> bool {
        self.square - self.expected > IRREGULAR * self.scatter
    }

    /// So much more that no name holds.
    pub(super) fn is_gross(&self) -> bool {
        self.is_irregular() && self.square > GROSS * self.expected
    }
}

/// What the likeliest set leaves.
pub(super) fn left(search: &Search<'_>, groups: &Groups, best: &Weighed) -> Left {
    let fit = &best.fit;
    let moved = DVector::from_iterator(fit.x.len(), best.evidence.x.iter().zip(fit.x.iter()).map(|(to, x)| to - x));
    let residual = &fit.residual - &fit.jacobian * moved;
    let left = Fold::of(groups.discrepancy.at(&best.evidence.sizes, &best.known)).taken_off(&residual);
    let design = search.problem.design;
    let used = design.series.iter().zip(&search.problem.used).filter(|(_, used)| **used);
    let count: usize = used.map(|(s, _)| s.count()).sum();
    let expected = count.saturating_sub(fit.x.len()).max(1) as f64;
    let scatter = expected * (2.0 / expected + 2.0 / search.noise.sensor_freedom.max(1.0)).sqrt();
    Left { square: left.norm_squared(), expected, scatter }
}

/// True where names hold: they predict what was left out better, in the noise and about as well in the channel's
/// unit, and no parameter ended at a bound.
pub(super) fn hold(held: &[Weighed], held_out: Option<&HeldOut>) -> bool {
    let predicts = held_out.is_none_or(|h| h.square_after < h.square_before && h.of_law.1 < WORSE * h.of_law.0);
    predicts && held.first().is_some_and(|best| !best.fit.at_bound)
}

/// What is named, of the likeliest set, each with what may stand in its place.
pub(super) fn findings(judged: &Judged, best: &Weighed) -> Vec<Finding> {
    let each = best.fit.effects.iter().enumerate().map(|(at, effect)| {
        let Told { probability, explains, twins } = judged.told(effect.code);
        Finding {
            code: effect.code,
            form: effect.form,
            parameters: best.estimates(Some(at)),
            ambiguous_with: twins,
            probability,
            explains,
        }
    });
    each.collect()
}

impl Weighed {
    /// Parameters with 95 % intervals, discrepancies allowed for: of the base, or of its `effect`-th effect.
    #[must_use]
    pub fn estimates(&self, effect: Option<usize>) -> Vec<Estimate> {
        let law = &self.fit.law;
        let range = match effect {
            None => 0..law.base.len(),
            Some(at) => {
                let start = law.base.len() + law.settings[..at].iter().map(|s| s.values.len()).sum::<usize>();
                start..start + law.settings[at].values.len()
            }
        };
        let each =
            range.map(|j| self.fit.coordinates[j].estimate(self.evidence.x[j], Z95 * self.evidence.deviations[j]));
        each.collect()
    }
}

/// The verdict on several channels: what nobody can name outweighs what has a name, and a channel that could be judged one that could not.
pub(super) fn together(channels: &[ChannelDiagnosis]) -> Verdict {
    let order = [Verdict::Unknown, Verdict::Ambiguous, Verdict::Named, Verdict::Clean, Verdict::Refused];
    let any = |verdict: &Verdict| channels.iter().any(|c| c.verdict == *verdict);
    order.into_iter().find(any).unwrap_or(Verdict::TooFewData)
}
