//! What the indenter did, read from the data: first loading branch, hold, unloading, rate.
//!
//! Nothing of this is declared in the files, because declarations are wrong more often than data
//! (a speed in a machine's summary may well be that of the retraction).

use std::ops::Range;

use super::Recording;

/// Below this share of the typical speed the indenter counts as standing.
const STANDING: f64 = 0.3;
/// A stretch that moves less than this share of the whole range is jitter or a controller's
/// undershoot and belongs to its neighbour.
const JITTER: f64 = 0.02;
/// A rise by less than this share of the whole range is not a loading branch.
const BRANCH: f64 = 0.25;
/// A way on of this many times the noise of the depth is one, however slow.
const SLOW_SIGMA: f64 = 20.0;
/// A press has begun where the force has risen by this share; an approach is as fast as the press unless it differs by this factor.
const RISEN: f64 = 0.02;
const OTHER_SPEED: f64 = 1.5;
/// Fewest samples of a press, and of an approach, that tell a speed.
const FEWEST: usize = 8;
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

/// Noise of a smooth signal: standard deviation from the median absolute second difference, so
/// that neither a trend nor a few jumps count.
pub fn noise_of(signal: &[f64]) -> f64 {
    let bends = signal.windows(3).map(|w| (w[0] - 2.0 * w[1] + w[2]).abs());
    // 0.6745 is the median of |x| for unit normal x; a second difference has variance 6.
    median(bends) / 0.6745 / 6.0_f64.sqrt()
}

/// Resolution of a reading: the least difference between neighbours that differ; 0 where none do.
pub fn step_of(signal: &[f64]) -> f64 {
    let steps = signal.windows(2).map(|w| (w[1] - w[0]).abs()).filter(|step| *step > 0.0);
    let least = steps.fold(f64::INFINITY, f64::min);
    if least.is_finite() { least } else { 0.0 }
}

/// The upper of two middle values; 0 of none.
fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

/// Reads the branches of a run; `None` if the indenter never went down measurably.
pub fn of(recording: &Recording) -> Option<Motion> {
    let (time, depth) = (&recording.time_s, &recording.depth_mm);
    if depth.len() < 5 || depth.len() != time.len() {
        return None;
    }
    let lowest = depth.iter().copied().fold(f64::INFINITY, f64::min);
    let range = depth.iter().copied().fold(f64::NEG_INFINITY, f64::max) - lowest;
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

/// Marks what stands beside a fast approach but goes in slowly: the ball goes on, and the force rises there as on a loading branch.
fn find_slow_presses(stretches: &mut [Stretch], recording: &Recording, noise_mm: f64) {
    let (depth, force) = (&recording.depth_mm, &recording.force_n);
    if force.len() != depth.len() {
        return;
    }
    let (low, high) = force.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), f| (a.min(*f), b.max(*f)));
    for stretch in stretches.iter_mut().filter(|stretch| stretch.way == Way::Still) {
        let (first, last) = (stretch.samples.start, stretch.samples.end - 1);
        let goes_on = depth[last] - depth[first] > SLOW_SIGMA * noise_mm;
        if goes_on && force[last] - force[first] > BRANCH * (high - low) {
            stretch.way = Way::SlowlyDown;
        }
    }
}

/// The part of a loading branch that goes on at the speed of the press: an approach at another one is no part of it.
fn pressing(recording: &Recording, branch: Range<usize>) -> Range<usize> {
    let (time, depth, force) = (&recording.time_s, &recording.depth_mm, &recording.force_n);
    let own = force.get(branch.clone()).unwrap_or_default();
    let (low, high) = own.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), f| (a.min(*f), b.max(*f)));
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
    let low = depth.iter().copied().fold(f64::INFINITY, f64::min);
    let high = depth.iter().copied().fold(f64::NEG_INFINITY, f64::max);
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

