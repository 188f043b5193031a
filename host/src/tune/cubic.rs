//! The cubic through values and slopes at both ends of a step.

/// On `0..=1`; slopes are those times the step's length.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cubic {
    /// Coefficients, the constant first.
    c: [f64; 4],
}

impl Cubic {
    /// Through values and slopes.
    pub fn new(values: (f64, f64), slopes: (f64, f64)) -> Self {
        let ((a, b), (p, q)) = (values, slopes);
        Self { c: [a, p, 3.0 * (b - a) - 2.0 * p - q, 2.0 * (a - b) + p + q] }
    }

    /// Its value.
    pub fn at(&self, x: f64) -> f64 {
        ((self.c[3] * x + self.c[2]) * x + self.c[1]) * x + self.c[0]
    }

    /// Its integral from 0.
    pub fn area(&self, x: f64) -> f64 {
        (((self.c[3] / 4.0 * x + self.c[2] / 3.0) * x + self.c[1] / 2.0) * x + self.c[0]) * x
    }

    /// Where it is flat, within the step, in order.
    pub fn flat(&self) -> impl Iterator<Item = f64> {
        let (a, b, c) = (3.0 * self.c[3], 2.0 * self.c[2], self.c[1]);
        let root = (b * b - 4.0 * a * c).sqrt();
        // Of the two forms of the root the one without cancellation; a straight or empty one gives no number.
        let q = -0.5 * (b + root.copysign(b));
        let (x, y) = (q / a, c / q);
        [x.min(y), x.max(y)].into_iter().filter(|x| (0.0..=1.0).contains(x))
    }

    /// Where it crosses zero if its ends have different signs.
    pub fn crossing(&self) -> f64 {
        let (mut low, mut high) = (0.0, 1.0);
        let sign = self.c[0];
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if self.at(middle) * sign > 0.0 { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }
}
