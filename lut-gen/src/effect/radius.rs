//! A ball of another radius than declared.

use super::{Effect, FormError, Kind, Owner, Quantity, Share, Stage};

/// The radius of one ball is not the declared one.
pub const EFFECT: Effect = Effect {
    code: "radius",
    form: "one-ball",
    stage: Stage::Machine,
    kind: Kind::Geometry,
    assumption: "the balls have the declared radii",
    signature: "only between balls",
    twins: &["thickness"],
    separated_by: "gauge the ball; a third ball",
    prior: "a turned or printed ball of 4 mm is off by some hundredths of a millimetre, 1 %; bearing balls are a hundred times better",
    quantities: &[Quantity::amplitude("error_mm", 0.0, (-0.28, 0.32), 0.04, &[0.0]).about(0.01).of_radius()],
    owner: Owner::Indenter,
    form_error: FormError::of(Share::Outside, Share::Elastic),
};