fn force_drop(recording: &Recording, loading: &Range<usize>) -> Option<(usize, Event)> {
    let force = recording.force_n.get(loading.clone())?;
    let highest = force.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let lowest = force.iter().copied().fold(f64::INFINITY, f64::min);
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

/// Median of what a signal rises by from sample to sample.
fn usual_rise(signal: &[f64]) -> f64 {
    median(signal.windows(2).map(|w| w[1] - w[0]))
}

fn slope(x: &[f64], y: &[f64]) -> Option<f64> {
    let count = x.len() as f64;
    let (mean_x, mean_y) = (x.iter().sum::<f64>() / count, y.iter().sum::<f64>() / count);
    let sxx: f64 = x.iter().map(|x| (x - mean_x).powi(2)).sum();
    let sxy: f64 = x.iter().zip(y).map(|(x, y)| (x - mean_x) * (y - mean_y)).sum();
    let slope = sxy / sxx;
    slope.is_finite().then_some(slope)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;

    /// Piecewise linear depth through the given (time, depth) corners, sampled every 0.1 s.
    fn ramps(corners: &[(f64, f64)]) -> Recording {
        let mut time = Vec::new();
        let mut depth = Vec::new();
        for pair in corners.windows(2) {
            let ((t0, d0), (t1, d1)) = (pair[0], pair[1]);
            let steps = ((t1 - t0) / 0.1).round() as usize;
            for i in 0..steps {
                let t = t0 + i as f64 * 0.1;
                time.push(t);
                depth.push(d0 + (d1 - d0) * (t - t0) / (t1 - t0));
            }
        }
        let force = depth.iter().map(|d: &f64| d.max(0.0).powf(1.5)).collect();
        Recording::from_samples(time, depth, force)
    }

    #[test]
    fn ramp_hold_unload() {
        let run = ramps(&[(0.0, 0.0), (1.0, 0.0), (5.0, 4.0), (15.0, 4.0), (17.0, 0.0)]);
        let motion = of(&run).unwrap();
        assert!((motion.rate_mm_per_s - 1.0).abs() < 0.02, "{motion:?}");
        assert!(motion.loading.start.abs_diff(10) <= 1, "{motion:?}");
        assert!(motion.loading.end.abs_diff(50) <= 2, "{motion:?}");
        let hold = motion.hold.unwrap();
        assert!(hold.end.abs_diff(150) <= 2, "{hold:?}");
        assert!(motion.unloading.unwrap().end.abs_diff(170) <= 2);
        assert_eq!(motion.loadings.len(), 1);
        assert!(motion.events.is_empty());
    }

    #[test]
    fn a_stop_on_the_way_is_told_and_ends_the_branch() {
        let run = ramps(&[(0.0, 0.0), (3.0, 3.0), (5.0, 3.0), (8.0, 6.0)]);
        let motion = of(&run).unwrap();
        assert!(motion.loading.end.abs_diff(30) <= 2, "{motion:?}");
        let [Event::Restarted { pause_s, .. }] = motion.events[..] else { panic!("{:?}", motion.events) };
        assert!((pause_s - 2.0).abs() < 0.3);
    }

    #[test]
    fn a_fall_of_force_ends_the_branch_and_an_outlier_does_not() {
        let mut run = ramps(&[(0.0, 0.0), (10.0, 5.0), (12.0, 5.0)]);
        run.force_n[40] += 1.0;
        assert!(of(&run).unwrap().events.is_empty());
        for force in &mut run.force_n[80..] {
            *force -= 2.0;
        }
        let motion = of(&run).unwrap();
        assert_eq!(motion.loading.end, 80);
        assert!(matches!(motion.events[..], [Event::ForceDrop { .. }]));
    }

    /// A sensor of 2 % has 2 % of a large force as noise, and next to none of the small forces that most of a ramp is.
    #[test]
    fn noise_in_proportion_to_the_force_is_no_fall() {
        let clean = ramps(&[(0.0, 0.0), (20.0, 5.0), (22.0, 5.0)]);
        let noisy = |seed: u64| {
            let mut run = clean.clone();
            let mut state = seed;
            for (force, depth) in run.force_n.iter_mut().zip(&run.depth_mm) {
                state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
                // evenly within a band of 2 % standard deviation; the foam hardens
                *force = depth.max(0.0).powi(4) * (1.0 + 0.035 * ((state >> 33) as f64 / (1_u64 << 30) as f64 - 1.0));
            }
            run
        };
        for seed in 1..200 {
            let mut run = noisy(seed);
            assert_eq!(of(&run).unwrap().events, [], "seed {seed}");
            for force in &mut run.force_n[170..] {
                *force -= 0.4 * 5.0_f64.powi(4);
            }
            assert!(matches!(of(&run).unwrap().events[..], [Event::ForceDrop { .. }]), "seed {seed}");
        }
    }

    /// A knock that the sensor's electronics forget in half a second is none either, where others as large go the other way.
    #[test]
    fn noise_with_long_tails_and_a_memory_is_no_fall() {
        let mut run = ramps(&[(0.0, 0.0), (20.0, 5.0), (22.0, 5.0)]);
        let knock = |run: &mut Recording, at: usize, by: f64| {
            for (k, force) in run.force_n[at..at + 15].iter_mut().enumerate() {
                *force += by * (-0.2 * k as f64).exp();
            }
        };
        knock(&mut run, 60, 1.0);
        knock(&mut run, 120, -1.3);
        assert_eq!(of(&run).unwrap().events, []);
        knock(&mut run, 160, -2.5);
        assert!(matches!(of(&run).unwrap().events[..], [Event::ForceDrop { .. }]));
    }

    #[test]
    fn noise_of_depth_does_not_break_the_ramp() {
        let mut run = ramps(&[(0.0, 0.0), (20.0, 4.0), (25.0, 4.0), (27.0, 0.0)]);
        // A fixed irregular sequence of about 0.02 mm; a step is 0.02 mm.
        let mut state = 1_u64;
        for depth in &mut run.depth_mm {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            *depth += 0.02 * ((state >> 33) as f64 / (1_u64 << 30) as f64 - 1.0);
        }
        let motion = of(&run).unwrap();
        assert!((motion.rate_mm_per_s - 0.2).abs() < 0.01, "{motion:?}");
        assert!(motion.loading.end.abs_diff(200) < 15, "{motion:?}");
        assert_eq!(motion.loadings.len(), 1);
    }

    #[test]
    fn a_depth_read_less_often_than_written_is_no_standstill() {
        let mut run = ramps(&[(0.0, 0.0), (3.0, 0.0), (23.0, 4.0), (28.0, 4.0), (48.0, 0.0)]);
        let read: Vec<f64> = (0..run.depth_mm.len()).map(|i| run.depth_mm[i / 6 * 6]).collect();
        run.depth_mm = read;
        let motion = of(&run).unwrap();
        assert!((motion.rate_mm_per_s - 0.2).abs() < 0.01, "{motion:?}");
        assert!(motion.loading.start.abs_diff(30) < 8 && motion.loading.end.abs_diff(230) < 8, "{motion:?}");
        assert!(motion.hold.is_some() && motion.events.is_empty(), "{motion:?}");
    }

    /// A press ten times slower than a long approach, and one less than twice as slow: both begin where their own speed does.
    #[test]
    fn a_fast_approach_is_no_part_of_a_slow_press() {
        let run = ramps(&[(0.0, -40.0), (8.0, 0.0), (16.0, 4.0)]);
        let motion = of(&run).unwrap();
        assert!((motion.rate_mm_per_s - 0.5).abs() < 0.02, "{motion:?}");
        assert!(motion.loading.start.abs_diff(80) < 8 && motion.loading.end.abs_diff(160) < 3, "{motion:?}");
        let run = ramps(&[(0.0, -10.0), (5.0, -1.0), (10.0, 4.0), (20.0, 4.0)]);
        let motion = of(&run).unwrap();
        assert!((motion.rate_mm_per_s - 1.0).abs() < 0.05, "{motion:?}");
        assert!(motion.loading.start.abs_diff(50) < 10 && motion.hold.is_some(), "{motion:?}");
        // a creep under a constant force is no press
        let mut creep = ramps(&[(0.0, 0.0), (4.0, 4.0), (40.0, 4.5)]);
        creep.force_n[40..].iter_mut().for_each(|force| *force = 8.0);
        let motion = of(&creep).unwrap();
        assert!(motion.loading.end.abs_diff(40) < 3 && motion.hold.is_some(), "{motion:?}");
    }

    #[test]
    fn two_cycles_and_no_motion() {
        let run = ramps(&[(0.0, 0.0), (2.0, 2.0), (4.0, 0.0), (6.0, 2.0), (8.0, 0.0)]);
        assert_eq!(of(&run).unwrap().loadings.len(), 2);
        assert_eq!(of(&ramps(&[(0.0, 1.0), (9.0, 1.0)])), None);
    }
}
