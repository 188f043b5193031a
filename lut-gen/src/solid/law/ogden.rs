//! Ogden energy of a nearly incompressible solid, thesis Eq. 2.

use super::error::demand;
use super::{Law, LawError, Parameter, Principal, Tangent};
use crate::scalar::Real;

/// One term of the Ogden energy.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OgdenTerm<T = f64> {
    /// Shear modulus of the term `mu_i` (MPa), not zero.
    pub mu_mpa: T,
    /// Exponent `alpha_i` (-), not zero.
    pub alpha: T,
    /// Compressibility `D_i` (1/MPa): positive in the first term; 0 leaves out the
    /// volumetric term of order `2 i`.
    pub d_per_mpa: T,
}

/// Ogden's law of N = 1..4 terms with Abaqus' volumetric term (thesis Eqs. 2, 3 and 8, with
/// the deviatoric stretches `m_i = J^(-1/3) l_i` in the first sum; with total stretches, as
/// printed, the reference state would not be stress-free):
///
/// ```text
/// U   = sum_i 2 mu_i / a_i^2 [ m1^a_i + m2^a_i + m3^a_i - 3 ] + sum_i (J - 1)^(2 i) / D_i
/// P_k = 1/l_k { sum_i 2 mu_i / a_i [ m_k^a_i - mean_j m_j^a_i ] + J U_vol'(J) }
/// ```
///
/// `mu_0 = sum mu_i`, `K_0 = 2 / D_1` (thesis Eqs. 6 and 8). Eight-node elements with
/// 2 x 2 points do not lock at large `K_0 / mu_0` (`lut-gen/tests/suite/simulation.rs`).
#[derive(Debug, Clone, PartialEq)]
pub struct Ogden<T = f64> {
    terms: Vec<OgdenTerm<T>>,
}

/// Most terms of the law.
const MOST_TERMS: usize = 4;

impl Ogden {
    /// A law of the given terms.
    ///
    /// # Errors
    /// [`LawError`] names the term and the parameter when there are none or more than four
    /// terms, a value is not finite, `mu` or `alpha` is zero, the first `D` is not positive,
    /// another is negative, or the initial shear modulus is not positive.
    pub fn new(terms: Vec<OgdenTerm>) -> Result<Self, LawError> {
        let check = |good, term, parameter, value, expected| demand(good, "ogden", term, parameter, value, expected);
        let count = terms.len();
        check((1..=MOST_TERMS).contains(&count), 0, "number of terms", count as f64, "but 1 to 4 are allowed")?;
        for (i, t) in terms.iter().enumerate() {
            let nonzero = |x: f64| x.is_finite() && x != 0.0;
            check(nonzero(t.mu_mpa), i + 1, "mu_mpa", t.mu_mpa, "must be finite and not zero")?;
            check(nonzero(t.alpha), i + 1, "alpha", t.alpha, "must be finite and not zero")?;
            let d = t.d_per_mpa;
            if i == 0 {
                check(d.is_finite() && d > 0.0, 1, "d_per_mpa", d, "must be positive")?;
            } else {
                check(d.is_finite() && d >= 0.0, i + 1, "d_per_mpa", d, "must not be negative")?;
            }
        }
        let law = Self { terms };
        let mu0 = law.shear_modulus_mpa();
        check(mu0 > 0.0, 0, "sum of mu_mpa", mu0, "must be positive")?;
        Ok(law)
    }

    /// One term.
    ///
    /// # Errors
    /// As [`Ogden::new`].
    pub fn one_term(mu_mpa: f64, alpha: f64, d_per_mpa: f64) -> Result<Self, LawError> {
        Self::new(vec![OgdenTerm { mu_mpa, alpha, d_per_mpa }])
    }

    /// The terms.
    #[must_use]
    pub fn terms(&self) -> &[OgdenTerm] {
        &self.terms
    }
}

impl<T: Real> Ogden<T> {
    /// The same law with every parameter replaced by `f(name, value)`; nothing is checked.
    pub(super) fn map<U: Real>(&self, mut f: impl FnMut(Parameter, T) -> U) -> Ogden<U> {
        let term = |(i, t): (usize, &OgdenTerm<T>)| OgdenTerm {
            mu_mpa: f(Parameter::Mu(i), t.mu_mpa),
            alpha: f(Parameter::Alpha(i), t.alpha),
            d_per_mpa: f(Parameter::Compressibility(i), t.d_per_mpa),
        };
        Ogden { terms: self.terms.iter().enumerate().map(term).collect() }
    }

