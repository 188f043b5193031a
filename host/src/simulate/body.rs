//! What specimen, material and contact effects make of the declared specimen and ball: the finite-element case.

use lut_gen::solid::contact::{Adhesion, Ball, Interface};
use lut_gen::solid::law::{Hyperfoam, LawError, Material, Ogden, OgdenRoxburgh, OgdenTerm, Term};
use lut_gen::solid::model::{Resolution, Simulation, Specimen as Block};
use lut_gen::solid::solve::{Base as Bottom, Motion};

use crate::experiment::Base;

use super::SimulateError;
use super::effect::Effect;
use super::spec::{Spec, TrueIndenter, TrueLaw, TrueSpecimen};

/// A true specimen under a true ball. The material is that of a first shear modulus of 1 MPa, to which every stress and the
/// force are proportional: foams that differ by stiffness alone share their solves.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Body {
    pub material: Material,
    /// The true first shear modulus, MPa: factor on the force. Of a warmed specimen that of its grown volume.
    pub scale: f64,
    pub block: Block,
    pub ball: Ball,
    pub interface: Interface,
    /// Divisor of element sizes.
    pub refinement: f64,
    /// Exponents and weights of a table too coarse in alpha, if that is an effect.
    pub coarse_alpha: Option<[(f64, f64); 2]>,
    /// Reduced modulus (MPa) of a block that is not computed by finite elements.
    pub rigid_mpa: Option<f64>,
    /// Names the case.
    pub place: String,
}

impl Body {
    pub fn new(spec: &Spec, specimen: &TrueSpecimen, indenter: &TrueIndenter) -> Result<Self, SimulateError> {
        let place = format!("specimen \"{}\" under ball \"{}\"", specimen.name, indenter.name);
        let law_error = |cause| SimulateError::Law { place: place.clone(), cause };
        let rigid_mpa = match specimen.law {
            TrueLaw::Rigid { reduced_modulus_mpa } => Some(reduced_modulus_mpa),
            _ => None,
        };
        let scale = if rigid_mpa.is_some() { 1.0 } else { specimen.mu_mpa };
        let material = material(specimen, specimen.alpha, scale, &spec.effects).map_err(law_error)?;
        // what has grown freely is a larger block with the energy of the smaller one (thesis Eqs. 3 to 5)
        let grown = 1.0 + specimen.thermal_strain;
        let scale = scale / grown.powi(3);
        let (mut height_mm, mut base, mut radius_mm) = (specimen.height_mm, specimen.base, indenter.radius_mm);
        let (mut refinement, mut coarse_alpha) = (spec.refinement, None);
        let mut interface = Interface::default();
        for effect in &spec.effects {
            match effect {
                Effect::Thickness { height_error_mm } => height_mm += height_error_mm,
                Effect::SlidingBase => base = Base::Sliding,
                Effect::Radius { indenter: name, error_mm } if *name == indenter.name => radius_mm += error_mm,
                Effect::Friction { coefficient } => interface.friction = *coefficient,
                Effect::Adhesion { work_n_per_mm, range_mm } => {
                    interface.adhesion = Some(Adhesion { work_n_per_mm: work_n_per_mm / scale, range_mm: *range_mm });
                }
                Effect::Numerics { mesh, alpha_step } => {
                    refinement = mesh.unwrap_or(refinement);
                    coarse_alpha = alpha_step.map(|step| between(specimen.alpha, step));
                }
                _ => {}
            }
        }
        height_mm *= grown;
        for (key, value) in [("true height_mm", height_mm), ("true radius_mm", radius_mm)] {
            if value < 0.05 {
                let expected = "a length above 0.05 mm after the effect's error".to_owned();
                return Err(SimulateError::Value { place, key, value, expected });
            }
        }
        let bottom = if base == Base::Bonded { Bottom::Bonded } else { Bottom::Sliding };
        let block = Block { height_mm, radius_mm: specimen.radius_mm * grown, base: bottom };
        let ball = Ball { radius_mm };
        Ok(Self { material, scale, block, ball, interface, refinement, coarse_alpha, rigid_mpa, place })
    }

    /// The elastic press without friction and adhesion, to a depth (mm), at another exponent or height if given.
    pub fn elastic(&self, depth_mm: f64, alpha: Option<f64>, height_mm: f64) -> Result<Simulation, SimulateError> {
        let mut material = Material { prony: Vec::new(), softening: None, ..self.material.clone() };
        if let (Some(alpha), lut_gen::solid::law::Elastic::Hyperfoam(law)) = (alpha, &material.elastic) {
            let terms = law.terms().iter().enumerate();
            let terms = terms.map(|(i, t)| if i == 0 { Term { alpha, ..*t } } else { *t }).collect();
            let law = Hyperfoam::new(terms);
            material = law.map_err(|cause| SimulateError::Law { place: self.place.clone(), cause })?.into();
        }
        Ok(Simulation {
            material,
            specimen: Block { height_mm, ..self.block },
            ball: self.ball,
            interface: Interface::default(),
            motion: Motion::ramp(depth_mm, 1.0),
            resolution: Resolution::Refined(self.refinement),
        })
    }

