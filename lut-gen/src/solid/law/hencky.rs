//! Linear elasticity in logarithmic strain.

use super::error::demand;
use super::{Law, LawError, Parameter, Principal, Tangent};
use crate::scalar::Real;

/// Hencky's law: linear elasticity carried to finite strain by the logarithmic strain,
/// which is what "linear elastic" means in a large-displacement analysis (Hencky 1928;
/// Anand 1979, doi:10.1115/1.3424532, who finds it good to strains of about 0.3):
///
/// ```text
/// U   = mu (ln^2 l1 + ln^2 l2 + ln^2 l3) + lambda/2 ln^2 J,   lambda = 2 mu nu / (1 - 2 nu)
/// P_k = (2 mu ln l_k + lambda ln J) / l_k
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hencky<T = f64> {
    mu_mpa: T,
    nu: T,
}

impl Hencky {
    /// A law of the shear modulus `mu_mpa` (MPa) and Poisson's ratio `nu`.
    ///
    /// # Errors
    /// [`LawError`] when `mu` is not positive or `nu` is outside (-1, 0.5).
    pub fn new(mu_mpa: f64, nu: f64) -> Result<Self, LawError> {
        demand(mu_mpa.is_finite() && mu_mpa > 0.0, "linear elastic", 1, "mu_mpa", mu_mpa, "must be positive")?;
        demand(nu > -1.0 && nu < 0.5, "linear elastic", 1, "nu", nu, "must lie in (-1, 0.5)")?;
        Ok(Self { mu_mpa, nu })
    }

    /// A law of Young's modulus (MPa) and Poisson's ratio.
    ///
    /// # Errors
    /// As [`Hencky::new`].
    pub fn from_young(young_mpa: f64, nu: f64) -> Result<Self, LawError> {
        Self::new(young_mpa / (2.0 * (1.0 + nu)), nu)
    }
}

impl<T: Real> Hencky<T> {
    /// The same law with every parameter replaced by `f(name, value)`; nothing is checked.
    pub(super) fn map<U: Real>(&self, mut f: impl FnMut(Parameter, T) -> U) -> Hencky<U> {
        Hencky { mu_mpa: f(Parameter::Mu(0), self.mu_mpa), nu: f(Parameter::Nu(0), self.nu) }
    }

    fn lambda(&self) -> T {
        self.mu_mpa * self.nu * 2.0 / (-self.nu * 2.0 + 1.0)
    }
}

impl<T: Real> Law<T> for Hencky<T> {
    fn stress(&self, l: [T; 3]) -> (T, [T; 3]) {
        let ln = l.map(Real::ln);
        let ln_j = ln[0] + ln[1] + ln[2];
        let square = ln[0] * ln[0] + ln[1] * ln[1] + ln[2] * ln[2];
        let energy = self.mu_mpa * square + self.lambda() * ln_j * ln_j * 0.5;
        (energy, std::array::from_fn(|k| (self.mu_mpa * ln[k] * 2.0 + self.lambda() * ln_j) / l[k]))
    }

    fn shear_modulus_mpa(&self) -> T {
        self.mu_mpa
    }

    fn poisson_ratio(&self) -> T {
        self.nu
    }
}

impl Tangent for Hencky {
    fn principal(&self, l: [f64; 3]) -> Principal {
        let (energy, stress) = self.stress(l);
        let tangent = std::array::from_fn(|k| {
            std::array::from_fn(|m| {
                let same = f64::from(u8::from(k == m));
                (2.0 * self.mu_mpa * same + self.lambda() - same * stress[k] * l[k]) / (l[k] * l[m])
            })
        });
        Principal { energy, stress, tangent }
    }
}
