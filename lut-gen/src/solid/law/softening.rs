//! Softening with cycles (Mullins' effect).

use super::error::demand;
use super::{LawError, Parameter};
use crate::scalar::Real;

/// Ogden and Roxburgh's pseudo-elastic softening: below the largest energy `W_max` a
/// material point has ever stored, its stress is multiplied by
///
/// ```text
/// eta = 1 - 1/r erf( (W_max - W) / (m + beta W_max) )
/// ```
///
/// (Ogden and Roxburgh 1999, doi:10.1098/rspa.1999.0431, with the `beta` of Abaqus; applied
/// to the whole stress, as Abaqus does for elastomeric foams). First loading is unchanged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OgdenRoxburgh<T = f64> {
    /// Largest part of the stress that is lost is `1 / r`; `r > 1`.
    pub r: T,
    /// Energy scale `m` (MPa), not negative.
    pub m_mpa: T,
    /// Part of `W_max` added to `m` (-), not negative; `m + beta` must be positive.
    pub beta: T,
}

impl OgdenRoxburgh {
    /// Checked parameters.
    ///
    /// # Errors
    /// [`LawError`] when `r <= 1`, a value is negative, or both `m` and `beta` are 0.
    pub fn new(r: f64, m_mpa: f64, beta: f64) -> Result<Self, LawError> {
        let check = |good, parameter, value, expected| demand(good, "ogden-roxburgh", 1, parameter, value, expected);
        check(r.is_finite() && r > 1.0, "r", r, "must be above 1")?;
        check(m_mpa.is_finite() && m_mpa >= 0.0, "m_mpa", m_mpa, "must not be negative")?;
        check(beta.is_finite() && beta >= 0.0, "beta", beta, "must not be negative")?;
        check(m_mpa + beta > 0.0, "m_mpa + beta", m_mpa + beta, "must be positive")?;
        Ok(Self { r, m_mpa, beta })
    }
}

impl<T: Real> OgdenRoxburgh<T> {
    pub(super) fn map<U: Real>(&self, f: &mut impl FnMut(Parameter, T) -> U) -> OgdenRoxburgh<U> {
        OgdenRoxburgh {
            r: f(Parameter::SofteningR, self.r),
            m_mpa: f(Parameter::SofteningM, self.m_mpa),
            beta: f(Parameter::SofteningBeta, self.beta),
        }
    }

    /// `eta`, `d eta / dW` and the new largest energy.
    pub(crate) fn factor(&self, energy: T, largest: T) -> (T, T, T) {
        if energy.value() >= largest.value() {
            return (T::from(1.0), T::from(0.0), energy);
        }
        let scale = self.m_mpa + self.beta * largest;
        if scale.value() <= 0.0 {
            // nothing was stored yet but rounding
            return (T::from(1.0), T::from(0.0), largest);
        }
        let x = (largest - energy) / scale;
        let slope = (-(x * x)).exp() * std::f64::consts::FRAC_2_SQRT_PI / (self.r * scale);
        (-x.erf() / self.r + 1.0, slope, largest)
    }
}
