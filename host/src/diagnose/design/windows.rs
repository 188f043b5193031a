//! The data of a run thinned to nodes, means over short windows of each branch, and the corners of its motion between them.

use std::ops::Range;

use crate::experiment::Recording;
use crate::experiment::motion::Motion;

/// Windows of a loading branch, a hold and a way back.
const WINDOWS: (usize, usize, usize) = (36, 14, 24);
/// Share of the stroke above the contact from which on samples are used: they show the sensor's zero.
const ABOVE: f64 = 0.05;
/// Below this share of the force that the same depth had on the way down a relaxing contact lifts off; how its edge does
/// is where the chain is farthest from finite elements. Where loading itself had less than the second share of the peak, nothing has lifted.
const LIFTED: (f64, f64) = (0.35, 0.05);

/// Part of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Branch {
    /// On the way down.
    Loading,
    /// Standing at the deepest point.
    Hold,
    /// On the way back.
    Unloading,
}

/// Mean over a short window of one run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Node {
    /// Middle of the window, s since the run's first used sample.
    pub time_s: f64,
    /// Length of the window, s.
    pub length_s: f64,
    /// Samples in it.
    pub samples: usize,
    /// Mean recorded depth, mm; the experiment's zero is taken off.
    pub depth_mm: f64,
    /// Mean force, N.
    pub force_n: f64,
    /// Branch.
    pub branch: Branch,
    /// Time since the hold began, s; 0 elsewhere.
    pub held_s: f64,
    /// On the way back, where the contact lifts off: not compared.
    pub lifted: bool,
}

/// Windows of equal numbers of samples on the ways down and back, and of growing length in a hold.
pub(super) fn nodes(
    recording: &Recording,
    motion: &Motion,
    contact_mm: f64,
    zero_mm: f64,
) -> (Vec<Node>, Vec<(f64, f64)>) {
    let depth = &recording.depth_mm;
    let loading = motion.loading.clone();
    let last = loading.end.saturating_sub(1);
    let above = contact_mm - ABOVE * (depth[last] - contact_mm);
    let begin = loading.clone().find(|i| depth[*i] >= above).unwrap_or(loading.start);
    let start_s = recording.time_s[begin];
    let mut windows: Vec<(Range<usize>, Branch)> = Vec::new();
    even(&mut windows, begin..loading.end, WINDOWS.0, Branch::Loading);
    let mut held_from_s = f64::NAN;
    if let Some(hold) = motion.hold.clone().filter(|hold| !hold.is_empty()) {
        held_from_s = recording.time_s[hold.start];
        growing(&mut windows, recording, hold, WINDOWS.1);
    }
    if let Some(back) = motion.unloading.clone().filter(|back| !back.is_empty()) {
        let end = back.clone().find(|i| depth[*i] < above).unwrap_or(back.end);
        even(&mut windows, back.start..end, WINDOWS.2, Branch::Unloading);
    }
    let nodes = windows.iter().map(|(window, branch)| node(recording, window, *branch, start_s, held_from_s, zero_mm));
    let placed = |(time_s, depth_mm): (f64, f64)| (time_s - start_s, depth_mm - zero_mm);
    let mut nodes: Vec<Node> = nodes.collect();
    lift(&mut nodes);
    // the ball came from farther away than what is compared: a machine that lags has lagged since
    let mut corners: Vec<(f64, f64)> = vec![placed((recording.time_s[begin], depth[begin]))];
    if loading.start < begin {
        corners.push(placed((recording.time_s[loading.start], depth[loading.start])));
    }
    let turns = [Some(last), motion.hold.as_ref().map(|hold| hold.end.saturating_sub(1))];
    corners.extend(turns.into_iter().flatten().filter_map(|at| corner(recording, at)).map(placed));
    (nodes, corners)
}

/// Marks the nodes of the way back from where the contact lifts off: means of three beside each other, so that noise does not decide.
pub(in super::super) fn lift(nodes: &mut [Node]) {
    let loading: Vec<(f64, f64)> =
        nodes.iter().filter(|n| n.branch == Branch::Loading).map(|n| (n.depth_mm, n.force_n)).collect();
    let peak = loading.iter().map(|(_, f)| *f).fold(0.0, f64::max);
    let before = |depth_mm: f64| {
        let next = loading.partition_point(|(d, _)| *d < depth_mm);
        let ((d0, f0), (d1, f1)) = next.checked_sub(1).map(|i| loading[i]).zip(loading.get(next).copied())?;
        Some(f0 + (f1 - f0) * (depth_mm - d0) / (d1 - d0).max(1e-12))
    };
    let back: Vec<usize> = (0..nodes.len()).filter(|k| nodes[*k].branch == Branch::Unloading).collect();
    let lifts = |three: &&[usize]| {
        let now: f64 = three.iter().map(|k| nodes[*k].force_n).sum();
        let then: Option<f64> = three.iter().map(|k| before(nodes[*k].depth_mm)).sum();
        then.is_some_and(|then| then > 3.0 * LIFTED.1 * peak && now < LIFTED.0 * then)
    };
    let Some(first) = back.windows(3).find(lifts).map(|three| three[1]) else { return };
    back.iter().filter(|k| **k >= first).for_each(|k| nodes[*k].lifted = true);
}

