//! One of the elastic laws.

use super::{Hencky, Hyperfoam, Law, Ogden, Parameter, Principal, Tangent};
use crate::scalar::Real;

/// An elastic law of a kind known at run time.
#[derive(Debug, Clone, PartialEq)]
pub enum Elastic<T = f64> {
    /// Compressible foam, thesis Eq. 1.
    Hyperfoam(Hyperfoam<T>),
    /// Nearly incompressible solid, thesis Eq. 2.
    Ogden(Ogden<T>),
    /// Linear in logarithmic strain.
    Hencky(Hencky<T>),
}

impl<T: Real> Elastic<T> {
    /// The same law with every parameter replaced by `f(name, value)`.
    pub(super) fn map<U: Real>(&self, f: impl FnMut(Parameter, T) -> U) -> Elastic<U> {
        match self {
            Self::Hyperfoam(law) => Elastic::Hyperfoam(law.map(f)),
            Self::Ogden(law) => Elastic::Ogden(law.map(f)),
            Self::Hencky(law) => Elastic::Hencky(law.map(f)),
        }
    }
}

impl<T: Real> Law<T> for Elastic<T> {
    fn stress(&self, l: [T; 3]) -> (T, [T; 3]) {
        match self {
            Self::Hyperfoam(law) => law.stress(l),
            Self::Ogden(law) => law.stress(l),
            Self::Hencky(law) => law.stress(l),
        }
    }

    fn shear_modulus_mpa(&self) -> T {
        match self {
            Self::Hyperfoam(law) => law.shear_modulus_mpa(),
            Self::Ogden(law) => law.shear_modulus_mpa(),
            Self::Hencky(law) => law.shear_modulus_mpa(),
        }
    }

    fn poisson_ratio(&self) -> T {
        match self {
            Self::Hyperfoam(law) => law.poisson_ratio(),
            Self::Ogden(law) => law.poisson_ratio(),
            Self::Hencky(law) => law.poisson_ratio(),
        }
    }
}

impl Tangent for Elastic {
    fn principal(&self, l: [f64; 3]) -> Principal {
        match self {
            Self::Hyperfoam(law) => law.principal(l),
            Self::Ogden(law) => law.principal(l),
            Self::Hencky(law) => law.principal(l),
        }
    }
}
