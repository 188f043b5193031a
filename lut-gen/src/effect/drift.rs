//! A zero that drifts over the session.

use super::{Effect, FormError, Kind, Owner, Quantity, Share, Stage};

/// The zero of the sensor moves in proportion to the session clock.
pub const EFFECT: Effect = Effect {
    code: "drift",
    form: "linear",
    stage: Stage::Clock,
    kind: Kind::Clock,
    assumption: "the zero stays where it was",
    signature: "the session clock only",
    twins: &["softening"],
    separated_by: "an air run; a repeat at the end",
    prior: "zeros of load cells move by a few hundredths of a percent of full scale an hour or a kelvin; a palpation uses a tenth of that scale, and rooms warm by some kelvin",
    quantities: &[Quantity::amplitude("N_per_h", 0.0, (-20.0, 20.0), 0.05, &[0.0]).about(0.01).per_force(1)],
    owner: Owner::All,
    form_error: FormError::of(Share::Outside, Share::Elastic),
};

/// Zero of the sensor (N) at a time on the session clock (s).
#[must_use]
pub fn zero_n(n_per_h: f64, session_s: f64) -> f64 {
    n_per_h * session_s / 3600.0
}
