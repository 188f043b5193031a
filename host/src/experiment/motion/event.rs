//! What is unusual on the way down: a stop, and a fall of the force.

use std::ops::Range;

use crate::experiment::Recording;
use crate::experiment::signal::{extent, noise_of, usual_rise};

/// A fall of force within one sample above this share of its range, while the indenter goes on
/// down, is a slip or a fault. It must also exceed [`JUMP_SIGMA`] times the noise, of the whole branch and of the
/// [`AROUND`] samples on either side: noise that is a part of the force is most of it where the force is large; and
/// [`RISES`] times the largest sudden rise: noise with long tails jumps up as far as down, what slips does not.
const JUMP: f64 = 0.04;
const JUMP_SIGMA: f64 = 8.0;
const AROUND: usize = 15;
const RISES: f64 = 2.0;

/// Something unusual on the way down.
#[derive(Debug, Clone, PartialEq)]
pub enum Event {
    /// The indenter stood still and then went on.
    Restarted {
        /// Depth where it stood, mm.
        depth_mm: f64,
        /// How long it stood, s.
        pause_s: f64,
    },
    /// Force fell within one sample although the indenter went on down.
    ForceDrop {
        /// Depth, mm.
        depth_mm: f64,
        /// Time, s.
        time_s: f64,
        /// By how much, N.
        drop_n: f64,
    },
}

impl std::fmt::Display for Event {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Event::Restarted { depth_mm, pause_s } => write!(
                f,
                "the indenter stood for {pause_s:.1} s at {depth_mm:.2} mm and went on; loading is used up to there"
            ),
            Event::ForceDrop { depth_mm, time_s, drop_n } => write!(
                f,
                "force falls by {drop_n:.3} N within one sample at {depth_mm:.2} mm ({time_s:.1} s) while the indenter goes on: a slip or a fault; loading is used up to there"
            ),
        }
    }
}

/// The first fall of the force within one sample of a loading branch, and where the branch ends for it.
pub(super) fn force_drop(recording: &Recording, loading: &Range<usize>) -> Option<(usize, Event)> {
    let force = recording.force_n.get(loading.clone())?;
    let (lowest, highest) = extent(force.iter().copied());
    let around = |at: usize| &force[at.saturating_sub(AROUND)..(at + 4 + AROUND).min(force.len())];
    let windows = || force.windows(4).enumerate();
    // Two samples on either side agree, so that one outlier is neither.
    let rise = |(at, w): (usize, &[f64])| w[2].min(w[3]) - w[0].max(w[1]) - usual_rise(around(at));
    let falls = |w: &[f64], by: f64| w[1] - w[2] > by && w[0].min(w[1]) - w[2].max(w[3]) > 0.5 * by;
    let least = (JUMP * (highest - lowest)).max(JUMP_SIGMA * noise_of(force));
    if !windows().any(|(_, w)| falls(w, least)) {
        return None;
    }
    let least = windows().map(rise).fold(least, |least, rise| least.max(RISES * rise));
    let (at, _) = windows().find(|(at, w)| falls(w, least) && falls(w, JUMP_SIGMA * noise_of(around(*at))))?;
    let sample = loading.start + at + 1;
    let event = Event::ForceDrop {
        depth_mm: recording.depth_mm[sample],
        time_s: recording.time_s[sample],
        drop_n: force[at + 1] - force[at + 2],
    };
    Some((sample + 1, event))
}