    /// The whole case along a motion.
    pub fn along(&self, motion: Motion) -> Simulation {
        Simulation {
            material: self.material.clone(),
            specimen: self.block,
            ball: self.ball,
            interface: self.interface,
            motion,
            resolution: Resolution::Refined(self.refinement),
        }
    }

    /// The elastic press on the mesh of the motions, in steps so small that the marks which the lines of the mesh leave in a force are followed: what
    /// history makes of the force is told from it.
    pub fn twin(&self, depth_mm: f64) -> Simulation {
        const STEPS: usize = 60;
        let place = |k: usize| depth_mm * (k as f64 / STEPS as f64).powi(2);
        let motion = (1..=STEPS).fold(Motion::from_touch(), |motion, k| motion.to_depth(place(k), 1.0));
        let material = Material { prony: Vec::new(), softening: None, ..self.material.clone() };
        Simulation { material, interface: Interface::default(), ..self.along(motion) }
    }

    /// The force of the whole case is not that of the elastic press.
    pub fn has_history(&self) -> bool {
        self.rigid_mpa.is_none() && !(self.material.is_elastic() && self.interface == Interface::default())
    }
}

/// Neighbours of `alpha` among the multiples of a step (from 1 on), with their weights of linear interpolation.
fn between(alpha: f64, step: f64) -> [(f64, f64); 2] {
    let low = ((alpha / step).floor() * step).max(1.0_f64.min(alpha));
    let high = ((alpha / step).floor() + 1.0) * step;
    let part = (alpha - low) / (high - low);
    [(low, 1.0 - part), (high, part)]
}

/// The material in units of `scale` (MPa).
pub(super) fn material(
    specimen: &TrueSpecimen,
    alpha: f64,
    scale: f64,
    effects: &[Effect],
) -> Result<Material, LawError> {
    let mut nu = specimen.nu;
    let mut terms = vec![(specimen.mu_mpa / scale, alpha)];
    if specimen.law != TrueLaw::Hyperfoam && specimen.law != TrueLaw::Ogden {
        terms = vec![(1.0, 2.0)];
    }
    terms.extend(specimen.second.map(|second| (second.mu_mpa / scale, second.alpha)));
    let mut prony = Vec::new();
    let mut softening = None;
    for effect in effects {
        match effect {
            Effect::Poisson { nu: ratio } => nu = *ratio,
            Effect::SecondTerm { mu2_ratio, alpha2 } => terms.push((*mu2_ratio, *alpha2)),
            Effect::Relaxation(terms) => prony.extend_from_slice(terms),
            Effect::Softening { r, m_mpa, beta } => softening = Some(OgdenRoxburgh::new(*r, m_mpa / scale, *beta)?),
            _ => {}
        }
    }
    let material = if specimen.law == TrueLaw::Ogden {
        // K = 2 mu (1 + nu) / (3 (1 - 2 nu)), D_1 = 2 / K
        let bulk = 2.0 * (1.0 + nu) / (3.0 * (1.0 - 2.0 * nu));
        let term = |(at, (mu_mpa, alpha)): (usize, &(f64, f64))| OgdenTerm {
            mu_mpa: *mu_mpa,
            alpha: *alpha,
            d_per_mpa: if at == 0 { 2.0 / bulk } else { 0.0 },
        };
        Material::from(Ogden::new(terms.iter().enumerate().map(term).collect())?)
    } else {
        let term = |(mu_mpa, alpha): &(f64, f64)| Term { mu_mpa: *mu_mpa, alpha: *alpha, nu };
        Material::from(Hyperfoam::new(terms.iter().map(term).collect())?)
    };
    let material = material.relaxing(prony)?;
    Ok(match softening {
        Some(softening) => material.softening(softening),
        None => material,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_warmed_specimen_is_a_larger_one_of_the_same_energy() {
        let strain = 0.04;
        let spec = Spec::new("warm", 1).foam("foam", 0.2, 8.0, 12.7).ball("r4", 4.0);
        let mut warm = spec.specimens[0].clone();
        warm.thermal_strain = strain;
        let mut larger = spec.specimens[0].clone();
        let grown: f64 = 1.0 + strain;
        (larger.height_mm, larger.radius_mm, larger.mu_mpa) = (12.7 * grown, 25.0 * grown, 0.2 / grown.powi(3));
        let body = |specimen| Body::new(&spec, specimen, &spec.indenters[0]);
        assert_eq!(body(&warm), body(&larger));
        assert_ne!(body(&warm), body(&spec.specimens[0]));
    }

    #[test]
    fn a_coarse_table_has_the_exponent_between_its_columns() {
        for (alpha, step) in [(7.3, 4.0), (8.0, 4.0), (2.5, 4.0)] {
            let [(low, a), (high, b)] = between(alpha, step);
            assert!((a * low + b * high - alpha).abs() < 1e-12 && a >= 0.0 && b >= 0.0, "{low} {a} {high} {b}");
        }
    }
}
