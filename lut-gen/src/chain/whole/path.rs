//! Paths of a ball: times (s) and depths (mm).

use crate::solid::solve::Motion;

/// Largest distance (part of the deepest point) between a recorded path and the straight pieces it is solved on.
const STRAIGHT: f64 = 0.002;

/// A point this far (part of the distance between two) beyond a corner is at it.
const NEAR: f64 = 1e-6;

/// Largest depth of a path, mm; 0 where nothing is touched.
pub(super) fn deepest_mm(path: &[(f64, f64)]) -> f64 {
    path.iter().map(|p| p.1).fold(0.0, f64::max)
}

/// The motion along a path of times and depths, and the path's time at which it begins; none where nothing is touched.
pub(super) fn motion(path: &[(f64, f64)]) -> Option<(Motion, f64)> {
    let (first, second) = (path.first()?, path.get(1)?);
    let deepest = deepest_mm(path);
    if deepest <= 0.0 {
        return None;
    }
    let mut motion = Motion::from_touch();
    let mut begin_s = first.0;
    if first.1 > 0.0 {
        // what was not recorded is passed at the rate of the first piece
        let rate = ((second.1 - first.1) / (second.0 - first.0)).max(deepest / 1e3);
        begin_s -= first.1 / rate;
        motion = motion.to_depth_within(first.1, first.1 / rate);
    } else {
        motion.start_mm = first.1;
    }
    let mut at_mm = first.1;
    for pair in path.windows(2) {
        // a hold is one, whatever the last digit of a mean says: forces are differentiated by depth
        if (pair[1].1 - at_mm).abs() > 1e-6 * deepest {
            at_mm = pair[1].1;
        }
        motion = motion.to_depth_within(at_mm, pair[1].0 - pair[0].0);
    }
    Some((motion, begin_s))
}

/// Times with three more between each two.
pub(super) fn divided(times: &[f64]) -> Vec<f64> {
    let mut out: Vec<f64> =
        times.windows(2).flat_map(|two| (0..4).map(|k| two[0] + 0.25 * f64::from(k) * (two[1] - two[0]))).collect();
    out.extend(times.last());
    out
}

/// Fewest of the points whose straight connections come close to all of them (Ramer, Douglas and Peucker).
pub(super) fn straight_pieces(path: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let reach = STRAIGHT * deepest_mm(path);
    let mut kept = vec![0];
    let mut ends = vec![path.len().saturating_sub(1)];
    while let (Some(&from), Some(&to)) = (kept.last(), ends.last()) {
        let miss = |i: &usize| (path[*i].1 - between(&[path[from], path[to]], path[*i].0)).abs();
        let worst = (from + 1..to).max_by(|a, b| miss(a).total_cmp(&miss(b)));
        match worst.filter(|i| miss(i) > reach) {
            Some(i) => ends.push(i),
            None => {
                ends.pop();
                kept.push(to);
            }
        }
    }
    kept.dedup();
    let mut out: Vec<(f64, f64)> = kept.into_iter().filter_map(|i| path.get(i).copied()).collect();
    out.dedup_by(|b, a| b.0 <= a.0);
    out
}

/// Value at a time on straight connections; the ends beyond them.
pub(super) fn between(curve: &[(f64, f64)], time_s: f64) -> f64 {
    let next = curve.partition_point(|p| p.0 < time_s);
    match (next.checked_sub(1).and_then(|i| curve.get(i)), curve.get(next)) {
        (Some(a), Some(b)) => a.1 + (b.1 - a.1) * (time_s - a.0) / (b.0 - a.0),
        (Some(end), None) | (None, Some(end)) => end.1,
        (None, None) => 0.0,
    }
}

/// Value at a place of a curve that is smooth but for corners: cubics whose slopes are those of parabolas through neighbours between the same corners (of
/// third order in their distance, where straight connections are of second); the ends beyond them.
pub(super) fn smooth(curve: &[(f64, f64)], corners: &[f64], place: f64) -> f64 {
    let next = curve.partition_point(|p| p.0 < place);
    let (Some(a), Some(b)) = (next.checked_sub(1).and_then(|i| curve.get(i)), curve.get(next)) else {
        return between(curve, place);
    };
    let width = b.0 - a.0;
    if width <= 0.0 {
        return b.1;
    }
    let middle = 0.5 * (a.0 + b.0);
    let after = corners.partition_point(|c| *c < middle);
    let from = after.checked_sub(1).and_then(|i| corners.get(i)).copied().unwrap_or(f64::NEG_INFINITY);
    let to = corners.get(after).copied().unwrap_or(f64::INFINITY);
    let near = NEAR * width;
    let neighbour = |i: Option<usize>| {
        let p = i.and_then(|i| curve.get(i))?;
        (p.0 >= from - near && p.0 <= to + near && (p.0 < a.0 || p.0 > b.0)).then_some(p)
    };
    let (left, right) = (neighbour(next.checked_sub(2)), neighbour(Some(next + 1)));
    let secant = (b.1 - a.1) / width;
    // slope of the parabola through both ends and a third point, at one of the ends; next to a corner one parabola serves both
    let slope = |third: Option<&(f64, f64)>, at: f64| {
        third.map_or(secant, |p| secant + ((p.1 - b.1) / (p.0 - b.0) - secant) / (p.0 - a.0) * (2.0 * at - a.0 - b.0))
    };
    let slopes = (slope(left.or(right), a.0), slope(right.or(left), b.0));
    let t = (place - a.0) / width;
    let (far, u) = (t * t * (3.0 - 2.0 * t), 1.0 - t);
    a.1 + far * (b.1 - a.1) + width * t * u * (u * slopes.0 - t * slopes.1)
}

