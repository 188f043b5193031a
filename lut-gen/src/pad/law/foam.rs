//! Energy of a compressible foam.

use super::gradient::Principal;
use crate::pad::error::{PadError, demand};

/// Ogden-Hill foam (Storakers 1986; thesis Eq. 1, `b_i = nu_i / (1 - 2 nu_i)`):
///
/// ```text
/// U = sum_i 2 mu_i / a_i^2 [ l1^a_i + l2^a_i + l3^a_i - 3 + (J^(-a_i b_i) - 1) / b_i ]
/// ```
///
/// For `nu_i = 0` the volumetric part is its limit `-a_i ln J`. `U` grows without bound for `J ->
/// 0`.
#[derive(Debug, Clone, PartialEq)]
pub struct Foam {
    terms: Vec<FoamTerm>,
}

/// One term of a foam.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FoamTerm {
    /// Shear modulus (MPa).
    pub mu_mpa: f64,
    /// Exponent, not 0.
    pub alpha: f64,
    /// Poisson's ratio, in (-1, 0.5).
    pub nu: f64,
}

impl Foam {
    /// A law of the given terms.
    ///
    /// # Errors
    /// [`PadError::Value`] when there is no term, a value is not finite or out of range, or the sum
    /// of the shear moduli is not positive.
    pub fn new(terms: Vec<FoamTerm>) -> Result<Self, PadError> {
        demand(!terms.is_empty(), "the number of a foam's terms", 0.0, "1 or more")?;
        for t in &terms {
            demand(t.mu_mpa.is_finite(), "a foam's mu (MPa)", t.mu_mpa, "a number")?;
            demand(t.alpha.is_finite() && t.alpha != 0.0, "a foam's alpha", t.alpha, "a number that is not 0")?;
            demand(t.nu > -1.0 && t.nu < 0.5, "a foam's Poisson ratio", t.nu, "a number between -1 and 0.5")?;
        }
        let sum: f64 = terms.iter().map(|t| t.mu_mpa).sum();
        demand(sum > 0.0, "the sum of a foam's mu (MPa)", sum, "more than 0")?;
        Ok(Self { terms })
    }

    /// One term (MPa, -, -).
    ///
    /// # Errors
    /// As [`Foam::new`].
    pub fn one_term(mu_mpa: f64, alpha: f64, nu: f64) -> Result<Self, PadError> {
        Self::new(vec![FoamTerm { mu_mpa, alpha, nu }])
    }

    /// Shear modulus at rest (MPa).
    #[must_use]
    pub fn shear_mpa(&self) -> f64 {
        self.terms.iter().map(|t| t.mu_mpa).sum()
    }

    /// Energy and derivatives: `tau_k = sum 2 mu/a (l_k^a - J^(-a b))`,
    /// `d tau_k / d ln l_m = sum 2 mu (l_k^a d_km + b J^(-a b))`.
    #[must_use]
    pub fn principal(&self, ln: [f64; 3]) -> Principal {
        let ln_j = ln[0] + ln[1] + ln[2];
        let mut u = Principal { energy: 0.0, kirchhoff: [0.0; 3], slope: [[0.0; 3]; 3] };
        for t in &self.terms {
            let b = t.nu / (1.0 - 2.0 * t.nu);
            let c = 2.0 * t.mu_mpa / t.alpha;
            let power = ln.map(|x| (t.alpha * x).exp_m1());
            let volume = (-t.alpha * b * ln_j).exp_m1();
            let volumetric = if b == 0.0 { -t.alpha * ln_j } else { volume / b };
            u.energy += c / t.alpha * (power[0] + power[1] + power[2] + volumetric);
            for (k, power) in power.into_iter().enumerate() {
                u.kirchhoff[k] += c * (power - volume);
                u.slope[k][k] += 2.0 * t.mu_mpa * (power + 1.0);
                u.slope[k].iter_mut().for_each(|s| *s += 2.0 * t.mu_mpa * b * (volume + 1.0));
            }
        }
        u
    }
}
