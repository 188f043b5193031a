//! Between computed points.

/// A function through points, without overshoot: piecewise cubic with the slopes of Fritsch and Butland
/// (1984, doi:10.1137/0905021), constant beyond the ends.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Smooth {
    x: Vec<f64>,
    y: Vec<f64>,
    slope: Vec<f64>,
}

impl Smooth {
    /// Through points with rising `x`; a point that does not rise is left out. Without any point the function is `otherwise`.
    pub fn through(points: impl IntoIterator<Item = (f64, f64)>, otherwise: f64) -> Self {
        let (mut x, mut y): (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
        for (at, value) in points {
            if at.is_finite() && value.is_finite() && x.last().is_none_or(|last| at > *last) {
                x.push(at);
                y.push(value);
            }
        }
        if x.is_empty() {
            (x, y) = (vec![0.0], vec![otherwise]);
        }
        let slope = slopes(&x, &y);
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
        let (m, n) = (h * self.slope[i], h * self.slope[i + 1]);
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
}
