//! A clock of another rate.

use super::{Effect, FormError, Kind, Owner, Quantity, Share, Stage};

/// The recorded time is the true one times a constant. Only what has a time of its own can tell: relaxation, creep, lag and drift.
///
/// All of these scale alike, so that no run on a clock tells its gain, and no fit has it as a candidate.
pub const EFFECT: Effect = Effect {
    code: "time-gain",
    form: "constant",
    stage: Stage::Clock,
    kind: Kind::Clock,
    assumption: "the clock of the recording runs at its rate",
    signature: "none: it is the times of relaxation and lag",
    twins: &["relaxation", "lag"],
    separated_by: "a second clock",
    prior: "a crystal is within 0.01 %; sampling timed by software in a loop is off by up to 1 %, of which half is taken",
    quantities: &[Quantity::amplitude("gain", 1.0, (0.8, 1.25), 1.01, &[1.0]).about(0.005)],
    owner: Owner::All,
    form_error: FormError::of(Share::Outside, Share::Elastic),
};
