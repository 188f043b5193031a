//! What keeps the specimen out of the ball.

use crate::scalar::Real;

/// Pressure of a penetration `g`: `p = k g (1 + g / g0)`.
///
/// Soft where the pressure is small, so that the first points to touch do not bounce, and stiffer
/// the harder the ball presses: pressures under a ball span many decades when a foam densifies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Penalty<T = f64> {
    /// Stiffness at first contact `k` (MPa/mm).
    pub stiffness: T,
    /// Growth `1 / g0` (1/mm), not negative; 0 is a linear penalty.
    pub growth: T,
}

impl<T: Real> Penalty<T> {
    /// A penalty that reaches each of two pressures (MPa, the second not below the first) at its
    /// penetration (mm), the first about linearly.
    #[must_use]
    pub fn through(first: (T, T), second: (T, T)) -> Self {
        let stiffness = first.0 / first.1;
        let secant = second.0 / second.1;
        let growth = (secant / stiffness - 1.0) / second.1;
        Self { stiffness, growth: if growth.value() > 0.0 { growth } else { T::from(0.0) } }
    }

    /// Energy (N/mm), pressure (MPa) and its slope (MPa/mm) at the penetration `g > 0` (mm).
    pub(super) fn push(&self, g: T) -> (T, T, T) {
        let (k, x) = (self.stiffness, g * self.growth);
        (k * g * g * (x / 3.0 + 0.5), k * g * (x + 1.0), k * (x * 2.0 + 1.0))
    }

    /// `p / g` (MPa/mm) and its slope by `g` (MPa/mm^2).
    pub(super) fn secant(&self, g: T) -> (T, T) {
        (self.stiffness * (g * self.growth + 1.0), self.stiffness * self.growth)
    }
}

impl Penalty {
    /// The linear penalty `p = k g`.
    #[must_use]
    pub fn linear(stiffness: f64) -> Self {
        Self { stiffness, growth: 0.0 }
    }
}
