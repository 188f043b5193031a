//! Derivatives by central differences.

/// Central-difference gradient of `f` at `x` with absolute step `step`, by
/// Richardson's rule from two steps: error of order `step^4`.
#[must_use]
pub fn central_gradient<const N: usize>(f: impl Fn(&[f64; N]) -> f64, x: &[f64; N], step: f64) -> [f64; N] {
    std::array::from_fn(|i| {
        let quotient = |h: f64| {
            let at = |s: f64| {
                let mut y = *x;
                y[i] += s;
                f(&y)
            };
            (at(h) - at(-h)) / (2.0 * h)
        };
        (4.0 * quotient(0.5 * step) - quotient(step)) / 3.0
    })
}

/// Largest difference of two vectors, relative to the largest component of either.
#[must_use]
pub fn worst_mismatch(a: &[f64], b: &[f64]) -> f64 {
    let scale = a.iter().chain(b).fold(f64::MIN_POSITIVE, |m, x| m.max(x.abs()));
    a.iter().zip(b).map(|(x, y)| (x - y).abs() / scale).fold(0.0, f64::max)
}
