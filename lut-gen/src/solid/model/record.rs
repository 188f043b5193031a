//! What a simulation gives: force and depth over time.

use crate::scalar::Real;
use crate::solid::solve::{Path, Station};

/// Force and depth over time, at the equilibria that were computed.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    /// The equilibria, in order of time; the untouched start is not among them.
    pub stations: Vec<Station>,
    /// Force of hard contact at each station (N): the penalty's softness is removed to first order.
    pub force_n: Vec<f64>,
    /// Depth of hard contact at each station (mm): where the force is prescribed it is the depth
    /// that the penalty's softness has changed.
    pub depth_mm: Vec<f64>,
    /// Corrections of Newton's method.
    pub iterations: usize,
    /// Factorisations.
    pub factorisations: usize,
    /// Steps that had to be cut.
    pub cuts: usize,
}

impl Record {
    /// The record of a path.
    #[must_use]
    pub fn new(path: Path) -> Self {
        let energy: Vec<f64> = path.stations.iter().map(|s| s.penalty_energy).collect();
        let depth: Vec<f64> = path.stations.iter().map(|s| s.depth_mm).collect();
        let share = penalty_share(&path.stations, &depth, &energy, path.remembers);
        let with_share = || path.stations.iter().zip(&share);
        Self {
            force_n: with_share().map(|(s, e)| if s.by_force { s.force_n } else { s.force_n + e }).collect(),
            depth_mm: with_share()
                .map(|(s, e)| if s.by_force { s.depth_mm - e / s.slope } else { s.depth_mm })
                .collect(),
            stations: path.stations,
            iterations: path.iterations,
            factorisations: path.factorisations,
            cuts: path.cuts,
        }
    }

