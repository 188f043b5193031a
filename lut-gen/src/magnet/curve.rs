//! Flux density over current: f3 of the control curve, with its inverse and its error bound.

use super::bh::{LawError, monotone};

/// Points that rise, with cubics between them that rise as well.
#[derive(Debug, Clone, PartialEq)]
pub struct Rising {
    x: Vec<f64>,
    y: Vec<f64>,
    slope: Vec<f64>,
}

impl Rising {
    /// Through these points.
    ///
    /// # Errors
    /// [`LawError`] unless there are two and both coordinates rise.
    pub fn new(x: Vec<f64>, y: Vec<f64>) -> Result<Self, LawError> {
        if x.len() < 2 || x.len() != y.len() {
            return Err(LawError::Short { found: x.len().min(y.len()) });
        }
        for i in 1..x.len() {
            let rises = x[i] > x[i - 1] && y[i] > y[i - 1] && (x[i] + y[i]).is_finite();
            if !rises {
                return Err(LawError::Falls { point: i + 1, b_t: y[i], h_a_m: x[i] });
            }
        }
        let slope = monotone(&x, &y);
        Ok(Rising { x, y, slope })
    }

    /// The value at `x`; outside of the points that of the nearest.
    #[must_use]
    pub fn at(&self, x: f64) -> f64 {
        let end = self.x.len() - 1;
        if x <= self.x[0] {
            return self.y[0];
        }
        if x >= self.x[end] {
            return self.y[end];
        }
        let i = self.end_of_part(x);
        let width = self.x[i] - self.x[i - 1];
        let t = (x - self.x[i - 1]) / width;
        let (first, last) = (width * self.slope[i - 1], width * self.slope[i]);
        let rise = self.y[i] - self.y[i - 1];
        self.y[i - 1] + t * (first + t * (3.0 * rise - 2.0 * first - last + t * (first + last - 2.0 * rise)))
    }

    /// The point after `x`, which lies between the first and the last: looked for from where it is if points are evenly apart,
    /// as they nearly always are.
    fn end_of_part(&self, x: f64) -> usize {
        let end = self.x.len() - 1;
        let share = (x - self.x[0]) / (self.x[end] - self.x[0]);
        let mut i = ((share * end as f64) as usize + 1).clamp(1, end);
        while i < end && self.x[i] <= x {
            i += 1;
        }
        while i > 1 && self.x[i - 1] > x {
            i -= 1;
        }
        i
    }

    /// Where the value is `y`; `None` outside of the points.
    #[must_use]
    pub fn inverse(&self, y: f64) -> Option<f64> {
        let end = self.y.len() - 1;
        if !(y >= self.y[0] && y <= self.y[end]) {
            return None;
        }
        let i = self.y.partition_point(|own| *own <= y).clamp(1, end);
        let (mut low, mut high) = (self.x[i - 1], self.x[i]);
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if self.at(middle) < y {
                low = middle
            } else {
                high = middle
            }
            if high - low <= 1e-15 * high.abs() {
                break;
            }
        }
        Some(0.5 * (low + high))
    }

    /// The last point.
    #[must_use]
    pub fn last(&self) -> (f64, f64) {
        (self.x[self.x.len() - 1], self.y[self.y.len() - 1])
    }
}

/// What a built magnet has and its drawing has not.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Built {
    /// Flux density over that of the drawing at the same field: what leaks out of the plane, how the gap differs.
    pub flux: f64,
    /// Ampere turns over those of the drawing.
    pub ampere_turns: f64,
    /// Flux density without current, T.
    pub remanence_t: f64,
}

impl Default for Built {
    fn default() -> Self {
        Built { flux: 1.0, ampere_turns: 1.0, remanence_t: 0.0 }
    }
}

/// f3: flux density over current, by finite elements.
#[derive(Debug, Clone, PartialEq)]
pub struct FluxCurve {
    drawn: Rising,
    /// How far the drawn curve may be off at most, T.
    bound_t: f64,
    built: Built,
}