/// Samples to either side of a corner that its two straight pieces are taken from.
const BESIDE: usize = 4;

/// Where the motion turns near a sample: two straight pieces, before and after it, meet there, between two samples.
fn corner(recording: &Recording, at: usize) -> Option<(f64, f64)> {
    let point = |i: usize| (recording.time_s[i], recording.depth_mm[i]);
    let (before, after) = (at.checked_sub(BESIDE)?, at + BESIDE);
    if after >= recording.len() {
        return Some(point(at));
    }
    let line = |a: usize, b: usize| {
        let ((t, d), (t2, d2)) = (point(a), point(b));
        (t2 > t).then(|| (t, d, (d2 - d) / (t2 - t)))
    };
    let (t0, d0, v0) = line(before, at - 1)?;
    let (t1, d1, v1) = line(at + 1, after)?;
    if (v0 - v1).abs() < 1e-9 {
        return Some(point(at));
    }
    let time_s = (d1 - d0 + v0 * t0 - v1 * t1) / (v0 - v1);
    let within = (recording.time_s[at - 1]..=recording.time_s[at + 1]).contains(&time_s);
    Some(if within { (time_s, d0 + v0 * (time_s - t0)) } else { point(at) })
}

/// Nodes and corners in order of time, and where the nodes are among them.
pub(super) fn path(nodes: &[Node], corners: Vec<(f64, f64)>) -> (Vec<(f64, f64)>, Vec<usize>) {
    let mut all: Vec<(f64, f64, Option<usize>)> =
        nodes.iter().enumerate().map(|(i, n)| (n.time_s, n.depth_mm, Some(i))).collect();
    for (time_s, depth_mm) in corners {
        // a window of one sample may be the corner itself
        if nodes.iter().all(|n| (n.time_s - time_s).abs() > 1e-6) {
            all.push((time_s, depth_mm, None));
        }
    }
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut at = vec![0; nodes.len()];
    for (place, (_, _, node)) in all.iter().enumerate() {
        if let Some(node) = node {
            at[*node] = place;
        }
    }
    (all.into_iter().map(|(t, d, _)| (t, d)).collect(), at)
}

/// Windows of equal numbers of samples, at most so many.
pub(in super::super) fn even(
    windows: &mut Vec<(Range<usize>, Branch)>,
    samples: Range<usize>,
    most: usize,
    branch: Branch,
) {
    let count = samples.len().min(most);
    for k in 0..count {
        let at = |k: usize| samples.start + k * samples.len() / count;
        windows.push((at(k)..at(k + 1), branch));
    }
}

/// Windows of growing length, at most so many.
pub(in super::super) fn growing(
    windows: &mut Vec<(Range<usize>, Branch)>,
    recording: &Recording,
    hold: Range<usize>,
    most: usize,
) {
    let time = &recording.time_s;
    let (from, to) = (time[hold.start], time[hold.end - 1]);
    let mut start = hold.start;
    for k in 1..=most {
        // a hundredth of the hold first, the rest evenly in the logarithm
        let share = (100.0_f64.ln() * (k as f64 / most as f64 - 1.0)).exp();
        let end_s = from + share * (to - from);
        let end = if k == most { hold.end } else { time[hold.clone()].partition_point(|t| *t <= end_s) + hold.start };
        if end > start {
            windows.push((start..end, Branch::Hold));
            start = end;
        }
    }
}

/// Mean of some samples; the depth is 0 where none was recorded.
pub(in super::super) fn node(
    recording: &Recording,
    window: &Range<usize>,
    branch: Branch,
    start_s: f64,
    held_from_s: f64,
    zero_mm: f64,
) -> Node {
    let mean =
        |values: &[f64]| values.get(window.clone()).map_or(0.0, |own| own.iter().sum::<f64>() / window.len() as f64);
    let time_s = mean(&recording.time_s) - start_s;
    let first = recording.time_s[window.start];
    let next = recording.time_s.get(window.end).copied().unwrap_or_else(|| {
        let last = recording.time_s[window.end - 1];
        last + (last - first) / (window.len().max(2) - 1) as f64
    });
    Node {
        time_s,
        length_s: (next - first).max(1e-6),
        samples: window.len(),
        depth_mm: mean(&recording.depth_mm) - zero_mm,
        force_n: mean(&recording.force_n),
        branch,
        held_s: if branch == Branch::Hold { (time_s + start_s - held_from_s).max(0.0) } else { 0.0 },
        lifted: false,
    }
}
