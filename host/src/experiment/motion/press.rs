//! The press within the motion: what goes in while the force rises, at its own speed.

use std::ops::Range;

use super::{BRANCH, Stretch, Way};
use crate::experiment::Recording;
use crate::experiment::signal::{extent, slope};

/// A way on of this many times the noise of the depth is one, however slow.
const SLOW_SIGMA: f64 = 20.0;
/// A press has begun where the force has risen by this share; an approach is as fast as the press unless it differs by this factor.
const RISEN: f64 = 0.02;
const OTHER_SPEED: f64 = 1.5;
/// Fewest samples of a press, and of an approach, that tell a speed.
const FEWEST: usize = 8;

/// Marks what stands beside a fast approach but goes in slowly: the ball goes on, and the force rises there as on a loading branch.
pub(super) fn find_slow_presses(stretches: &mut [Stretch], recording: &Recording, noise_mm: f64) {
    let (depth, force) = (&recording.depth_mm, &recording.force_n);
    if force.len() != depth.len() {
        return;
    }
    let (low, high) = extent(force.iter().copied());
    for stretch in stretches.iter_mut().filter(|stretch| stretch.way == Way::Still) {
        let (first, last) = (stretch.samples.start, stretch.samples.end - 1);
        let goes_on = depth[last] - depth[first] > SLOW_SIGMA * noise_mm;
        if goes_on && force[last] - force[first] > BRANCH * (high - low) {
            stretch.way = Way::SlowlyDown;
        }
    }
}

/// The part of a loading branch that goes on at the speed of the press: an approach at another one is no part of it.
pub(super) fn pressing(recording: &Recording, branch: Range<usize>) -> Range<usize> {
    let (time, depth, force) = (&recording.time_s, &recording.depth_mm, &recording.force_n);
    let own = force.get(branch.clone()).unwrap_or_default();
    let (low, high) = extent(own.iter().copied());
    let risen = own.iter().rposition(|f| *f < low + RISEN * (high - low)).map_or(0, |at| at + 1);
    let press = branch.start + risen..branch.end;
    if press.len() < FEWEST || risen < FEWEST {
        return branch;
    }
    let Some(speed) = slope(&time[press.clone()], &depth[press.clone()]) else { return branch };
    let reach = (press.len() / 4).clamp(1, FEWEST);
    let differs = |at: usize| {
        let local = (depth[at + reach] - depth[at]) / (time[at + reach] - time[at]);
        local > OTHER_SPEED * speed || local < speed / OTHER_SPEED
    };
    // Noise of the depth makes a short stretch differ; an approach at another speed is long.
    let far = (branch.start..press.start).rev().take_while(|at| at + reach < branch.end);
    let other: Vec<usize> = far.filter(|at| differs(*at)).collect();
    let Some(last) = other.first().copied() else { return branch };
    let before = &time[branch.start..=last];
    let approach = slope(before, &depth[branch.start..=last]).unwrap_or(speed);
    let is_other = approach > OTHER_SPEED * speed || approach < speed / OTHER_SPEED;
    if is_other && before.len() >= FEWEST { last + reach..branch.end } else { branch }
}
