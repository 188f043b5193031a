//! Whether an elastic explanation does better than an elastic departure that has no name.

use lut_gen::effect::{
    adhesion, compliance, contact_offset, friction, nameless, numerics, poisson, radius, second_term, sensor_gain,
    sensor_nonlinearity, thickness,
};

use super::super::fit::Candidate;
use super::{Explanation, RATIO_100, Search, plain, score};

/// Effects that claim a form of the foam's elastic law.
const LAWS: [&str; 2] = [poisson::EFFECT.code, second_term::EFFECT.code];
/// Other effects that are the same whatever the time, the direction and the history are.
const STATIC: [&str; 9] = [
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
    /// By how much (sum of squares, parameters charged) an explanation is likelier than it must be against an elastic departure without a name in its place; none where it
    /// has a part that is not elastic.
    ///
    /// Of elastic laws there is no end, so that one of those with a name must be a hundred times likelier than any. A wrong radius, or a machine that gives way, has one
    /// form: it must be no less likely. What that form may be wrong by is allowed for or not, whichever is better for it: a departure without a name has none to be wrong by.
    #[must_use]
    pub fn beyond_nameless(&self, best: &Explanation) -> Option<f64> {
        let codes = || best.fit.candidates.iter().map(|c| c.effect.code);
        if !codes().all(|code| LAWS.contains(&code) || STATIC.contains(&code)) {
            return None;
        }
        let needed = if codes().any(|code| LAWS.contains(&code)) { RATIO_100 } else { 0.0 };
        let nameless = self.extended(&self.base, &Candidate { effect: &nameless::EFFECT, owner: 0 });
        let likelier = f64::max(score(&nameless) - best.score(), plain(&nameless) - plain(&best.fit));
        Some(likelier - needed)
    }
}
