//! An error of the simulation itself.

use super::{Effect, FormError, Kind, Owner, Quantity, Share, Stage};

/// The simulated force is off by a smooth share of itself that grows with depth.
pub const EFFECT: Effect = Effect {
    code: "numerics",
    form: "smooth",
    stage: Stage::Numerics,
    kind: Kind::Simulation,
    assumption: "the simulated force is exact to its stated bound",
    signature: "mesh or table cells, the edge of a table",
    twins: &["second-term"],
    separated_by: "a finer mesh; the table carries its own bound",
    prior: "the standard mesh is within 0.14 % of finer ones (docs/verification.md)",
    quantities: &[Quantity::amplitude("share", 0.0, (-0.003, 0.003), 0.002, &[0.0]).about(0.001)],
    owner: Owner::All,
    form_error: FormError::of(Share::Rough, Share::Elastic),
};
