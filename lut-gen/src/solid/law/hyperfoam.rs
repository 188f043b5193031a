//! Hyperfoam (Ogden-Hill) energy, thesis Eq. 1.

use super::error::demand;
use super::{Law, LawError, Parameter, Principal, Tangent};
use crate::scalar::Real;

/// One term of the Hyperfoam energy.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Term<T = f64> {
    /// Shear modulus of the term `mu_i` (MPa), not zero.
    pub mu_mpa: T,
    /// Exponent `alpha_i` (-), not zero; foams lie in 1..24.
    pub alpha: T,
    /// Poisson's ratio `nu_i` (-), in (-1, 0.5); 0 for open foams.
    pub nu: T,
}

/// Hyperfoam of N >= 1 terms (thesis Eq. 1, with `b_i = nu_i / (1 - 2 nu_i)`, Eq. 9):
///
/// ```text
/// U   = sum_i 2 mu_i / a_i^2 [ l1^a_i + l2^a_i + l3^a_i - 3 + (J^(-a_i b_i) - 1) / b_i ]
/// P_k = sum_i 2 mu_i / (a_i l_k) [ l_k^a_i - J^(-a_i b_i) ]
/// dP_k/dl_k = sum_i 2 mu_i / (a_i l_k^2) [ (a_i - 1) l_k^a_i + (1 + a_i b_i) J^(-a_i b_i) ]
/// dP_k/dl_m = sum_i 2 mu_i b_i J^(-a_i b_i) / (l_k l_m)
/// ```
///
/// With `nu_i = 0` the volumetric part is its exact limit `-a_i ln J`: the
/// three directions decouple. `U` grows without bound for `J -> 0`, so an
/// element cannot invert at finite energy. Its stretches are the elastic ones;
/// thermal expansion is the material's, see [`Material::warmed`](super::Material::warmed).
#[derive(Debug, Clone, PartialEq)]
pub struct Hyperfoam<T = f64> {
    terms: Vec<Term<T>>,
}

impl Hyperfoam {
    /// A law of the given terms.
    ///
    /// # Errors
    /// [`LawError`] names the term and the parameter when there is no term, a
    /// value is not finite, `mu` or `alpha` is zero, `nu` is outside (-1, 0.5),
    /// or the initial shear modulus is not positive.
    pub fn new(terms: Vec<Term>) -> Result<Self, LawError> {
        let check =
            |good, term, parameter, value, expected| demand(good, "hyperfoam", term, parameter, value, expected);
        check(!terms.is_empty(), 0, "number of terms", 0.0, "but at least one is needed")?;
        for (i, t) in terms.iter().enumerate() {
            let nonzero = |x: f64| x.is_finite() && x != 0.0;
            check(nonzero(t.mu_mpa), i + 1, "mu_mpa", t.mu_mpa, "must be finite and not zero")?;
            check(nonzero(t.alpha), i + 1, "alpha", t.alpha, "must be finite and not zero")?;
            check(t.nu > -1.0 && t.nu < 0.5, i + 1, "nu", t.nu, "must lie in (-1, 0.5)")?;
        }
        let law = Self { terms };
        let mu0 = law.shear_modulus_mpa();
        check(mu0 > 0.0, 0, "sum of mu_mpa", mu0, "must be positive")?;
        Ok(law)
    }

    /// One term with `nu = 0`, the thesis' model of a foam.
    ///
    /// # Errors
    /// As [`Hyperfoam::new`].
    pub fn one_term(mu_mpa: f64, alpha: f64) -> Result<Self, LawError> {
        Self::new(vec![Term { mu_mpa, alpha, nu: 0.0 }])
    }

    /// The terms.
    #[must_use]
    pub fn terms(&self) -> &[Term] {
        &self.terms
    }

    /// Nominal stress (MPa) of uniaxial stress at the stretch `l` for `nu = 0`
    /// in every term, where the sides do not move:
    /// `P = sum 2 mu/alpha (l^(alpha - 1) - 1/l)`; negative in compression.
    #[must_use]
    pub fn uniaxial_stress_mpa(&self, l: f64) -> f64 {
        self.stress([l, 1.0, 1.0]).1[0]
    }
}

