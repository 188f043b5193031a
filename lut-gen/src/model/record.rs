//! What a simulation gives: force and depth over time.

use crate::solve::{Path, Station};

/// Force and depth over time, at the equilibria that were computed.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    /// The equilibria, in order of time; the untouched start is not among them.
    pub stations: Vec<Station>,
    /// Force of hard contact at each station (N): the penalty's softness is removed to first order.
    pub force_n: Vec<f64>,
    /// Corrections of Newton's method.
    pub iterations: usize,
    /// Factorisations.
    pub factorisations: usize,
    /// Steps that had to be cut.
    pub cuts: usize,
}

impl Record {
    pub(super) fn new(path: Path) -> Self {
        let energy: Vec<f64> = path.stations.iter().map(|s| s.penalty_energy).collect();
        let lost = penalty_share(&path.stations, &energy);
        Self {
            force_n: path.stations.iter().zip(lost).map(|(s, e)| s.force_n + e).collect(),
            stations: path.stations,
            iterations: path.iterations,
            factorisations: path.factorisations,
            cuts: path.cuts,
        }
    }

    /// Force (N) at a time (s), linear between stations; 0 at the start, the last value at the end.
    #[must_use]
    pub fn force_at(&self, time_s: f64) -> f64 {
        let next = self.stations.partition_point(|s| s.time_s < time_s);
        let point = |i: usize| (self.stations[i].time_s, self.force_n[i]);
        if next >= self.stations.len() {
            return self.force_n.last().copied().unwrap_or(0.0);
        }
        let (t0, f0) = if next == 0 { (0.0, 0.0) } else { point(next - 1) };
        let (t1, f1) = point(next);
        f0 + (f1 - f0) * (time_s - t0) / (t1 - t0)
    }
}

/// With the penalty's energy `E` the potential exceeds that of hard contact by `-E + O(1/k^2)`,
/// hence `F = F_k + dE/dd`: the second term at every station, from `E` (or any quantity linear in
/// it, such as its derivative by a parameter) at all of them.
///
/// `E` is taken along depth within a run of one direction; while the depth is held, its share of
/// the force is that of the run's end, in proportion to the force. A jump begins a new run.
pub(super) fn penalty_share(stations: &[Station], energy: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; stations.len()];
    let depth = |i: usize| if i == 0 { 0.0 } else { stations[i - 1].depth_mm };
    let value = |i: usize| if i == 0 { 0.0 } else { energy[i - 1] };
    // runs over the points 0 (untouched) and 1.. (stations) in which the depth moves one way
    let mut start = 0;
    while start < stations.len() {
        if stations[start].jumped {
            out[start] = after_jump(stations, energy, start);
            start += 1;
            continue;
        }
        let rises = depth(start + 1) > depth(start);
        if depth(start + 1) == depth(start) {
            out[start] = held(stations, &out, start);
            start += 1;
            continue;
        }
        let mut end = start + 1;
        let goes_on = |end: usize| {
            (depth(end + 1) > depth(end)) == rises && depth(end + 1) != depth(end) && !stations[end].jumped
        };
        while end < stations.len() && goes_on(end) {
            end += 1;
        }
        for i in start + 1..=end {
            let low = if i == end { end.saturating_sub(2).max(start) } else { i - 1 };
            let three = [low, low + 1, (low + 2).min(end)].map(|j| (depth(j), value(j)));
            out[i - 1] = parabola_slope(&three, depth(i));
        }
        start = end;
    }
    out
}

/// Of the line to the next station; 0, the softness left in, when the motion ends or turns there.
fn after_jump(stations: &[Station], energy: &[f64], at: usize) -> f64 {
    let next = at + 1;
    if next >= stations.len() || stations[next].jumped || stations[next].segment != stations[at].segment {
        return 0.0;
    }
    let rise = stations[next].depth_mm - stations[at].depth_mm;
    if rise == 0.0 { 0.0 } else { (energy[next] - energy[at]) / rise }
}

/// The share of the station before, in proportion to the force.
fn held(stations: &[Station], out: &[f64], at: usize) -> f64 {
    if at == 0 || stations[at - 1].force_n == 0.0 {
        return 0.0;
    }
    out[at - 1] * stations[at].force_n / stations[at - 1].force_n
}

/// Slope at `x` of the parabola through three points.
fn parabola_slope(p: &[(f64, f64); 3], x: f64) -> f64 {
    let first = (p[1].1 - p[0].1) / (p[1].0 - p[0].0);
    if p[2].0 == p[1].0 {
        return first;
    }
    let second = ((p[2].1 - p[1].1) / (p[2].0 - p[1].0) - first) / (p[2].0 - p[0].0);
    first + second * (2.0 * x - p[0].0 - p[1].0)
}
