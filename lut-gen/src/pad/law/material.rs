//! Any of the laws, as the elements ask for it.

use super::foam::Foam;
use super::gradient::{Gradient, IDENTITY, Principal, Stretched};
use super::ogden::Ogden;
use super::plastic::{self, Plastic};
use super::relaxing::Relaxing;
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
    /// Relaxes.
    Relaxing(Relaxing),
}

impl Material {
    /// Shear modulus at rest (MPa).
    #[must_use]
    pub fn shear_mpa(&self) -> f64 {
        match self {
            Self::Ogden(law) => law.shear_mpa(),
            Self::Foam(law) => law.shear_mpa(),
            Self::Plastic(law) => law.shear_mpa(),
            Self::Relaxing(law) => law.shear_mpa(),
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
    /// Time since the moment that points remember (s).
    pub step_s: f64,
}

impl PointLaw<f64, 5> for Matter<'_> {
    fn rest(&self) -> Gradient {
        IDENTITY
    }

    fn states(&self) -> usize {
        match self.material {
            Material::Ogden(_) | Material::Foam(_) => 0,
            Material::Plastic(_) => plastic::STATES,
            Material::Relaxing(law) => law.states(),
        }
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
            Material::Relaxing(law) => law.flux(self.step_s, f, old, new),
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
            Material::Relaxing(law) => law.response(self.step_s, f, old),
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::foam::FoamTerm;
    use super::super::relaxing::Elastic;
    use super::*;

    /// Gradients that shear, turn, stretch alike and stretch apart.
    const GRADIENTS: [Gradient; 4] = [
        [1.02, 0.05, -0.03, 0.94, 1.01],
        [1.2, 0.3, -0.4, 0.8, 0.9],
        [0.9, 0.0, 0.0, 0.9, 1.1],
        [0.7, -0.1, 0.2, 1.1, 1.3],
    ];

    fn relaxing(elastic: Elastic) -> Material {
        Material::Relaxing(Relaxing::new(elastic, &[(0.3, 0.2), (0.2, 5.0)]).unwrap())
    }

    fn materials() -> Vec<Material> {
        let four = [(6.37e-3, 1.3416), (1.88e-4, 25.0), (-3.77e-3, -7.85), (1.84e-3, -10.89)];
        let foams =
            vec![FoamTerm { mu_mpa: 0.01, alpha: 14.8, nu: 0.0 }, FoamTerm { mu_mpa: 0.02, alpha: -3.0, nu: 0.3 }];
        vec![
            Material::Ogden(Ogden::neo_hooke(0.08, 1.6).unwrap()),
            Material::Ogden(Ogden::new(&four, 0.1).unwrap()),
            Material::Foam(Foam::new(foams).unwrap()),
            Material::Plastic(Plastic::new(0.1, 0.3).unwrap()),
            relaxing(Elastic::Ogden(Ogden::neo_hooke(0.08, 1.6).unwrap())),
            relaxing(Elastic::Foam(Foam::one_term(0.01, 14.8, 0.2).unwrap())),
        ]
    }

    /// Stress is the energy's slope and the tangent the stress': central differences of 1e-6, whose
    /// truncation is 1e-12 and whose rounding 1e-10 of values around 1.
    #[test]
    fn stress_and_tangent_are_difference_quotients() {
        for material in &materials() {
            // the third yields far below the elastic stress, the last never
            for yield_mpa in [0.003, f64::INFINITY] {
                let law = Matter { material, yield_mpa, step_s: 0.5 };
                let mut old = vec![0.0; law.states()];
                old.iter_mut().enumerate().for_each(|(i, x)| *x = 0.01 * (i as f64 - 2.0));
                for f in GRADIENTS {
                    let r = law.response(&f, &old).unwrap();
                    let (energy, flux) = law.flux(&f, &old, None).unwrap();
                    let scale = r.tangent.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
                    assert!((energy - r.energy).abs() < 1e-12 * scale);
                    for i in 0..5 {
                        assert!((flux[i] - r.flux[i]).abs() < 1e-12 * scale);
                        let moved = |h: f64| {
                            let mut g = f;
                            g[i] += h;
                            law.flux(&g, &old, None).unwrap()
                        };
                        let (plus, minus) = (moved(1e-6), moved(-1e-6));
                        let slope = (plus.0 - minus.0) / 2e-6;
                        assert!(
                            (slope - r.flux[i]).abs() < 1e-8 * scale,
                            "{material:?} {f:?} {i}: {slope} {:?}",
                            r.flux
                        );
                        for j in 0..5 {
                            let slope = (plus.1[j] - minus.1[j]) / 2e-6;
                            assert!((slope - r.tangent[j][i]).abs() < 1e-7 * scale, "{material:?} {f:?} {i} {j}");
                        }
                    }
                }
            }
        }
    }

    /// `mu/2 (J^(-2/3) I1 - 3) + K/2 (J - 1)^2`.
    #[test]
    fn one_term_of_exponent_2_is_neo_hookean() {
        let material = Material::Ogden(Ogden::neo_hooke(0.08, 1.6).unwrap());
        let law = Matter { material: &material, yield_mpa: 0.0, step_s: 0.5 };
        for f in GRADIENTS {
            let j = (f[0] * f[3] - f[1] * f[2]) * f[4];
            let i1: f64 = f.iter().map(|x| x * x).sum();
            let energy = 0.04 * (j.powf(-2.0 / 3.0) * i1 - 3.0) + 0.8 * (j - 1.0) * (j - 1.0);
            assert!((law.flux(&f, &[], None).unwrap().0 - energy).abs() < 1e-14);
        }
    }

    /// After a step the elastic part is on the yield surface, the flow kept the volume, and the
    /// same gradient again flows no further.
    #[test]
    fn a_point_that_yields_remembers_it() {
        let material = Material::Plastic(Plastic::new(0.1, 0.3).unwrap());
        let law = Matter { material: &material, yield_mpa: 0.004, step_s: 0.5 };
        let f = GRADIENTS[1];
        let mut old = vec![0.0; law.states()];
        // its volume from the start, so that one pass does
        old[plastic::LOG_VOLUME] = ((f[0] * f[3] - f[1] * f[2]) * f[4]).ln();
        let mut new = old.clone();
        let (_, p) = law.flux(&f, &old, Some(&mut new)).unwrap();
        let of = |p: &Gradient| super::super::gradient::mises(&super::super::gradient::cauchy(&f, p));
        assert!((of(&p) - 0.004).abs() < 1e-12, "{}", of(&p));
        let det = ((1.0 + new[0]) * (1.0 + new[3]) - new[1] * new[2]) * (1.0 + new[4]);
        assert!((det - 1.0).abs() < 1e-12, "{det}");
        let mut again = new.clone();
        let (_, same) = law.flux(&f, &new, Some(&mut again)).unwrap();
        assert!(p.iter().zip(&same).all(|(a, b)| (a - b).abs() < 1e-12));
        assert!((again[plastic::PLASTIC_STRAIN] - new[plastic::PLASTIC_STRAIN]).abs() < 1e-10);
    }

    /// A stretch held at once and for long: the stress falls to its part `1 - sum g + sum g exp(-t
    /// / tau)`, whatever the steps.
    #[test]
    fn a_held_stretch_relaxes_by_the_series() {
        let elastic = Material::Ogden(Ogden::neo_hooke(0.08, 1.6).unwrap());
        let material = relaxing(Elastic::Ogden(Ogden::neo_hooke(0.08, 1.6).unwrap()));
        // pulled along x without a change of volume, so that only the deviator acts
        let f = [1.3, 0.0, 0.0, 1.0 / 1.3, 1.0];
        let whole = Matter { material: &elastic, yield_mpa: 0.0, step_s: 0.0 }.flux(&f, &[], None).unwrap().1;
        let mut law = Matter { material: &material, yield_mpa: 0.0, step_s: 0.0 };
        let mut old = vec![0.0; law.states()];
        let mut time = 0.0;
        for step_s in [0.0, 0.1, 0.7, 4.0] {
            law.step_s = step_s;
            time += step_s;
            let mut new = old.clone();
            let (_, p) = law.flux(&f, &old, Some(&mut new)).unwrap();
            old = new;
            let part = 0.5 + 0.3 * f64::exp(-time / 0.2) + 0.2 * f64::exp(-time / 5.0);
            assert!((p[0] / whole[0] - part).abs() < 1e-12, "{time}: {} {part}", p[0] / whole[0]);
        }
    }

    #[test]
    fn points_that_turn_over_are_refused() {
        for material in &materials() {
            let law = Matter { material, yield_mpa: 1.0, step_s: 0.5 };
            let old = vec![0.0; law.states()];
            assert!(law.flux(&[-1.0, 0.0, 0.0, 1.0, 1.0], &old, None).is_none());
            assert!(law.response(&[1.0, 0.0, 0.0, 1.0, -1.0], &old).is_none());
        }
    }

    #[test]
    fn values_out_of_range_are_named() {
        let text = Ogden::new(&[(0.1, 0.0)], 1.0).unwrap_err().to_string();
        assert_eq!(text, "an Ogden term's alpha is 0: expected a number that is not 0");
        assert!(Ogden::new(&[], 1.0).is_err() && Ogden::new(&[(-0.1, 2.0)], 1.0).is_err());
        assert!(Foam::one_term(0.1, 2.0, 0.5).is_err() && Plastic::new(f64::NAN, 0.3).is_err());
    }
}
