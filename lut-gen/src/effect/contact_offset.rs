//! A contact that was found too late, or too early, in every run.

use super::{Effect, FormError, Kind, Owner, Quantity, Share, Stage};

/// The recorded depth misses the true one by a constant.
pub const EFFECT: Effect = Effect {
    code: "contact-offset",
    form: "constant",
    stage: Stage::Machine,
    kind: Kind::Geometry,
    assumption: "depth 0 is the contact, to the scatter of the contact points",
    signature: "like dF/dd near contact, the same depth for all rates and balls",
    twins: &["lag", "adhesion"],
    separated_by: "a pair of rates",
    prior: "a trigger of 5 mN lies 0.03 mm past the touch of a ball of 4 mm on a foam of 0.1 MPa (Hertz's law)",
    quantities: &[Quantity::amplitude("offset_mm", 0.0, (-0.4, 0.4), 0.05, &[0.0]).about(0.03)],
    owner: Owner::All,
    form_error: FormError::of(Share::Outside, Share::Elastic),
};
