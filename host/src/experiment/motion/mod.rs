//! What the indenter did, read from the data: first loading branch, hold, unloading, rate.
//!
//! Nothing of this is declared in the files, because declarations are wrong more often than data
//! (a speed in a machine's summary may well be that of the retraction).

mod event;
mod press;

use std::ops::Range;

pub use super::signal::{noise_of, step_of};
pub use event::Event;

use super::Recording;
use super::signal::{extent, slope};
use event::force_drop;
use press::{find_slow_presses, pressing};

/// Below this share of the typical speed the indenter counts as standing.
const STANDING: f64 = 0.3;
/// A stretch that moves less than this share of the whole range is jitter or a controller's
/// undershoot and belongs to its neighbour.
const JITTER: f64 = 0.02;
/// A rise by less than this share of the whole range is not a loading branch.
const BRANCH: f64 = 0.25;
/// The branches of a run as ranges of samples.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// First loading branch.
    pub loading: Range<usize>,
    /// Speed of it, mm/s.
    pub rate_mm_per_s: f64,
    /// Standing at the deepest point right after it, if it stood.
    pub hold: Option<Range<usize>>,
    /// First way back after it, if there was one.
    pub unloading: Option<Range<usize>>,
    /// All loading branches of the run, the first among them.
    pub loadings: Vec<Range<usize>>,
    /// Unusual things within the first loading branch.
    pub events: Vec<Event>,
}

