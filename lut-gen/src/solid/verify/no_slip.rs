//! A rigid sphere that does not slip.

use crate::fem::quadrature::gauss;

/// Force of a sphere whose contact sticks from the first touch on, over Hertz's at the same small
/// depth, for Poisson's ratio `0 <= nu < 0.5`.
///
/// Every increment is Mossakovskii's bonded flat punch, `dP = 4 mu a L dh` with
/// `L = ln(3 - 4 nu) / (1 - 2 nu)`; the contact radius follows from self-similarity,
/// `h = a^2 / (2 I R)`, `I = int_0^1 t cos(b ln((1 - t)/(1 + t))) dt`, `b = ln(3 - 4 nu) / (2 pi)`
/// (Spence, Proc. R. Soc. A 305, 1968, 55; Borodich and Keer, Proc. R. Soc. A 460, 2004, 507), so
/// that the factor is `(1 - nu) L sqrt(2 I)`: 1.053 for `nu = 0`, 1 for `nu -> 0.5`.
#[must_use]
pub fn no_slip_factor(nu: f64) -> f64 {
    let log = (3.0 - 4.0 * nu).ln();
    let b = log / std::f64::consts::TAU;
    // with t = tanh x the integrand is smooth and falls like exp(-2 x)
    let end = 20.0;
    let integral: f64 = gauss(80)
        .iter()
        .map(|(y, w)| {
            let x = 0.5 * end * (1.0 + y);
            let t = x.tanh();
            0.5 * end * w * t * (1.0 - t * t) * (2.0 * b * x).cos()
        })
        .sum();
    (1.0 - nu) * log / (1.0 - 2.0 * nu) * (2.0 * integral).sqrt()
}
