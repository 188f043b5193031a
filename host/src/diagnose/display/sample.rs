//! What the samples of a command are like.

use super::design::{Design, Series};

/// Changes below this share of the range are none.
const STILL: f64 = 2e-3;

/// What a sample is like.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    /// Level, as a share of the range.
    pub level: f64,
    /// It falls, or rests after it fell.
    pub is_falling: bool,
    /// It has moved since the run began.
    pub has_moved: bool,
    /// Largest level of the run.
    pub turn: f64,
    /// Signed change over time, in the unit of the channel over s; 0 at rest.
    pub rate: f64,
    /// Time since the last change, s, and what has changed since the rest before, as a share of the range.
    pub rest_s: f64,
    pub step: f64,
    /// Time in the run, as a share of the longest run.
    pub clock: f64,
}

/// What the samples of every run are like.
pub(super) fn samples(design: &Design) -> Vec<Vec<Sample>> {
    let inputs = || design.series.iter().flat_map(|s| s.input.iter().copied());
    let (low, high) = inputs().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
    let spans = design.series.iter().map(|s| s.time_s.last().zip(s.time_s.first()).map_or(0.0, |(b, a)| b - a));
    let longest_s = spans.fold(1e-9, f64::max);
    design.series.iter().map(|series| of_run(series, (low, (high - low).max(1e-12)), longest_s)).collect()
}

fn of_run(series: &Series, (low, range): (f64, f64), longest_s: f64) -> Vec<Sample> {
    let (time_s, input) = (&series.time_s, &series.input);
    let (Some(begin_s), Some(first)) = (time_s.first().copied(), input.first().copied()) else { return Vec::new() };
    let turn = (input.iter().copied().fold(f64::NEG_INFINITY, f64::max) - low) / range;
    let (mut changed_s, mut is_falling, mut has_moved) = (begin_s, false, false);
    // the last level that counts as another one, and the level from which it moved
    let (mut settled, mut departed) = (first, first);
    let mut out = Vec::with_capacity(input.len());
    for (k, x) in input.iter().enumerate() {
        let moved = x - settled;
        let is_moving = moved.abs() > STILL * range;
        let span_s = if k > 0 { (time_s[k] - time_s[k - 1]).max(1e-6) } else { f64::INFINITY };
        if is_moving {
            let turns = is_falling != (moved < 0.0);
            // a step begins after a rest, or where the motion turns
            if turns || time_s[k] - changed_s > 1.5 * span_s {
                departed = settled;
            }
            (changed_s, settled, is_falling, has_moved) = (time_s[k], *x, moved < 0.0, true);
        }
        out.push(Sample {
            level: (x - low) / range,
            is_falling,
            has_moved,
            turn,
            rate: if is_moving { moved / span_s } else { 0.0 },
            rest_s: time_s[k] - changed_s,
            step: (settled - departed) / range,
            clock: (time_s[k] - begin_s) / longest_s,
        });
    }
    out
}
