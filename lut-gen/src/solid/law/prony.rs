//! Relaxation of the stress: finite-strain Prony series, thesis Eqs. 10-13.

use super::error::demand;
use super::{LawError, Parameter};
use crate::scalar::Real;

/// One Maxwell element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PronyTerm<T = f64> {
    /// Part `g_i` of the instantaneous shear stiffness that relaxes (-), in [0, 1).
    pub g: T,
    /// Part `k_i` of the instantaneous bulk stiffness that relaxes (-), in [0, 1).
    pub k: T,
    /// Relaxation time `tau_i` (s), positive.
    pub tau_s: T,
}

impl PronyTerm {
    /// The same part of shear and bulk relaxes.
    #[must_use]
    pub fn alike(g: f64, tau_s: f64) -> Self {
        Self { g, k: g, tau_s }
    }
}

impl<T: Real> PronyTerm<T> {
    pub(super) fn map<U: Real>(&self, i: usize, f: &mut impl FnMut(Parameter, T) -> U) -> PronyTerm<U> {
        PronyTerm {
            g: f(Parameter::PronyG(i), self.g),
            k: f(Parameter::PronyK(i), self.k),
            tau_s: f(Parameter::PronyTau(i), self.tau_s),
        }
    }
}

/// Checks a series.
///
/// # Errors
/// [`LawError`] when a part lies outside [0, 1), their sum reaches 1 (nothing would be
/// left at long times), or a relaxation time is not positive.
pub(super) fn check(series: &[PronyTerm]) -> Result<(), LawError> {
    let check = |good, term, parameter, value, expected| demand(good, "prony", term, parameter, value, expected);
    for (i, t) in series.iter().enumerate() {
        check((0.0..1.0).contains(&t.g), i + 1, "g", t.g, "must lie in [0, 1)")?;
        check((0.0..1.0).contains(&t.k), i + 1, "k", t.k, "must lie in [0, 1)")?;
        check(t.tau_s.is_finite() && t.tau_s > 0.0, i + 1, "tau_s", t.tau_s, "must be positive")?;
    }
    let (g, k) = (series.iter().map(|t| t.g).sum(), series.iter().map(|t| t.k).sum());
    check(g < 1.0, 0, "sum of g", g, "must be below 1")?;
    check(k < 1.0, 0, "sum of k", k, "must be below 1")
}

/// What a time step of given length does to every Maxwell element.
///
/// The stress is the convolution of the elastic second Piola-Kirchhoff stress, split into
/// the parts of its Kirchhoff deviator (`g`) and pressure (`k`) (Simo 1987,
/// doi:10.1016/0045-7825(87)90107-1; Holzapfel, Nonlinear Solid Mechanics, 2000, sec. 6.10),
/// with instantaneous moduli: `S(t) = S0(t) - sum_i int_0^t g_i (1 - exp(-(t-s)/tau_i)) dS0/ds ds`.
/// With `h_i = int g_i exp(-(t-s)/tau_i) dS0/ds ds` a step of length `dt`, over which `S0` moves
/// along a straight line, is exact:
///
/// ```text
/// h_i <- e_i h_i + g_i f_i (S0_new - S0_old),   e = exp(-x),  f = (1 - e) / x,  x = dt / tau_i
/// S   =  (1 - sum g_i) S0_new + sum h_i
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Relaxation<T = f64> {
    /// `dS/dS0` of the deviatoric part: `1 - sum g_i (1 - f_i)`.
    pub deviatoric: T,
    /// `dS/dS0` of the volumetric part.
    pub volumetric: T,
    /// Of each element: decay `e`, deviatoric gain `g f`, volumetric gain `k f`.
    pub elements: Vec<[T; 3]>,
}

impl<T: Real> Relaxation<T> {
    /// Factors of a step of `dt_s >= 0`.
    #[must_use]
    pub fn over(series: &[PronyTerm<T>], dt_s: f64) -> Self {
        let mut out = Self { deviatoric: T::from(1.0), volumetric: T::from(1.0), elements: Vec::new() };
        for t in series {
            let x = T::from(dt_s) / t.tau_s;
            let decay = (-x).exp();
            // (1 - e^-x) / x = 1 - x/2 + x^2/6: the neglected x^3/24 is below rounding
            let f = if x.value() < 1e-5 { x * x / 6.0 - x * 0.5 + 1.0 } else { -(-x).exp_m1() / x };
            out.deviatoric += t.g * (f - 1.0);
            out.volumetric += t.k * (f - 1.0);
            out.elements.push([decay, t.g * f, t.k * f]);
        }
        out
    }
}

/// Shear modulus left of a unit step at time `t_s`: `1 - sum g (1 - exp(-t / tau))`.
#[must_use]
pub fn relaxed(series: &[PronyTerm], t_s: f64) -> f64 {
    series.iter().fold(1.0, |sum, t| sum + t.g * (-t_s / t.tau_s).exp_m1())
}
