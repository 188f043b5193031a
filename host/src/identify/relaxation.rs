//! How far the force falls while the ball stands.

use std::ops::Range;

use crate::experiment::Recording;
use crate::experiment::motion::noise_of;

/// A fall of this share of the force counts, and of this many times the noise.
const LEAST_SHARE: f64 = 0.02;
const LEAST_SIGMA: f64 = 5.0;
/// Part of a hold at its end whose mean is where the force falls to.
const END: usize = 10;

/// A fall of the force in a hold.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fall {
    /// Share of the force at the beginning of the hold.
    pub share: f64,
    /// Length of the hold, s.
    pub lasts_s: f64,
}

/// The fall of the force in a hold, where noise is not all of it.
#[must_use]
pub fn fall(recording: &Recording, hold: Range<usize>) -> Option<Fall> {
    let (force, time) = (recording.force_n.get(hold.clone())?, recording.time_s.get(hold)?);
    if force.len() < 2 * END {
        return None;
    }
    let end = &force[force.len() - force.len() / END..];
    // The largest of the first readings: the ball may still arrive.
    let begin = force[..force.len() / END].iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let fall = begin - end.iter().sum::<f64>() / end.len() as f64;
    let share = fall / begin;
    let visible = begin > 0.0 && share > LEAST_SHARE && fall > LEAST_SIGMA * noise_of(force);
    visible.then(|| Fall { share, lasts_s: time[time.len() - 1] - time[0] })
}
