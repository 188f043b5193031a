//! A depth gauge of another gain.

use super::{Effect, FormError, Kind, Owner, Quantity, Share, Stage};

/// The recorded way is the true one times a constant, from the touch on.
///
/// For one ball on one height it is nearly another modulus and another exponent: `F ~ mu d^1.5` for small depths.
pub const EFFECT: Effect = Effect {
    code: "depth-gain",
    form: "constant",
    stage: Stage::Machine,
    kind: Kind::Machine,
    assumption: "the gain of the depth gauge is right",
    signature: "nearly none: it is mu, and alpha in a deep press",
    twins: &["sensor-gain", "radius"],
    separated_by: "the depth gauge on a block of known height",
    prior: "an extensometer of class 1 is within 1 % of its reading (ISO 9513), 0.6 % as the standard deviation of a limit",
    // a true way that is longer by more than the recorded one lies beyond what force models are made for
    quantities: &[Quantity::amplitude("gain", 1.0, (0.9, 1.12), 1.02, &[1.0]).about(0.006)],
    owner: Owner::All,
    form_error: FormError::of(Share::Outside, Share::Elastic),
};

/// True way (mm) of a recorded one (mm), both from the touch.
#[must_use]
pub fn true_mm(recorded_mm: f64, gain: f64) -> f64 {
    recorded_mm / gain
}
