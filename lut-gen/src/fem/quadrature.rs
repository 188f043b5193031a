//! Gauss-Legendre rules.

/// Points and weights of the `n`-point Gauss-Legendre rule on [-1, 1], `n >= 1`.
///
/// Roots of the Legendre polynomial by Newton's method from the usual cosine
/// start (Press et al., Numerical Recipes, sec. 4.6); exact to rounding.
#[must_use]
pub fn gauss(n: usize) -> Vec<(f64, f64)> {
    (0..n)
        .map(|i| {
            let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
            let mut slope = 1.0;
            for _ in 0..20 {
                let (mut p, mut before) = (1.0, 0.0);
                for k in 0..n {
                    let k = k as f64;
                    (p, before) = (((2.0 * k + 1.0) * x * p - k * before) / (k + 1.0), p);
                }
                slope = n as f64 * (x * p - before) / (x * x - 1.0);
                let dx = p / slope;
                x -= dx;
                if dx.abs() < 1e-15 {
                    break;
                }
            }
            (-x, 2.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}
