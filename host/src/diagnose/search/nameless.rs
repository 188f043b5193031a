//! Whether an elastic explanation does better than an elastic departure that has no name.

use lut_gen::effect::{
    adhesion, compliance, contact_offset, friction, nameless, numerics, poisson, radius, second_term, sensor_gain,
    sensor_nonlinearity, thickness,
};

use super::super::fit::{Candidate, Fit};
use super::{CHARGE, Explanation, Search, score};

/// Effects that are the same whatever the time, the direction and the history are.
const ELASTIC: [&str; 11] = [
    poisson::EFFECT.code,
    second_term::EFFECT.code,
    thickness::HEIGHT.code,
    radius::EFFECT.code,
    friction::EFFECT.code,
    adhesion::EFFECT.code,
    contact_offset::EFFECT.code,
    compliance::EFFECT.code,
    sensor_gain::EFFECT.code,
    sensor_nonlinearity::EFFECT.code,
    numerics::EFFECT.code,
];

impl Search<'_> {
    /// By how much (sum of squares, parameters charged) an explanation is likelier than an elastic departure without a name in its place; none where it has a part that
    /// is not elastic.
    ///
    /// What its form may be wrong by is allowed for or not, whichever is better for it: a departure without a name has no form to be wrong by.
    #[must_use]
    pub fn likelier_than_nameless(&self, best: &Explanation) -> Option<f64> {
        if !best.fit.candidates.iter().all(|c| ELASTIC.contains(&c.effect.code)) {
            return None;
        }
        let nameless = self.extended(&self.base, &Candidate { effect: &nameless::EFFECT, owner: 0 });
        let plain = |fit: &Fit| fit.square + CHARGE * fit.coordinates.len() as f64;
        Some(f64::max(score(&nameless) - best.score(), plain(&nameless) - plain(&best.fit)))
    }
}
