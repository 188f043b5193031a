//! The foams under the probe.

use lut_gen::solid::contact::{Ball, Interface};
use lut_gen::solid::law::{Hyperfoam, Material, PronyTerm};
use lut_gen::solid::model::{Curve as Solved, Resolution, Simulation, Specimen};
use lut_gen::solid::solve::{Motion, SolveError};
use lut_gen::table::{Foam, foams};
use palpate::plant::Curve;

use super::{DEPTH_MM, RATES_MM_S, Softening};

/// The palpation ball (thesis chapter 3 as DESIGN reads it).
pub const BALL: Ball = Ball { radius_mm: 4.0 };

/// Relaxation of B1, a closed-cell neoprene sponge: one Maxwell element that takes 15 % of all moduli in 2 s.
///
/// The thesis prints no figure but that the curves show "a slight deformation rate dependency", and that 2 and 4 mm/s
/// differ less than 1 and 2 mm/s; a ramp to 4 mm takes 4, 2 and 1 s. A term of 2 s gives 3.0 and 2.3 % between these
/// (0.7 s or less would turn the order round). Silicone under a ball loses 12 to 16 % in 10 s (recordings
/// `silicone_ball`), so 15 % is an elastomer's share.
pub const B1_RELAXATION: PronyTerm = PronyTerm { g: 0.15, k: 0.15, tau_s: 2.0 };

/// Step of the curves, mm.
const STEP_MM: f64 = 0.02;

/// How far beyond the palpation's depth the curves go, mm: contact is believed up to some tenths too low.
const BEYOND_MM: f64 = 0.8;

/// A foam with the force of the ball on it at every rate.
#[derive(Debug, Clone, PartialEq)]
pub struct PressedFoam {
    /// Name, as in the library of the table.
    pub name: &'static str,
    /// Its place in the library.
    pub index: usize,
    /// Shear modulus that the thesis identified at 1 mm/s (MPa).
    pub mu_mpa: f64,
    /// Exponent.
    pub alpha: f64,
    /// Height (mm).
    pub height_mm: f64,
    /// Force over depth at each of [`RATES_MM_S`], as the average of a session finds it.
    pub curves: Vec<Curve>,
    /// True for the foam that relaxes and softens.
    pub softens: bool,
}

/// The four foams of the thesis, on a mesh that should be finer than the tables'.
///
/// # Errors
/// The first solve that fails.
pub fn pressed_foams(resolution: Resolution) -> Result<Vec<PressedFoam>, SolveError> {
    let steps = ((DEPTH_MM + BEYOND_MM) / STEP_MM).round() as usize;
    let depths: Vec<f64> = (1..=steps).map(|i| STEP_MM * i as f64).collect();
    let real = foams().into_iter().enumerate().filter(|(_, foam)| !foam.dummy);
    real.map(|(index, foam)| {
        let softens = relaxes(&foam);
        let forces = if softens {
            relaxing_n(&foam, &depths, resolution)?
        } else {
            vec![simulation(&foam, Vec::new(), 1.0, &depths, resolution)?.curve(&depths)?.force_n; RATES_MM_S.len()]
        };
        let expected = || "must be finite and not negative".to_owned();
        let refused = || SolveError::Parameter { parameter: "force of a foam", value: f64::NAN, expected: expected() };
        let curves = forces.iter().map(|f| Curve::new(STEP_MM, f).ok_or_else(refused));
        Ok(PressedFoam {
            name: foam.name,
            index,
            mu_mpa: foam.mu_mpa,
            alpha: foam.alpha,
            height_mm: foam.height_mm,
            curves: curves.collect::<Result<_, _>>()?,
            softens,
        })
    })
    .collect()
}

/// True for the one foam that is simulated with relaxation and softening.
pub(super) fn relaxes(foam: &Foam) -> bool {
    foam.name == "B1"
}

/// Force of the relaxing foam at each of [`RATES_MM_S`], N. Its instantaneous modulus is such that at 1 mm/s, the rate of
/// the thesis' identification, 4 mm take the force of the elastic foam with the modulus that was identified.
pub(super) fn relaxing_n(foam: &Foam, depths: &[f64], resolution: Resolution) -> Result<Vec<Vec<f64>>, SolveError> {
    let deepest_n = |curve: Solved| curve.profile.force_n(DEPTH_MM);
    let relaxing = |rate| simulation(foam, vec![B1_RELAXATION], rate, depths, resolution)?.curve(depths);
    let elastic_n = deepest_n(simulation(foam, Vec::new(), 1.0, depths, resolution)?.curve(depths)?);
    let curves = RATES_MM_S.iter().map(|rate| relaxing(*rate)).collect::<Result<Vec<_>, _>>()?;
    let stiffer = elastic_n / deepest_n(curves[0].clone());
    Ok(curves.into_iter().map(|c| c.force_n.into_iter().map(|f| stiffer * f).collect()).collect())
}

fn simulation(
    foam: &Foam,
    relaxation: Vec<PronyTerm>,
    rate_mm_s: f64,
    depths: &[f64],
    resolution: Resolution,
) -> Result<Simulation, SolveError> {
    let deepest_mm = depths.iter().copied().fold(DEPTH_MM, f64::max);
    Ok(Simulation {
        material: Material::from(Hyperfoam::one_term(foam.mu_mpa, foam.alpha)?).relaxing(relaxation)?,
        specimen: Specimen::of_height(foam.height_mm),
        ball: BALL,
        interface: Interface::default(),
        motion: Motion::ramp(deepest_mm, rate_mm_s),
        resolution,
    })
}

impl PressedFoam {
    /// Force at a depth, N, in the `number`-th press of a session (from 1), at rate number `rate`.
    pub fn force_n(&self, rate: usize, depth_mm: f64, number: usize, softening: Softening) -> f64 {
        let factor = if self.softens { softening.factor(number) } else { 1.0 };
        factor * self.curves.get(rate).map_or(0.0, |curve| curve.force_n(depth_mm))
    }

    /// Force at the full depth in the middle of a session, N.
    pub fn peak_n(&self, rate: usize) -> f64 {
        self.curves.get(rate).map_or(0.0, |curve| curve.force_n(DEPTH_MM))
    }
}