    /// Volumetric energy, `U_vol'` and `U_vol''` at the volume ratio `j`.
    fn volumetric(&self, j: T) -> (T, T, T) {
        let x = j - 1.0;
        let mut power = T::from(1.0); // x^(2 i - 2)
        let (mut energy, mut slope, mut second) = (T::from(0.0), T::from(0.0), T::from(0.0));
        for (i, t) in self.terms.iter().enumerate() {
            let order = 2.0 * (i + 1) as f64;
            if t.d_per_mpa.value() > 0.0 {
                energy += power * x * x / t.d_per_mpa;
                slope += power * x * order / t.d_per_mpa;
                second += power * order * (order - 1.0) / t.d_per_mpa;
            }
            power = power * x * x;
        }
        (energy, slope, second)
    }
}

impl<T: Real> Law<T> for Ogden<T> {
    fn stress(&self, l: [T; 3]) -> (T, [T; 3]) {
        let ln = l.map(Real::ln);
        let ln_j = ln[0] + ln[1] + ln[2];
        let j = ln_j.exp();
        let (mut energy, slope, _) = self.volumetric(j);
        let mut kirchhoff = [j * slope; 3];
        for t in &self.terms {
            let m = ln.map(|x| (t.alpha * (x - ln_j / 3.0)).exp());
            let sum = m[0] + m[1] + m[2];
            let c = t.mu_mpa * 2.0 / t.alpha;
            energy += c / t.alpha * (sum - 3.0);
            for k in 0..3 {
                kirchhoff[k] += c * (m[k] - sum / 3.0);
            }
        }
        (energy, std::array::from_fn(|k| kirchhoff[k] / l[k]))
    }

    fn shear_modulus_mpa(&self) -> T {
        self.terms.iter().fold(T::from(0.0), |sum, t| sum + t.mu_mpa)
    }

    /// From `K_0 = 2 / D_1` and `mu_0`: `(3 K - 2 mu) / (6 K + 2 mu)`.
    fn poisson_ratio(&self) -> T {
        let (mu, k) = (self.shear_modulus_mpa(), T::from(2.0) / self.terms[0].d_per_mpa);
        (k * 3.0 - mu * 2.0) / (k * 6.0 + mu * 2.0)
    }
}

impl Tangent for Ogden {
    /// With `b_k = m_k^a`, `B = sum b`: `d tau_k / d ln l_m = sum 2 mu [b_k d_km - b_k/3 - b_m/3 + B/9]`
    /// plus `J (U' + J U'')`; then `H_km = (d tau_k / d ln l_m - d_km tau_k) / (l_k l_m)`.
    fn principal(&self, l: [f64; 3]) -> Principal {
        let ln = l.map(f64::ln);
        let ln_j = ln[0] + ln[1] + ln[2];
        let j = ln_j.exp();
        let (mut energy, slope, second) = self.volumetric(j);
        let mut tau = [j * slope; 3];
        let mut d = [[j * (slope + j * second); 3]; 3];
        for t in &self.terms {
            let b = ln.map(|x| (t.alpha * (x - ln_j / 3.0)).exp());
            let sum = b[0] + b[1] + b[2];
            let c = 2.0 * t.mu_mpa / t.alpha;
            energy += c / t.alpha * (sum - 3.0);
            for k in 0..3 {
                tau[k] += c * (b[k] - sum / 3.0);
                d[k][k] += 2.0 * t.mu_mpa * b[k];
                for m in 0..3 {
                    d[k][m] += 2.0 * t.mu_mpa * (sum / 9.0 - (b[k] + b[m]) / 3.0);
                }
            }
        }
        for k in 0..3 {
            d[k][k] -= tau[k];
        }
        Principal {
            energy,
            stress: std::array::from_fn(|k| tau[k] / l[k]),
            tangent: std::array::from_fn(|k| std::array::from_fn(|m| d[k][m] / (l[k] * l[m]))),
        }
    }
}
