//! Steel that remembers.

use super::{Effect, Quantity, Stage};
use crate::diagnose::display::channel::Channel;

/// Flux stays behind when the current falls: a Duhem loop that closes over a coercive change of current.
pub const EFFECT: Effect = Effect {
    code: "remanence",
    form: "loop",
    channel: Channel::Flux,
    stage: Stage::Core,
    assumption: "flux depends on the current of the moment",
    signature: "changes sign with the direction of the current; flux is left at zero current",
    twins: &["saturation"],
    separated_by: "loops from zero to several peaks and back",
    quantities: &[
        Quantity {
            name: "remanence_T",
            null: Some(0.0),
            bounds: (0.0, 0.3),
            plausible: 0.003,
            starts: &[0.002, 0.01],
            logarithmic: false,
        },
        Quantity {
            name: "coercive_A",
            null: None,
            bounds: (0.05, 5.0),
            plausible: 0.3,
            starts: &[0.1, 0.4],
            logarithmic: true,
        },
    ],
};

/// What is added (T) to the flux of the moment: -`remanence_t` while the current rises, + while it falls, turning over `coercive_a`.
#[must_use]
pub fn left(current_a: &[f64], (remanence_t, coercive_a): (f64, f64)) -> Vec<f64> {
    let mut turned = 0.0;
    let mut before_a = current_a.first().copied().unwrap_or(0.0);
    current_a
        .iter()
        .map(|now_a| {
            let (moved, to) = ((now_a - before_a).abs(), (now_a - before_a).signum());
            turned = to + (turned - to) * (-moved / coercive_a).exp();
            before_a = *now_a;
            -remanence_t * turned
        })
        .collect()
}