impl Motion {
    /// True when loading ends where the hold begins: no slip or fault ended it before.
    #[must_use]
    pub fn loading_is_whole(&self) -> bool {
        self.hold.as_ref().is_some_and(|hold| hold.start <= self.loading.end + 1)
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Way {
    Down,
    /// Down while the force rises, far slower than an approach before it.
    SlowlyDown,
    Still,
    Up,
}

#[derive(Debug, Clone)]
struct Stretch {
    way: Way,
    samples: Range<usize>,
}

/// Reads the branches of a run; `None` if the indenter never went down measurably.
pub fn of(recording: &Recording) -> Option<Motion> {
    let (time, depth) = (&recording.time_s, &recording.depth_mm);
    if depth.len() < 5 || depth.len() != time.len() {
        return None;
    }
    let (lowest, deepest) = extent(depth.iter().copied());
    let range = deepest - lowest;
    let noise = noise_of(depth);
    if range <= 10.0 * noise || range <= 0.0 {
        return None;
    }
    let speed = typical_speed(time, depth, lowest, range)?;
    let mut stretches = stretches(time, depth, speed, noise, range);
    find_slow_presses(&mut stretches, recording, noise);
    let travel = |s: &Stretch| depth[s.samples.end - 1] - depth[s.samples.start];
    let is_branch = |at: &usize| {
        let stretch = &stretches[*at];
        let presses_next = stretches.get(at + 1).is_some_and(|next| next.way == Way::SlowlyDown);
        let whole = stretch.way == Way::Down && travel(stretch) >= BRANCH * range && !presses_next;
        stretch.way == Way::SlowlyDown || whole
    };
    let branches: Vec<usize> = (0..stretches.len()).filter(is_branch).collect();
    let first = branches.first().copied().or_else(|| {
        (0..stretches.len())
            .filter(|&at| stretches[at].way == Way::Down)
            .max_by(|&a, &b| travel(&stretches[a]).total_cmp(&travel(&stretches[b])))
    })?;
    let mut loading = pressing(recording, stretches[first].samples.clone());
    let later = branches.iter().skip(1).map(|at| stretches[*at].samples.clone());
    let loadings = std::iter::once(loading.clone()).chain(later).collect();
    let mut events = Vec::new();
    let next = stretches.get(first + 1);
    let after = stretches.get(first + 2);
    let hold = next.filter(|s| s.way == Way::Still).map(|s| s.samples.clone());
    if let (Some(hold), Some(after)) = (&hold, after)
        && after.way == Way::Down
    {
        let pause_s = time[hold.end - 1] - time[hold.start];
        events.push(Event::Restarted { depth_mm: depth[hold.start], pause_s });
    }
    let unloading = stretches[first + 1..].iter().take(2).find(|s| s.way == Way::Up).map(|s| s.samples.clone());
    if let Some((at, event)) = force_drop(recording, &loading) {
        loading.end = at;
        events.push(event);
    }
    let rate_mm_per_s = slope(&time[loading.clone()], &depth[loading.clone()])?;
    Some(Motion { loading, rate_mm_per_s, hold, unloading, loadings, events })
}

/// Mean speed of the first way from a tenth to nine tenths of the range.
fn typical_speed(time: &[f64], depth: &[f64], lowest: f64, range: f64) -> Option<f64> {
    let end = depth.iter().position(|&d| d >= lowest + 0.9 * range)?;
    let start = (0..end).rev().find(|&i| depth[i] <= lowest + 0.1 * range).unwrap_or(0);
    let speed = (depth[end] - depth[start]) / (time[end] - time[start]);
    (speed.is_finite() && speed > 0.0).then_some(speed)
}

fn stretches(time: &[f64], depth: &[f64], speed: f64, noise: f64, range: f64) -> Vec<Stretch> {
    let count = depth.len();
    let step_s = (time[count - 1] - time[0]) / (count - 1) as f64;
    // Wide enough that noise cannot look like a third of the speed.
    let reach = (4.0 * noise / (STANDING * speed * step_s)).ceil();
    let reach = if reach.is_finite() { reach as usize } else { 1 };
    let reach = reach.max(held_readings(depth)).clamp(1, (count / 20).max(1));
    let ways = (0..count).map(|i| {
        let (a, b) = (i.saturating_sub(reach), (i + reach).min(count - 1));
        let velocity = (depth[b] - depth[a]) / (time[b] - time[a]);
        if velocity > STANDING * speed {
            Way::Down
        } else if velocity < -STANDING * speed {
            Way::Up
        } else {
            Way::Still
        }
    });
    let mut stretches: Vec<Stretch> = Vec::new();
    for (i, way) in ways.enumerate() {
        append(&mut stretches, Stretch { way, samples: i..i + 1 });
    }
    without_jitter(stretches, depth, JITTER * range, 2 * reach + 1)
}

/// Samples for which a depth reading usually stands before the next one, where the sensor is read less often than the file is
/// written: the 90th percentile of the lengths of equal readings on the way from a tenth to nine tenths of the range.
fn held_readings(depth: &[f64]) -> usize {
    let (low, high) = extent(depth.iter().copied());
    let inside = low + 0.1 * (high - low)..low + 0.9 * (high - low);
    let runs = depth.chunk_by(|a, b| a == b).filter(|run| inside.contains(&run[0]));
    let mut lengths: Vec<usize> = runs.map(<[f64]>::len).collect();
    lengths.sort_unstable();
    lengths.get(lengths.len() * 9 / 10).copied().unwrap_or(1)
}

fn append(stretches: &mut Vec<Stretch>, next: Stretch) {
    match stretches.last_mut() {
        Some(last) if last.way == next.way => last.samples.end = next.samples.end,
        _ => stretches.push(next),
    }
}

/// Gives stretches that hardly move and hardly last to the one before them.
fn without_jitter(stretches: Vec<Stretch>, depth: &[f64], least_mm: f64, least_samples: usize) -> Vec<Stretch> {
    let mut kept: Vec<Stretch> = Vec::new();
    for mut stretch in stretches {
        let samples = &stretch.samples;
        let moved = (depth[samples.end - 1] - depth[samples.start]).abs();
        let short = match stretch.way {
            Way::Still => samples.len() < least_samples,
            Way::Down | Way::SlowlyDown | Way::Up => moved < least_mm,
        };
        if short && let Some(last) = kept.last() {
            stretch.way = last.way;
        }
        append(&mut kept, stretch);
    }
    kept
}

#[cfg(test)]
mod tests;
