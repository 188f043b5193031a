//! Force over depth of one foam.

/// Force at even steps of depth from zero, with cubic interpolation between them.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    step_mm: f64,
    /// Force at 0, 1, 2, ... steps, N.
    force_n: Vec<f64>,
}

impl Curve {
    /// A curve from forces at `step_mm, 2 step_mm, ...`; force at zero is zero. `None` unless the step is positive, there are
    /// at least two forces, and all are finite and not negative.
    pub fn new(step_mm: f64, forces_n: &[f64]) -> Option<Self> {
        let sound = step_mm > 0.0 && forces_n.len() >= 2 && forces_n.iter().all(|f| f.is_finite() && *f >= 0.0);
        sound.then(|| Curve { step_mm, force_n: std::iter::once(0.0).chain(forces_n.iter().copied()).collect() })
    }

    /// Depth of the last force, mm.
    pub fn depth_max_mm(&self) -> f64 {
        self.step_mm * (self.force_n.len() - 1) as f64
    }

    /// Force at the last depth, N.
    pub fn peak_n(&self) -> f64 {
        self.force_n.last().copied().unwrap_or(0.0)
    }

    /// Force at a depth, N: zero above the surface, Catmull-Rom between the given depths, straight on beyond the last.
    pub fn force_n(&self, depth_mm: f64) -> f64 {
        if depth_mm.is_nan() || depth_mm <= 0.0 {
            return 0.0;
        }
        let f = |i: usize| self.force_n.get(i).copied().unwrap_or(0.0);
        let last = self.force_n.len() - 1;
        let at = depth_mm / self.step_mm;
        if at >= last as f64 {
            return f(last) + (f(last) - f(last - 1)) * (at - last as f64);
        }
        let i = at as usize;
        let t = at - i as f64;
        // One-sided slopes at the ends; force starts flat (Hertz: slope zero at contact).
        let slope = |i: usize| match i {
            0 => 0.0,
            i if i == last => f(last) - f(last - 1),
            i => 0.5 * (f(i + 1) - f(i - 1)),
        };
        let (t2, t3) = (t * t, t * t * t);
        (2.0 * t3 - 3.0 * t2 + 1.0) * f(i)
            + (t3 - 2.0 * t2 + t) * slope(i)
            + (3.0 * t2 - 2.0 * t3) * f(i + 1)
            + (t3 - t2) * slope(i + 1)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn square() -> Curve {
        Curve::new(0.1, &(1..=40).map(|i| (0.1 * f64::from(i)).powi(2)).collect::<Vec<_>>()).unwrap()
    }

    #[test]
    fn a_parabola_comes_back_between_its_points() {
        let curve = square();
        // Catmull-Rom is exact for parabolas away from the ends; rounding only.
        for depth in [0.15, 1.234, 2.5, 3.85] {
            assert!((curve.force_n(depth) - depth * depth).abs() < 1e-12);
        }
        assert_eq!(curve.force_n(4.0), curve.peak_n());
    }

    #[test]
    fn outside_it_is_zero_above_and_straight_below() {
        let curve = square();
        assert_eq!(curve.force_n(0.0), 0.0);
        assert_eq!(curve.force_n(-1.0), 0.0);
        assert_eq!(curve.force_n(f64::NAN), 0.0);
        assert!((curve.force_n(4.1) - (16.0 + (16.0 - 3.9f64.powi(2)))).abs() < 1e-9);
    }

    #[test]
    fn senseless_curves_are_refused() {
        assert!(Curve::new(0.0, &[1.0, 2.0]).is_none());
        assert!(Curve::new(0.1, &[1.0]).is_none());
        assert!(Curve::new(0.1, &[1.0, f64::NAN]).is_none());
        assert!(Curve::new(0.1, &[1.0, -1.0]).is_none());
    }
}
