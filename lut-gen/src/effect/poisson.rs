//! Poisson's ratio of the foam.

use super::{Effect, Owner, Quantity, Stage};

/// Poisson's ratio is not 0.
pub const EFFECT: Effect = Effect {
    code: "poisson",
    form: "ratio",
    stage: Stage::Material,
    assumption: "Poisson's ratio of the foam is 0",
    signature: "nearly none: another alpha imitates it",
    twins: &["second-term", "friction"],
    separated_by: "two heights on a bonded base; confined compression",
    quantities: &[Quantity::amplitude("nu", 0.0, (0.0, 0.38), 0.1, &[0.1])],
    owner: Owner::All,
};
