//! Any of the laws, as the elements ask for it.

use super::foam::Foam;
use super::gradient::{Gradient, IDENTITY, Principal, Stretched};
use super::ogden::Ogden;
use super::plastic::{self, Plastic};
use crate::fem::operator::{PointLaw, PointTangent, Response};

/// What a part of a body is made of.
#[derive(Debug, Clone, PartialEq)]
pub enum Material {
    /// Nearly incompressible: skin, tissue.
    Ogden(Ogden),
    /// Compressible foam.
    Foam(Foam),
    /// Yields at the stress of the press' programme.
    Plastic(Plastic),
}

impl Material {
    /// Shear modulus at rest (MPa).
    #[must_use]
    pub fn shear_mpa(&self) -> f64 {
        match self {
            Self::Ogden(law) => law.shear_mpa(),
            Self::Foam(law) => law.shear_mpa(),
            Self::Plastic(law) => law.shear_mpa(),
        }
    }
}

/// A material at one moment.
#[derive(Debug, Clone, Copy)]
pub struct Matter<'a> {
    /// The material.
    pub material: &'a Material,
    /// Yield stress of plastic materials now (MPa, Cauchy).
    pub yield_mpa: f64,
}

impl PointLaw<f64, 5> for Matter<'_> {
    fn rest(&self) -> Gradient {
        IDENTITY
    }

    fn states(&self) -> usize {
        if matches!(self.material, Material::Plastic(_)) { plastic::STATES } else { 0 }
    }

    fn flux(&self, f: &Gradient, old: &[f64], new: Option<&mut [f64]>) -> Option<(f64, Gradient)> {
        let elastic = |u: &dyn Fn([f64; 3]) -> Principal| {
            let stretched = Stretched::of(f)?;
            let u = u(stretched.logarithms());
            Some((u.energy, stretched.stress(u.kirchhoff)))
        };
        match self.material {
            Material::Ogden(law) => elastic(&|ln| law.principal(ln)),
            Material::Foam(law) => elastic(&|ln| law.principal(ln)),
            Material::Plastic(law) => law.flux(self.yield_mpa, f, old, new),
        }
    }
}

impl PointTangent<5> for Matter<'_> {
    fn response(&self, f: &Gradient, old: &[f64]) -> Option<Response<5>> {
        let elastic = |u: &dyn Fn([f64; 3]) -> Principal| {
            let stretched = Stretched::of(f)?;
            Some(stretched.respond(&u(stretched.logarithms())))
        };
        match self.material {
            Material::Ogden(law) => elastic(&|ln| law.principal(ln)),
            Material::Foam(law) => elastic(&|ln| law.principal(ln)),
            Material::Plastic(law) => law.response(self.yield_mpa, f, old),
        }
    }
}