/// The points at which a path of straight pieces turns, with both ends; a hold is one point.
pub(super) fn turns(pieces: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let reach = STRAIGHT * deepest_mm(pieces);
    let mut out: Vec<(f64, f64)> = Vec::new();
    for point in pieces {
        match out[..] {
            [.., last] if (point.1 - last.1).abs() <= reach => {}
            // further on in the same sense
            [.., before, last] if (point.1 - last.1) * (last.1 - before.1) > 0.0 => {
                let at = out.len() - 1;
                out[at] = *point;
            }
            _ => out.push(*point),
        }
    }
    out
}

/// True when two paths turn at the same depths.
pub(super) fn alike(a: &[(f64, f64)], b: &[(f64, f64)]) -> bool {
    let reach = STRAIGHT * deepest_mm(a);
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a.1 - b.1).abs() <= reach)
}

/// By how much later (s) the second of two paths of one motion is deepest than the first.
pub(super) fn later(first: &[(f64, f64)], second: &[(f64, f64)]) -> f64 {
    let deepest = |path: &[(f64, f64)]| {
        let reach = (1.0 - STRAIGHT) * deepest_mm(path);
        path.iter().find(|p| p.1 >= reach).map_or(0.0, |p| p.0)
    };
    deepest(second) - deepest(first)
}

/// How far along its turns a path has come at a time and depth: pieces passed, and the part of the next one.
pub(super) fn along(turns: &[(f64, f64)], (time_s, depth_mm): (f64, f64)) -> f64 {
    let next = turns.partition_point(|p| p.0 < time_s).clamp(1, turns.len().max(2) - 1);
    let (Some(from), Some(to)) = (turns.get(next - 1), turns.get(next)) else { return 0.0 };
    let part = if to.1 == from.1 { 1.0 } else { ((depth_mm - from.1) / (to.1 - from.1)).clamp(0.0, 1.0) };
    (next - 1) as f64 + part
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Parabolas on either side of a corner are met exactly, unevenly spaced as they are; a sine at spacings of h and h/2 to h^3.
    #[test]
    fn smooth_curves_are_met_but_for_their_corners() {
        let bent = |x: f64| if x < 1.0 { x * x } else { 1.0 - 3.0 * (x - 1.0) + 2.0 * (x - 1.0).powi(2) };
        let places = [0.0, 0.2, 0.5, 0.6, 1.0, 1.3, 1.4, 1.8, 2.0];
        let curve: Vec<(f64, f64)> = places.iter().map(|x| (*x, bent(*x))).collect();
        for x in (0..=200).map(|k| 0.01 * f64::from(k)) {
            let found = smooth(&curve, &[0.0, 1.0, 2.0], x);
            assert!((found - bent(x)).abs() < 1e-12, "{x}: {found} {}", bent(x));
        }
        assert_eq!((smooth(&curve, &[], -1.0), smooth(&curve, &[], 3.0)), (0.0, bent(2.0)));
        let worst = |n: u32| {
            let curve: Vec<(f64, f64)> = (0..=n).map(|k| f64::from(k) / f64::from(n)).map(|x| (x, x.sin())).collect();
            let miss = |x: f64| (smooth(&curve, &[], x) - x.sin()).abs();
            (0..=1000).map(|k| miss(0.001 * f64::from(k))).fold(0.0, f64::max)
        };
        assert!(worst(10) > 6.0 * worst(20) && worst(20) < 1e-5, "{} {}", worst(10), worst(20));
    }

    #[test]
    fn motions_are_as_late_as_their_turns() {
        let path = [(0.0, 0.0), (1.5, 3.0), (6.5, 3.0), (8.0, 0.0)];
        let late: Vec<(f64, f64)> = path.iter().map(|(t, d)| (t - 0.04, *d)).collect();
        assert!((later(&path, &late) + 0.04).abs() < 1e-12 && later(&path, &path) == 0.0);
    }
}
