//! A force sensor that is not linear.

use super::{Effect, FormError, Kind, Owner, Quantity, Share, Stage};

/// The reading has a quadratic part.
pub const EFFECT: Effect = Effect {
    code: "sensor-nonlinearity",
    form: "quadratic",
    stage: Stage::Sensor,
    kind: Kind::Sensor,
    assumption: "the reading is linear in the force",
    signature: "a function of the force alone",
    twins: &["second-term"],
    separated_by: "materials of several stiffnesses at one force; masses",
    // at the largest reading `F + q F^2` a sensor may tell a third too little, or five eighths too much: what is farther off is none
    prior: "load cells are linear to 0.05 to 0.1 % of full scale, which is half a percent of the tenth that a palpation uses",
    quantities: &[Quantity::amplitude("quadratic_per_N", 0.0, (-0.5, 1.0), 0.02, &[-0.05, 0.05])
        .about(0.005)
        .per_force(-1)],
    owner: Owner::All,
    form_error: FormError::of(Share::Outside, Share::Elastic),
};
