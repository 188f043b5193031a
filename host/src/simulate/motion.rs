//! What the recorded depth does in a run, and the ball's true motion as straight pieces for the finite elements.

use lut_gen::solid::solve::Motion;

/// A recorded run: down at a rate, perhaps a hold, perhaps back.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Programme {
    /// Recorded depth at the start and at the end of the way back (mm), not positive.
    pub start_mm: f64,
    /// Largest recorded depth (mm).
    pub depth_mm: f64,
    pub rate_mm_s: f64,
    pub hold_s: f64,
    pub unload: bool,
}

impl Programme {
    /// Time of the way down, s.
    pub fn down_s(&self) -> f64 {
        (self.depth_mm - self.start_mm) / self.rate_mm_s
    }

    /// Duration of the run, s.
    pub fn duration_s(&self) -> f64 {
        let ways = if self.unload { 2.0 } else { 1.0 };
        ways * self.down_s() + self.hold_s
    }

    /// Recorded depth (mm) at a time (s).
    pub fn depth_at(&self, time_s: f64) -> f64 {
        let down = self.down_s();
        let back = time_s - down - self.hold_s;
        if time_s <= down {
            self.start_mm + self.rate_mm_s * time_s
        } else if back <= 0.0 || !self.unload {
            self.depth_mm
        } else {
            (self.depth_mm - self.rate_mm_s * back).max(self.start_mm)
        }
    }

    /// True while the recorded depth changes.
    pub fn moves(&self, time_s: f64) -> bool {
        let down = self.down_s();
        time_s <= down || (self.unload && time_s >= down + self.hold_s)
    }
}

/// A corner of a motion: time (s) and depth (mm).
pub(super) type Corner = (f64, f64);

/// Fewest corners through which a motion passes within `within_mm` (Ramer 1972, Douglas and Peucker 1973).
pub(super) fn corners(all: &[Corner], within_mm: f64) -> Vec<Corner> {
    let Some(last) = all.len().checked_sub(1) else { return Vec::new() };
    let mut keep = vec![false; all.len()];
    (keep[0], keep[last]) = (true, true);
    let mut spans = vec![(0, last)];
    while let Some((from, to)) = spans.pop() {
        let ((t0, d0), (t1, d1)) = (all[from], all[to]);
        let miss = |k: usize| (all[k].1 - d0 - (d1 - d0) * (all[k].0 - t0) / (t1 - t0)).abs();
        let farthest = (from + 1..to).max_by(|a, b| miss(*a).total_cmp(&miss(*b)));
        if let Some(at) = farthest.filter(|at| miss(*at) > within_mm) {
            keep[at] = true;
            spans.extend([(from, at), (at, to)]);
        }
    }
    all.iter().zip(keep).filter(|(_, keep)| *keep).map(|(corner, _)| *corner).collect()
}

/// The motion through corners. It begins at touch or above; nearly level pieces are exactly level, so that the solver holds there.
/// Also the time (s) at which it begins.
pub(super) fn through(corners: &[Corner], level_mm: f64, rate_mm_s: f64) -> (Motion, f64) {
    let mut points = corners.to_vec();
    if let Some(&(t, d)) = points.first()
        && d > 0.0
    {
        // the way from touch to the first depth is not recorded
        points.insert(0, (t - d / rate_mm_s, 0.0));
    }
    for i in 1..points.len() {
        let steep = (points[i].1 - points[i - 1].1).abs();
        if steep <= level_mm {
            points[i].1 = points[i - 1].1;
        }
    }
    let (start_s, start_mm) = points.first().copied().unwrap_or((0.0, 0.0));
    let mut motion = Motion { start_mm, segments: Vec::new() };
    for pair in points.windows(2) {
        if pair[1].0 > pair[0].0 {
            motion = motion.to_depth_within(pair[1].1, pair[1].0 - pair[0].0);
        }
    }
    (motion, start_s)
}

#[cfg(test)]
mod tests {
    use super::*;

    const RUN: Programme = Programme { start_mm: -0.5, depth_mm: 3.0, rate_mm_s: 2.0, hold_s: 5.0, unload: true };

    #[test]
    fn a_run_goes_down_stands_and_comes_back() {
        assert_eq!((RUN.down_s(), RUN.duration_s()), (1.75, 8.5));
        for (t, d) in [(0.0, -0.5), (1.0, 1.5), (1.75, 3.0), (5.0, 3.0), (7.75, 1.0), (8.5, -0.5), (9.0, -0.5)] {
            assert!((RUN.depth_at(t) - d).abs() < 1e-12, "{t}");
        }
        assert!(RUN.moves(1.0) && !RUN.moves(3.0) && RUN.moves(7.0));
    }

    #[test]
    fn the_corners_of_a_run_are_its_corners() {
        let all: Vec<Corner> = (0..=850).map(|k| 0.01 * f64::from(k)).map(|t| (t, RUN.depth_at(t))).collect();
        let found = corners(&all, 1e-4);
        assert_eq!(found.iter().map(|(t, _)| *t).collect::<Vec<_>>(), vec![0.0, 1.75, 6.75, 8.5]);
        let (motion, start_s) = through(&found, 1e-4, 2.0);
        assert_eq!((motion.start_mm, start_s, motion.segments.len()), (-0.5, 0.0, 3));
        assert!((motion.duration_s() - 8.5).abs() < 1e-12);
        let (late, start_s) = through(&[(0.0, 0.2), (1.0, 2.2)], 1e-4, 2.0);
        assert!((late.start_mm, late.segments.len()) == (0.0, 2) && (start_s + 0.1).abs() < 1e-12);
    }
}
