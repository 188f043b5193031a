//! What happens between ball and specimen: friction and adhesion.

use crate::scalar::Real;
use crate::solid::solve::SolveError;

/// Attraction between ball and specimen across a gap `s >= 0`.
///
/// A traction of the exponential kind (Xu and Needleman 1993, doi:10.1088/0965-0393/1/2/001):
/// `T(s) = w s / delta^2 exp(-s / delta)` with the area `w`. Its largest value `w / (e delta)`
/// is at `s = delta`. For `delta` small against the elastic neck, at a large Tabor parameter,
/// this is JKR's limit; for a stiff specimen DMT's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Adhesion<T = f64> {
    /// Work of adhesion `w` per reference area (N/mm).
    pub work_n_per_mm: T,
    /// Range of the attraction `delta` (mm).
    pub range_mm: f64,
}

/// Gaps beyond this many ranges are not attracted: `T` there is 3e-5 of its largest value.
const FAR: f64 = 14.0;

impl<T: Real> Adhesion<T> {
    /// Energy (N/mm), pressure (MPa, negative as it pulls) and its slope by depth (MPa/mm) at
    /// the depth `g < 0` of a point outside the ball.
    pub(super) fn pull(&self, depth_mm: T) -> (T, T, T) {
        let x = depth_mm / self.range_mm;
        if x.value() < -FAR {
            return (T::from(0.0), T::from(0.0), T::from(0.0));
        }
        let decay = x.exp() * self.work_n_per_mm;
        let per = 1.0 / self.range_mm;
        ((x - 1.0) * decay, x * decay * per, (x + 1.0) * decay * (per * per))
    }
}

/// Friction and adhesion between ball and specimen; neither by default.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Interface<T = f64> {
    /// Coefficient of Coulomb friction, not negative.
    pub friction: T,
    /// Attraction, if any.
    pub adhesion: Option<Adhesion<T>>,
}

impl Interface {
    /// Checks the ranges.
    ///
    /// # Errors
    /// [`SolveError::Parameter`] when friction is negative or above 2, or work or range is not positive.
    pub fn check(&self) -> Result<(), SolveError> {
        let demand = |good: bool, parameter, value, expected: &str| {
            if good { Ok(()) } else { Err(SolveError::Parameter { parameter, value, expected: expected.to_owned() }) }
        };
        demand((0.0..=2.0).contains(&self.friction), "friction", self.friction, "must lie in 0..2")?;
        let Some(a) = self.adhesion else { return Ok(()) };
        let positive = |x: f64| x.is_finite() && x > 0.0;
        demand(positive(a.work_n_per_mm), "work of adhesion", a.work_n_per_mm, "must be positive")?;
        demand(positive(a.range_mm), "range of adhesion", a.range_mm, "must be positive")
    }
}
