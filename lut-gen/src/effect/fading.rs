//! A first-order memory.

/// What a first-order memory keeps over a time of `x` of its own, `exp(-x)`, and what it has at the end of something that comes in evenly meanwhile, `(1 - exp(-x)) / x`.
pub(super) fn fading(x: f64) -> (f64, f64) {
    let faded = -(-x).exp_m1();
    // the limit is 1 for x -> 0
    (1.0 - faded, if x < 1e-9 { 1.0 } else { faded / x })
}
