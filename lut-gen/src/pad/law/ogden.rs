//! Ogden's energy of a nearly incompressible solid: skin and tissue.

use super::gradient::Principal;
use crate::pad::error::{PadError, demand};

/// Ogden's law of one to four terms on isochoric stretches `m_k = J^(-1/3) l_k`, with a bulk
/// modulus (Abaqus' form, thesis Eq. 2; a term with alpha 2 is neo-Hookean, `mu/2 (J^(-2/3) I1 -
/// 3)`):
///
/// ```text
/// U = sum_i 2 mu_i / a_i^2 [ m1^a_i + m2^a_i + m3^a_i - 3 ] + K/2 (J - 1)^2
/// ```
///
/// The volumetric part stays finite for `J -> 0`; elements refuse `J <= 0`.
#[derive(Debug, Clone, PartialEq)]
pub struct Ogden {
    terms: Vec<(f64, f64)>,
    bulk_mpa: f64,
}

/// Most terms of the law.
const MOST_TERMS: usize = 4;

/// Bulk modulus over shear modulus of Poisson's ratio 0.475.
pub const BULK_OF_0475: f64 = 19.667;

impl Ogden {
    /// A law of terms `(mu_i in MPa, alpha_i)` and a bulk modulus (MPa).
    ///
    /// # Errors
    /// [`PadError::Value`] when there are none or more than four terms, a value is not finite, an
    /// exponent is 0, or the sum of the shear moduli or the bulk modulus is not positive.
    pub fn new(terms: &[(f64, f64)], bulk_mpa: f64) -> Result<Self, PadError> {
        let count = terms.len();
        demand((1..=MOST_TERMS).contains(&count), "the number of Ogden's terms", count as f64, "1 to 4")?;
        for &(mu, alpha) in terms {
            demand(mu.is_finite(), "an Ogden term's mu (MPa)", mu, "a number")?;
            demand(alpha.is_finite() && alpha != 0.0, "an Ogden term's alpha", alpha, "a number that is not 0")?;
        }
        let sum: f64 = terms.iter().map(|t| t.0).sum();
        demand(sum > 0.0, "the sum of Ogden's mu (MPa)", sum, "more than 0")?;
        demand(bulk_mpa > 0.0 && bulk_mpa.is_finite(), "the bulk modulus (MPa)", bulk_mpa, "more than 0")?;
        Ok(Self { terms: terms.to_vec(), bulk_mpa })
    }

    /// The neo-Hookean law of a shear and a bulk modulus (MPa).
    ///
    /// # Errors
    /// As [`Ogden::new`].
    pub fn neo_hooke(mu_mpa: f64, bulk_mpa: f64) -> Result<Self, PadError> {
        Self::new(&[(mu_mpa, 2.0)], bulk_mpa)
    }

    /// Shear modulus at rest (MPa).
    #[must_use]
    pub fn shear_mpa(&self) -> f64 {
        self.terms.iter().map(|t| t.0).sum()
    }

    /// Energy and derivatives; with `b_k = m_k^a`, `B = sum b`:
    /// `d tau_k / d ln l_m = sum 2 mu [b_k d_km - (b_k + b_m)/3 + B/9] + J (U' + J U'')`.
    #[must_use]
    pub fn principal(&self, ln: [f64; 3]) -> Principal {
        self.parts(ln, 1.0, 1.0)
    }

    /// Part of the isochoric and part of the volumetric energy, with their derivatives.
    pub(super) fn parts(&self, ln: [f64; 3], isochoric: f64, volumetric: f64) -> Principal {
        let bulk = volumetric * self.bulk_mpa;
        let ln_j = ln[0] + ln[1] + ln[2];
        let j = ln_j.exp();
        let x = j - 1.0;
        let mut energy = 0.5 * bulk * x * x;
        let mut kirchhoff = [j * bulk * x; 3];
        let mut slope = [[bulk * j * (x + j); 3]; 3];
        for &(mu, alpha) in &self.terms {
            let mu = isochoric * mu;
            let b = ln.map(|x| (alpha * (x - ln_j / 3.0)).exp());
            let sum = b[0] + b[1] + b[2];
            let c = 2.0 * mu / alpha;
            energy += c / alpha * (sum - 3.0);
            for k in 0..3 {
                kirchhoff[k] += c * (b[k] - sum / 3.0);
                slope[k][k] += 2.0 * mu * b[k];
                for m in 0..3 {
                    slope[k][m] += 2.0 * mu * (sum / 9.0 - (b[k] + b[m]) / 3.0);
                }
            }
        }
        Principal { energy, kirchhoff, slope }
    }
}
