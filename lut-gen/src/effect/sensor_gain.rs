//! A force sensor of another gain.

use super::{Effect, FormError, Kind, Owner, Quantity, Share, Stage};

/// The reading is the force times a constant.
pub const EFFECT: Effect = Effect {
    code: "sensor-gain",
    form: "constant",
    stage: Stage::Sensor,
    kind: Kind::Sensor,
    assumption: "the gain of the force sensor is right",
    signature: "none: it is mu",
    twins: &[],
    separated_by: "a mass, or a reference spring",
    prior: "a force-measuring system of class 1 is within 1 % (ISO 7500-1)",
    quantities: &[Quantity::amplitude("gain", 1.0, (0.5, 2.0), 1.05, &[1.0]).about(0.01)],
    owner: Owner::All,
    form_error: FormError::of(Share::Outside, Share::Elastic),
};