impl FluxCurve {
    /// From flux densities at currents and the largest error of one of them, T. The bound adds what the curve may be off
    /// between its points: what the curve of every second point misses the others by, which is four times as much for a
    /// smooth curve with many points.
    ///
    /// # Errors
    /// [`LawError`] unless both rise, from no current on.
    pub fn new(points: &[(f64, f64)], error_t: f64, built: Built) -> Result<Self, LawError> {
        let curve = |points: &mut dyn Iterator<Item = &(f64, f64)>| {
            let (x, y) = points.copied().unzip();
            Rising::new(x, y)
        };
        for (what, value) in [("the factor of the flux", built.flux), ("that of the ampere turns", built.ampere_turns)]
        {
            if !(value > 0.0 && value.is_finite()) {
                return Err(LawError::Value { what, value, expected: "more than 0" });
            }
        }
        let drawn = curve(&mut points.iter())?;
        let mut missed = error_t.abs();
        if points.len() >= 5 {
            let half = curve(&mut points.iter().step_by(2))?;
            let inner = points.iter().skip(1).step_by(2).filter(|(x, _)| *x < half.last().0);
            missed += inner.map(|(x, y)| (half.at(*x) - y).abs()).fold(0.0, f64::max);
        } else {
            // Too few to tell: half of the largest step.
            missed += points.windows(2).map(|w| 0.5 * (w[1].1 - w[0].1)).fold(0.0, f64::max);
        }
        Ok(FluxCurve { drawn, bound_t: missed, built })
    }

    /// B(A): flux density at a current of 0 to [`FluxCurve::most_a`], T.
    #[must_use]
    pub fn flux_t(&self, ampere: f64) -> f64 {
        self.built.flux * self.drawn.at(self.built.ampere_turns * ampere) + self.built.remanence_t
    }

    /// A(B): the current for a flux density, A; `None` where no current up to the last gives it.
    #[must_use]
    pub fn current_a(&self, flux_t: f64) -> Option<f64> {
        let drawn = (flux_t - self.built.remanence_t) / self.built.flux;
        Some(self.drawn.inverse(drawn)? / self.built.ampere_turns)
    }

    /// The largest current that it knows, A.
    #[must_use]
    pub fn most_a(&self) -> f64 {
        self.drawn.last().0 / self.built.ampere_turns
    }

    /// How far a flux density may be off for the discretisation and between the points, T.
    #[must_use]
    pub fn bound_t(&self) -> f64 {
        self.built.flux * self.bound_t
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// A curve that saturates, as magnets do.
    fn bent(ampere: f64) -> f64 {
        0.3 * (ampere / 2.0).tanh() + 0.01 * ampere
    }

    fn points(step: f64) -> Vec<(f64, f64)> {
        (0..=(4.0 / step) as usize).map(|i| step * i as f64).map(|a| (a, bent(a))).collect()
    }

    #[test]
    fn a_flux_curve_is_within_its_bound_between_its_points_and_has_an_inverse() {
        for step in [0.25, 0.5, 1.0] {
            let curve = FluxCurve::new(&points(step), 1e-5, Built::default()).unwrap();
            let walk = || (0..=1000).map(|i| 4.0 * f64::from(i) / 1000.0);
            let worst = walk().map(|a| (curve.flux_t(a) - bent(a)).abs()).fold(0.0, f64::max);
            assert!(
                worst <= curve.bound_t() && curve.bound_t() < 0.02 * step,
                "{step}: {worst:e} of {:e}",
                curve.bound_t()
            );
            for a in walk() {
                assert!((curve.current_a(curve.flux_t(a)).unwrap() - a).abs() < 1e-9);
            }
            assert_eq!(curve.current_a(bent(4.0) + 1e-6), None);
        }
    }

    #[test]
    fn points_that_are_not_evenly_apart_are_found_as_well() {
        let x = vec![-1.0, -0.9, 0.0, 5.0, 5.01, 5.02, 20.0];
        let curve = Rising::new(x.clone(), x.clone()).unwrap();
        for value in (-99..2000).map(|k| 0.01 * f64::from(k)) {
            let end = x.partition_point(|own| *own <= value);
            assert_eq!(curve.end_of_part(value), end, "{value}");
            assert!((curve.at(value) - value).abs() < 1e-12);
        }
    }

    #[test]
    fn what_was_built_changes_the_curve_as_it_says() {
        let built = Built { flux: 0.7, ampere_turns: 1.1, remanence_t: 0.004 };
        let curve = FluxCurve::new(&points(0.25), 0.0, built).unwrap();
        assert!((curve.flux_t(0.0) - 0.004).abs() < 1e-15);
        assert!((curve.flux_t(2.0) - (0.7 * bent(2.2) + 0.004)).abs() < 1e-4);
        assert!((curve.current_a(curve.flux_t(2.0)).unwrap() - 2.0).abs() < 1e-9);
        assert_eq!(curve.current_a(0.001), None);
        assert!((curve.most_a() - 4.0 / 1.1).abs() < 1e-12);
    }
}