impl<T: Real> Hyperfoam<T> {
    /// The same law with every parameter replaced by `f(name, value)`; nothing is checked.
    pub(super) fn map<U: Real>(&self, mut f: impl FnMut(Parameter, T) -> U) -> Hyperfoam<U> {
        let term = |(i, t): (usize, &Term<T>)| Term {
            mu_mpa: f(Parameter::Mu(i), t.mu_mpa),
            alpha: f(Parameter::Alpha(i), t.alpha),
            nu: f(Parameter::Nu(i), t.nu),
        };
        Hyperfoam { terms: self.terms.iter().enumerate().map(term).collect() }
    }
}

/// `(J^(-a b) - 1) / b`, `J^(-a b)` and `b`, with the exact limit for `b -> 0`:
/// where `a b ln J` is so small that the quotient would lose digits, its series.
fn volumetric<T: Real>(alpha: T, nu: T, ln_j: T) -> (T, T, T) {
    let beta = nu / (-nu * 2.0 + 1.0);
    let x = -alpha * beta * ln_j;
    if x.value().abs() < 1e-6 {
        // expm1(x) / b = -a ln J (1 + x/2 + ...), next term x^2/6 < 2e-13
        return (-alpha * ln_j * (x * 0.5 + 1.0), x + x * x * 0.5 + 1.0, beta);
    }
    let less_one = x.exp_m1();
    (less_one / beta, less_one + 1.0, beta)
}

impl<T: Real> Law<T> for Hyperfoam<T> {
    fn stress(&self, l: [T; 3]) -> (T, [T; 3]) {
        let ln = l.map(Real::ln);
        let ln_j = ln[0] + ln[1] + ln[2];
        let mut energy = T::from(0.0);
        let mut stress = [T::from(0.0); 3];
        for t in &self.terms {
            let (w, jab, _) = volumetric(t.alpha, t.nu, ln_j);
            let c = t.mu_mpa * 2.0 / t.alpha;
            let pow = ln.map(|x| (t.alpha * x).exp());
            energy += c / t.alpha * (pow[0] + pow[1] + pow[2] - 3.0 + w);
            for k in 0..3 {
                stress[k] += c / l[k] * (pow[k] - jab);
            }
        }
        (energy, stress)
    }

    /// `mu_0 = sum mu_i` (thesis Eq. 6).
    fn shear_modulus_mpa(&self) -> T {
        self.terms.iter().fold(T::from(0.0), |sum, t| sum + t.mu_mpa)
    }

    /// From `K_0 = sum 2 mu_i (1/3 + b_i)` (thesis Eq. 7) and `mu_0`; for one term it is `nu`.
    fn poisson_ratio(&self) -> T {
        let weighted = |sum: T, t: &Term<T>| sum + t.mu_mpa * t.nu / (-t.nu * 2.0 + 1.0);
        let beta = self.terms.iter().fold(T::from(0.0), weighted) / self.shear_modulus_mpa();
        beta / (beta * 2.0 + 1.0)
    }
}

impl Tangent for Hyperfoam {
    fn principal(&self, l: [f64; 3]) -> Principal {
        let ln = l.map(f64::ln);
        let inv = l.map(|x| 1.0 / x);
        let ln_j = ln[0] + ln[1] + ln[2];
        let mut out = Principal { energy: 0.0, stress: [0.0; 3], tangent: [[0.0; 3]; 3] };
        for t in &self.terms {
            let (w, jab, beta) = volumetric(t.alpha, t.nu, ln_j);
            let c = 2.0 * t.mu_mpa / t.alpha;
            let pow = ln.map(|x| (t.alpha * x).exp());
            out.energy += c / t.alpha * (pow[0] + pow[1] + pow[2] - 3.0 + w);
            let cross = 2.0 * t.mu_mpa * beta * jab;
            let volume = (1.0 + t.alpha * beta) * jab;
            for k in 0..3 {
                out.stress[k] += c * inv[k] * (pow[k] - jab);
                out.tangent[k][k] += c * inv[k] * inv[k] * ((t.alpha - 1.0) * pow[k] + volume);
                for m in 0..3 {
                    if m != k {
                        out.tangent[k][m] += cross * inv[k] * inv[m];
                    }
                }
            }
        }
        out
    }
}
