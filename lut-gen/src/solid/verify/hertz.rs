//! Hertz's rigid sphere on an elastic half-space.

/// `F = 4/3 E* sqrt(R) d^(3/2)` (N) with `E* = E / (1 - nu^2)` and
/// `E = 2 mu (1 + nu)` (Johnson, Contact Mechanics, 1985, Eq. 4.23).
/// Exact for `d -> 0`; lengths in mm, `mu` in MPa.
#[must_use]
pub fn hertz_force_n(mu_mpa: f64, nu: f64, radius_mm: f64, depth_mm: f64) -> f64 {
    let plane_modulus = 2.0 * mu_mpa / (1.0 - nu);
    4.0 / 3.0 * plane_modulus * radius_mm.sqrt() * depth_mm.max(0.0).powf(1.5)
}
