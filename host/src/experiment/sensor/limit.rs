//! A force that stands at its sensor's limit.

use crate::experiment::Recording;
use crate::experiment::signal::{noise_of, step_of};

/// Fewest readings in a row at the limit.
const LEAST: usize = 4;
/// Had the force gone on as before, it would have risen by this many times its noise and its resolution.
const MISSING: f64 = 8.0;
/// And by this share of the limit.
const MISSING_SHARE: f64 = 0.02;
/// Readings before the limit that its slope is taken from.
const BEFORE: usize = 8;

/// Where a sensor saturates.
pub(super) struct Limit {
    /// First sample at the limit.
    pub first: usize,
    /// How much deeper the ball goes while it lasts, mm.
    pub deeper_mm: f64,
}

/// The first stretch of readings that are all the largest of the run to the bit, while the ball goes so much deeper
/// that the force would have risen visibly.
pub(super) fn found(recording: &Recording) -> Option<Limit> {
    let (force, depth) = (recording.force_n.as_slice(), recording.depth_mm.as_slice());
    if depth.len() != force.len() || force.len() < LEAST + BEFORE {
        return None;
    }
    let highest = force.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let mut at = 0;
    while let Some(first) = (at..force.len()).find(|i| force[*i] == highest) {
        let length = force[first..].iter().take_while(|f| **f == highest).count();
        let deepest = depth[first..first + length].iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let deeper_mm = deepest - depth[first];
        if length >= LEAST && first >= BEFORE && deeper_mm > 0.0 {
            let before = first - BEFORE..first;
            let (rose, went) = (force[first] - force[before.start], depth[first] - depth[before.start]);
            let missing = deeper_mm * rose / went;
            let least = MISSING * noise_of(&force[before]).max(step_of(force));
            if went > 0.0 && missing > least.max(MISSING_SHARE * highest.abs()) {
                return Some(Limit { first, deeper_mm });
            }
        }
        at = first + length;
    }
    None
}
