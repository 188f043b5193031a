//! Softening with cycles: Mullins' effect.

use super::{Effect, FormError, Kind, Owner, Quantity, Share, Stage};

/// Ogden and Roxburgh (1999, doi:10.1098/rspa.1999.0431) on the whole indentation.
pub const EFFECT: Effect = Effect {
    code: "softening",
    form: "ogden-roxburgh",
    stage: Stage::Material,
    kind: Kind::History,
    assumption: "the specimen does not remember earlier presses",
    signature: "cycle number, unloading, a fresh against a used spot",
    twins: &["drift"],
    separated_by: "rest and repeat; a fresh spot; random order",
    prior: "a first press costs foams and filled rubbers a few percent of later ones (Ogden and Roxburgh 1999 model far larger losses, which show)",
    quantities: &[
        Quantity::amplitude("loss", 0.0, (0.0, 0.95), 0.1, &[0.2]).about(0.05),
        Quantity::shape("scale", (0.01, 100.0), 0.3, &[0.1, 0.5, 2.0]),
    ],
    owner: Owner::All,
    form_error: FormError::of(Share::Rough, Share::Softened),
};

/// Force while the largest depth of the spot is not exceeded: `F_e (1 - loss erf((1 - w) / scale))`, `w` the energy
/// stored at the depth as a share of that at the largest depth. The law is that of a material point; here the point is the whole
/// contact, and `scale` is what `(m + beta W_max) / W_max` is on the average of the points.
#[must_use]
pub fn factor(loss: f64, scale: f64, energy_share: f64) -> f64 {
    if energy_share >= 1.0 { 1.0 } else { 1.0 - loss * libm::erf((1.0 - energy_share) / scale) }
}

/// The law of a material point (`r`, `m / mu`, `beta`) whose contact softens about as [`factor`] does: `loss` is `1 / r` for both. The scale was read off
/// finite elements at depths of half the ball's radius; who solves these solves again at the point that a fit moves to.
#[must_use]
pub fn of_points(loss: f64, scale: f64) -> (f64, f64, f64) {
    const SCALE: f64 = 0.7;
    const M_OVER_MU: f64 = 0.0325;
    const POWER: f64 = 2.86;
    const BETA: f64 = 0.1;
    (1.0 / loss, M_OVER_MU * (scale / SCALE).powf(POWER), BETA)
}
