//! What data could tell of an effect: whether a plausible amount of it would be seen.

use nalgebra::DVector;

use super::weigh::Weighed;
use super::{Fitted, Forward, Groups};
use crate::infer::evidence::{Linearised, evidence};
use crate::infer::product::beside;

/// Deviations that noise takes off in one case of ten.
const POWER: f64 = 1.28;
/// Logarithm of the odds from which on something is wrong for certain: a hundred.
const SURE: f64 = 4.6;

/// True where a plausible amount of an effect, of one of the shapes that it may have, would be seen in nine
/// cases of ten: as itself, or as a discrepancy without a name.
#[must_use]
pub fn is_visible<F: Forward>(
    of: &F,
    base: &Weighed<F::Fit>,
    groups: &Groups,
    effect: &<F::Fit as Fitted>::Effect,
) -> bool {
    let (signature, amount) = of.signature(&base.fit, effect);
    let model = base.linearised();
    let gain = |shape: DVector<f64>| {
        let without = Linearised { residual: &shape, ..model.clone() };
        let jacobian =
            beside(shape.len(), [model.jacobian, &nalgebra::DMatrix::from_columns(std::slice::from_ref(&shape))]);
        let mut parameters = model.parameters.clone();
        parameters.push(amount);
        let with = Linearised { residual: &shape, jacobian: &jacobian, parameters, known: model.known };
        let nameless = evidence(&without, &groups.discrepancy, &[])?;
        let named = evidence(&with, &groups.discrepancy, &[])?;
        Some((named.log + of.log_odds(effect)).max(nameless.log) - nameless.alone)
    };
    let most = signature.column_iter().filter_map(|shape| gain(shape.into_owned())).fold(0.0, f64::max);
    most - POWER * (2.0 * most).sqrt() > SURE
}
