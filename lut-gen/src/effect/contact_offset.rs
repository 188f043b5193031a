//! A contact that was found too late, or too early, in every run.

use super::{Effect, Owner, Quantity, Stage};

/// The recorded depth misses the true one by a constant.
pub const EFFECT: Effect = Effect {
    code: "contact-offset",
    form: "constant",
    stage: Stage::Machine,
    assumption: "depth 0 is the contact, to the scatter of the contact points",
    signature: "like dF/dd near contact, the same depth for all rates and balls",
    twins: &["lag", "adhesion"],
    separated_by: "a pair of rates",
    quantities: &[Quantity::amplitude("offset_mm", 0.0, (-0.4, 0.4), 0.05, &[0.0])],
    owner: Owner::All,
};
