//! Friction between ball and specimen, or between platens and a rubber that spreads on them.

use super::{Effect, FormError, Kind, Owner, Quantity, Share, Stage};

/// Coulomb friction under the ball, or on the platens (`chain::Rubbing`).
pub const EFFECT: Effect = Effect {
    code: "friction",
    form: "coulomb",
    stage: Stage::Contact,
    kind: Kind::Contact,
    assumption: "the ball, or a platen, is frictionless",
    signature: "changes sign with the direction of motion",
    twins: &["relaxation", "poisson", "second-term"],
    separated_by: "a slow against a fast loop; a lubricant",
    prior: "lubricated or powdered balls rub with 0.05 to 0.2, dry ones with 0.3 and more; a contact that is said to be frictionless is of the former kind (laboratory judgement)",
    quantities: &[Quantity::amplitude("coefficient", 0.0, (0.0, 1.0), 0.3, &[0.3, 0.8]).about(0.2)],
    owner: Owner::All,
    form_error: FormError::of(Share::Rough, Share::Rubbed),
};

/// Way back, as a share of the largest depth, from which on the ball counts as turned.
pub const TURN: f64 = 1e-3;
