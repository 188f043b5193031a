//! Between computed points.

/// A function through points, without overshoot: piecewise cubic with the slopes of Fritsch and Butland
/// (1984, doi:10.1137/0905021), constant beyond the ends. Where it has a corner its slopes to either side know nothing of each other.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Smooth {
    x: Vec<f64>,
    y: Vec<f64>,
    /// Slope to the left and to the right of every point.
    slope: Vec<[f64; 2]>,
}

impl Smooth {
    /// Through points with rising `x`; a point that does not rise is left out. Without any point the function is `otherwise`.
    pub fn through(points: impl IntoIterator<Item = (f64, f64)>, otherwise: f64) -> Self {
        Self::with_corners(points.into_iter().map(|point| (point, false)), otherwise)
    }

    /// The same with corners at some points.
    pub fn with_corners(points: impl IntoIterator<Item = ((f64, f64), bool)>, otherwise: f64) -> Self {
        let (mut x, mut y): (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
        let mut corners = vec![0];
        for ((at, value), corner) in points {
            if at.is_finite() && value.is_finite() && x.last().is_none_or(|last| at > *last) {
                if corner {
                    corners.push(x.len());
                }
                x.push(at);
                y.push(value);
            }
        }
        if x.is_empty() {
            (x, y) = (vec![0.0], vec![otherwise]);
        }
        corners.push(x.len() - 1);
        let mut slope = vec![[0.0; 2]; x.len()];
        for two in corners.windows(2).filter(|two| two[1] > two[0]) {
            let own = two[0]..=two[1];
            for (i, value) in own.clone().zip(slopes(&x[own.clone()], &y[own])) {
                if i > two[0] {
                    slope[i][0] = value;
                }
                if i < two[1] {
                    slope[i][1] = value;
                }
            }
        }
        Self { x, y, slope }
    }

    /// The value at `x`.
    pub fn at(&self, x: f64) -> f64 {
        let last = self.x.len() - 1;
        if x <= self.x[0] || last == 0 {
            return self.y[0];
        }
        if x >= self.x[last] {
            return self.y[last];
        }
        let i = self.x.partition_point(|p| *p <= x) - 1;
        let h = self.x[i + 1] - self.x[i];
        let t = (x - self.x[i]) / h;
        let (a, b) = (self.y[i], self.y[i + 1]);
        let (m, n) = (h * self.slope[i][1], h * self.slope[i + 1][0]);
        let s = 1.0 - t;
        s * s * (a * (1.0 + 2.0 * t) + m * t) + t * t * (b * (3.0 - 2.0 * t) - n * s)
    }
}

fn slopes(x: &[f64], y: &[f64]) -> Vec<f64> {
    let count = x.len();
    if count < 2 {
        return vec![0.0; count];
    }
    let secant: Vec<f64> = (0..count - 1).map(|i| (y[i + 1] - y[i]) / (x[i + 1] - x[i])).collect();
    let mut slope = vec![0.0; count];
    slope[0] = secant[0];
    slope[count - 1] = secant[count - 2];
    if count > 2 {
        slope[0] = at_end(x[1] - x[0], x[2] - x[1], secant[0], secant[1]);
        let (h, k) = (x[count - 1] - x[count - 2], x[count - 2] - x[count - 3]);
        slope[count - 1] = at_end(h, k, secant[count - 2], secant[count - 3]);
    }
    for i in 1..count - 1 {
        let (before, after) = (secant[i - 1], secant[i]);
        if before * after > 0.0 {
            let (h, k) = (x[i] - x[i - 1], x[i + 1] - x[i]);
            let (v, w) = (2.0 * k + h, k + 2.0 * h);
            slope[i] = (v + w) / (v / before + w / after);
        }
    }
    slope
}

/// Slope at an end by the parabola through three points, not steeper than three times the secant and never against it.
fn at_end(h: f64, k: f64, secant: f64, next: f64) -> f64 {
    let slope = ((2.0 * h + k) * secant - h * next) / (h + k);
    if slope * secant <= 0.0 { 0.0 } else { slope.abs().min(3.0 * secant.abs()).copysign(secant) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Slopes off by order h^2 = 0.01 at most change values by a tenth of that times h.
    #[test]
    fn a_smooth_function_is_followed_and_no_point_is_missed() {
        let f = |x: f64| (-x).exp();
        let through = Smooth::through((0..=30).map(|i| 0.1 * f64::from(i)).map(|x| (x, f(x))), 0.0);
        for i in 0..300 {
            let x = 0.01 * f64::from(i);
            assert!((through.at(x) - f(x)).abs() < 2e-4, "{x}: {} {}", through.at(x), f(x));
        }
        assert_eq!(through.at(-1.0), 1.0);
        assert_eq!(through.at(9.0), f(3.0));
        assert_eq!(Smooth::through([], 7.0).at(1.0), 7.0);
    }

    /// Level to a corner and steep from there on: without the corner the slope there is 0, and the function late by a third of a step.
    #[test]
    fn a_corner_stays_one() {
        let points = || (0..=8).map(f64::from).map(|x| (x, -(x - 4.0_f64).max(0.0)));
        let cornered = Smooth::with_corners(points().map(|p| (p, p.0 == 4.0)), 0.0);
        let rounded = Smooth::through(points(), 0.0);
        assert!((cornered.at(4.5) + 0.5).abs() < 1e-12 && cornered.at(3.5) == 0.0);
        assert!(rounded.at(4.5) > -0.4, "{}", rounded.at(4.5));
    }
}
