//! Readings far off their neighbours, one or two in a row.

use crate::experiment::Recording;
use crate::experiment::signal::{noise_of, usual_rise};

use super::Signal;

/// A glitch lies this many times the noise around it off the line between its neighbours.
const SIGMA: f64 = 12.0;
/// And this share of the column's range without it, so that no digit of a coarse converter is one.
const SHARE: f64 = 0.02;
/// And this many times as far as the larger steps from reading to reading around it go.
const STEPS: f64 = 2.0;
/// Its neighbours differ from one another by less than this share of that.
const AGREE: f64 = 0.3;
/// Readings on either side that the noise around it is taken from.
const AROUND: usize = 15;
/// Longest glitch, in readings.
const LONGEST: usize = 2;

/// Samples of a column that are glitches, rising.
///
/// The other column must go on smoothly meanwhile: what both show was there.
pub(super) fn found(recording: &Recording, signal: Signal) -> Vec<usize> {
    let values = signal.of(recording);
    let other = match signal {
        Signal::Depth => Signal::Force.of(recording),
        Signal::Force => Signal::Depth.of(recording),
    };
    let (range, its_range) = (usual_range(values), usual_range(other));
    let mut found = Vec::new();
    let mut at = 1;
    while at + 1 < values.len() {
        let length = (1..=LONGEST).find(|length| {
            stands_off(values, at, *length, range)
                && !other.get(at - 1..at + length + 1).is_some_and(|near| bends(near, its_range))
        });
        match length {
            Some(length) => {
                found.extend(at..at + length);
                at += length;
            }
            None => at += 1,
        }
    }
    found
}

/// True where so many readings from one on lie off the line between those around them, all to one side.
fn stands_off(values: &[f64], at: usize, length: usize, range: f64) -> bool {
    let Some(after) = values.get(at + length) else { return false };
    let before = values[at - 1];
    let off = |i: usize| {
        let share = (i + 1 - at) as f64 / (length + 1) as f64;
        values[i] - (before + share * (after - before))
    };
    let first = off(at);
    let all = (at..at + length).map(|i| off(i) * first.signum());
    let least = all.fold(f64::INFINITY, f64::min);
    if least <= SHARE * range {
        return false;
    }
    let left = &values[at.saturating_sub(AROUND)..at];
    let right = &values[at + length..(at + length + AROUND).min(values.len())];
    // Neighbours rise as they do elsewhere.
    let rise = (length + 1) as f64 * usual_rise(left).midpoint(usual_rise(right));
    if (after - before - rise).abs() > AGREE * least {
        return false;
    }
    // Noise that grows with the force counts where it is; a bend from one slope to another is no glitch.
    let noise = noise_of(left).max(noise_of(right));
    least > SIGMA * noise && least > STEPS * large_step(left).max(large_step(right))
}

/// Size of a step that four of five do not exceed: another glitch nearby hides none.
fn large_step(values: &[f64]) -> f64 {
    let mut steps: Vec<f64> = values.windows(2).map(|w| (w[1] - w[0]).abs()).collect();
    steps.sort_by(f64::total_cmp);
    steps.get(steps.len() * 4 / 5).copied().unwrap_or(0.0)
}

/// True where the other column shows as sharp a turn: a share of its range between neighbours.
fn bends(near: &[f64], range: f64) -> bool {
    let (Some(first), Some(last)) = (near.first(), near.last()) else { return false };
    let count = near.len() - 1;
    let off = |(i, value): (usize, &f64)| (value - (first + i as f64 / count as f64 * (last - first))).abs();
    near.iter().enumerate().map(off).fold(0.0, f64::max) > SHARE * range
}

/// From the first to the last but a hundredth of the readings on either side: what glitches do not widen.
fn usual_range(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let cut = (values.len() / 100).max(LONGEST).min(values.len() / 4);
    match (sorted.get(cut), sorted.get(values.len().saturating_sub(cut + 1))) {
        (Some(low), Some(high)) => high - low,
        _ => 0.0,
    }
}