    /// Force (N) at a time (s), linear between stations; 0 at the start, the last value at the end. In a
    /// hold, whose steps grow by 1.4, that is within 1 % of what relaxes.
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

/// Part of the largest depth below which two depths are one.
const ROUNDING: f64 = 1e-12;

/// With the penalty's complementary energy `E` the potential exceeds that of hard contact by
/// `-E + O(1/k^2)`, hence `F = F_k + dE/dd`: the second term at every station, from depth and `E`
/// there (with their derivatives by a parameter, where they carry them).
///
/// `E` is differentiated along depth within a run of one direction; while depth or force is held,
/// `dE/dd` moves like `E`: both with the square of the stress. A jump begins a new run.
///
/// Where something remembers, `E` falls on the way back for other reasons than depth: at a depth
/// that was reached before, `dE/dd` is to `E` what it was when it was reached first.
pub(super) fn penalty_share<T: Real>(stations: &[Station], depth: &[T], energy: &[T], remembers: bool) -> Vec<T> {
    let zero = T::from(0.0);
    let mut out = vec![zero; stations.len()];
    // point 0 is the untouched start, point i is station i - 1
    let point = |i: usize| if i == 0 { (zero, zero) } else { (depth[i - 1], energy[i - 1]) };
    // steps that rounding makes are none: over 1e-17 mm nothing can be differentiated
    let deepest = depth.iter().map(|d| d.value().abs()).fold(0.0, f64::max);
    let same = |i: usize| (point(i + 1).0.value() - point(i).0.value()).abs() <= ROUNDING * deepest;
    let moves = |i: usize| (point(i + 1).0.value() - point(i).0.value()).signum();
    // depths that were reached first, with `dE/dd` over `E` there
    let mut reached: Vec<(T, T)> = Vec::new();
    let mut start = 0;
    while start < stations.len() {
        if stations[start].jumped {
            out[start] = after_jump(stations, depth, energy, start);
            start += 1;
            continue;
        }
        let still = |i: usize| stations[i].held || same(i);
        if still(start) {
            let before = point(start).1;
            if start > 0 && before.value() > 0.0 {
                out[start] = out[start - 1] * point(start + 1).1 / before;
            }
            start += 1;
            continue;
        }
        let mut end = start + 1;
        while end < stations.len() && !still(end) && moves(end) == moves(start) && !stations[end].jumped {
            end += 1;
        }
        for i in start + 1..=end {
            let here = point(i);
            let known = reached.last().is_some_and(|last| here.0.value() <= last.0.value());
            if remembers && known {
                out[i - 1] = here.1 * ratio(&reached, here.0);
                continue;
            }
            let low = if i == end { end.saturating_sub(2).max(start) } else { i - 1 };
            out[i - 1] = parabola_slope(&[low, low + 1, (low + 2).min(end)].map(point), here.0);
            if here.1.value() > 0.0 && !known {
                reached.push((here.0, out[i - 1] / here.1));
            }
        }
        start = end;
    }
    out
}

/// `dE/dd` over `E` at a depth between those that were reached; like the inverse of the depth above the first.
fn ratio<T: Real>(reached: &[(T, T)], depth: T) -> T {
    let next = reached.partition_point(|p| p.0.value() < depth.value());
    match (next.checked_sub(1).and_then(|i| reached.get(i)), reached.get(next)) {
        (Some(a), Some(b)) => a.1 + (b.1 - a.1) * (depth - a.0) / (b.0 - a.0),
        (None, Some(first)) if depth.value() > 0.0 => first.1 * first.0 / depth,
        (Some(end), None) | (None, Some(end)) => end.1,
        (None, None) => T::from(0.0),
    }
}

/// Of the line to the next station; 0, the softness left in, when the motion ends or turns there.
fn after_jump<T: Real>(stations: &[Station], depth: &[T], energy: &[T], at: usize) -> T {
    let next = at + 1;
    if next >= stations.len() || stations[next].jumped || stations[next].segment != stations[at].segment {
        return T::from(0.0);
    }
    let rise = depth[next] - depth[at];
    if rise.value() == 0.0 { T::from(0.0) } else { (energy[next] - energy[at]) / rise }
}

/// Slope at `x` of the parabola through three points.
fn parabola_slope<T: Real>(p: &[(T, T); 3], x: T) -> T {
    let first = (p[1].1 - p[0].1) / (p[1].0 - p[0].0);
    if p[2].0.value() == p[1].0.value() {
        return first;
    }
    let second = ((p[2].1 - p[1].1) / (p[2].0 - p[1].0) - first) / (p[2].0 - p[0].0);
    first + second * (x * 2.0 - p[0].0 - p[1].0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A motion that begins above the surface may come to it in steps of a rounding error each: they say nothing of how the penalty's energy grows.
    #[test]
    fn steps_that_rounding_makes_are_none() {
        let station = |depth_mm: f64, penalty_energy: f64| Station {
            time_s: depth_mm + 1.0,
            depth_mm,
            force_n: 0.0,
            base_force_n: 0.0,
            slope: 1.0,
            penalty_energy,
            contact_radius_mm: 0.0,
            active: 1,
            sliding: 0,
            segment: 0,
            held: false,
            by_force: false,
            stable: true,
            jumped: false,
        };
        let energy = |depth_mm: f64| (1.0 + depth_mm).powi(2) * 1e-6;
        let path = |depths: &[f64]| Path {
            // what Newton's method leaves of an equilibrium
            stations: depths.iter().enumerate().map(|(i, d)| station(*d, energy(*d) + 1e-15 * i as f64)).collect(),
            iterations: 0,
            factorisations: 0,
            cuts: 0,
            remembers: false,
        };
        let once = Record::new(path(&[-0.2, -0.1, 0.0, 0.1, 0.2]));
        let thrice = Record::new(path(&[-0.2, -0.1, -1e-17, 0.0, 1e-17, 0.1, 0.2]));
        for (at, force_n) in [(2, 2), (3, 2), (4, 2), (5, 3), (6, 4)].map(|(t, o)| (t, once.force_n[o])) {
            assert!((thrice.force_n[at] / force_n - 1.0).abs() < 0.2, "{at}: {} of {force_n}", thrice.force_n[at]);
        }
    }
}
