//! Coupons: pieces of a true foam that are shortened as a whole, between lubricated platens or in a lubricated ring.
//!
//! Every point deforms alike, so that no finite elements are needed: the forces are those of [`Coupon::follow`] along the whole motion of all runs on the coupon, with the true
//! material. What acts between ball and specimen or depends on where a ball is pressed has no meaning here and leaves a coupon as it is: friction, adhesion, radius,
//! a base that slides, tilt, skin, the power law of an anisotropic foam under balls, the finite elements' numerics, placebos.

use lut_gen::solid::homogeneous::{Coupon, Mode, Programme};
use lut_gen::solid::solve::SolveError;

use crate::experiment::Test;

use super::SimulateError;
use super::body::material;
use super::check::DEEPEST;
use super::effect::machine::Machine;
use super::effect::{Effect, outside};
use super::session::Visit;
use super::spec::{RunTemplate, Spec, TrueSpecimen};

/// A true coupon, its material that of a first shear modulus of 1 MPa.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct TrueCoupon {
    coupon: Coupon,
    /// The true first shear modulus, MPa: factor on the force.
    scale: f64,
    height_mm: f64,
    /// Stretch of its axis before it is touched: 1 at the temperature at which it was measured.
    rest: f64,
    /// Names the case.
    place: String,
}

/// Rounds in which machine and coupon share the depth, and how well they then do (mm).
const ROUNDS: usize = 200;
const SHARED_MM: f64 = 1e-9;
/// Shortening over which the slope of a force is taken, as a share of the height.
const SLOPE: f64 = 1e-5;
/// Least time between two runs on a coupon, s: a programme's times rise.
const APART_S: f64 = 1e-3;

/// How the sides of a coupon are held in a test; none for other tests.
pub(super) fn mode(test: Test) -> Option<Mode> {
    match test {
        Test::Uniaxial => Some(Mode::Uniaxial),
        Test::Confined => Some(Mode::Confined),
        _ => None,
    }
}

impl TrueCoupon {
    /// Of a specimen that is shortened to the depth of a template.
    ///
    /// # Errors
    /// A law that the effects make impossible; a depth that leaves nothing of the true height.
    pub fn new(
        spec: &Spec,
        specimen: &TrueSpecimen,
        run: &RunTemplate,
        machine: &Machine,
    ) -> Result<Self, SimulateError> {
        let place = format!("coupon \"{}\"", specimen.name);
        let law = |cause| SimulateError::Law { place: place.clone(), cause };
        let scale = specimen.mu_mpa;
        let mut material = material(specimen, specimen.alpha, scale, &spec.effects).map_err(law)?;
        if specimen.thermal_strain != 0.0 {
            material = material.warmed(specimen.thermal_strain).map_err(law)?;
        }
        let error = |effect: &Effect| match effect {
            Effect::Thickness { height_error_mm } => *height_error_mm,
            _ => 0.0,
        };
        let height_mm = specimen.height_mm + spec.effects.iter().map(error).sum::<f64>();
        let deepest = run.depth_mm + machine.offset_mm.max(0.0) + 5.0 * spec.noise.contact_jitter_mm;
        if deepest > DEEPEST * height_mm {
            return Err(SimulateError::Value {
                place,
                key: "depth_mm with offset and jitter",
                value: deepest,
                expected: format!("at most {} mm, 90 % of the true height", DEEPEST * height_mm),
            });
        }
        let area_mm2 = std::f64::consts::PI * specimen.radius_mm * specimen.radius_mm;
        let mode = mode(run.test).unwrap_or(Mode::Uniaxial);
        let coupon = Coupon { material, mode, area_mm2 };
        let rest = coupon.rest_stretch().map_err(|cause| SimulateError::Solve { place: place.clone(), cause })?;
        Ok(Self { coupon, scale, height_mm, rest, place })
    }

    /// Forces (N) of all runs of a visit, where a machine that does not yield drives each run along the depths `driven` (mm) every `step_s`.
    ///
    /// # Errors
    /// [`SimulateError::Solve`] when no lateral stretch leaves the sides without stress, or machine and coupon do not come to share the depth.
    pub fn pressed(
        &self,
        spec: &Spec,
        visit: &Visit,
        (driven, step_s): (&[f64], f64),
        mm_per_n: f64,
    ) -> Result<Vec<Vec<f64>>, SimulateError> {
        let highest = driven.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let turn = driven.iter().rposition(|d| *d >= highest - 1e-9).unwrap_or(0);
        let unload = spec.runs[visit.template].unload;
        let runs: Vec<Vec<f64>> = (1..=visit.starts_s.len())
            .map(|cycle| {
                let (before_mm, after_mm) = outside::set_mm(&spec.effects, cycle, highest);
                let own = |(k, d): (usize, &f64)| {
                    let back = unload && k > turn;
                    let way = if back { ((highest - d) / highest.max(1e-9)).clamp(0.0, 1.0) } else { 0.0 };
                    d - before_mm - (after_mm - before_mm) * way
                };
                driven.iter().enumerate().map(own).collect()
            })
            .collect();
        let mut forces = self.shared(&runs, (visit, step_s), mm_per_n)?;
        forces.iter_mut().flatten().for_each(|f| *f *= visit.gain);
        outside::relaxed_by_power(&spec.effects, &mut forces, &visit.starts_s, step_s);
        Ok(forces)
    }

    /// The depth at every moment is shared by machine and coupon: `y + c F(y) = z`, by Newton's method with the elastic slope, each moment damped by itself where
    /// memories make its force steeper than that.
    fn shared(&self, runs: &[Vec<f64>], clock: (&Visit, f64), mm_per_n: f64) -> Result<Vec<Vec<f64>>, SimulateError> {
        let mut forces = self.along(runs, clock)?;
        if mm_per_n == 0.0 {
            return Ok(forces);
        }
        let mut depths = runs.to_vec();
        let mut steps: Vec<Vec<(f64, f64)>> = runs.iter().map(|run| vec![(1.0, 0.0); run.len()]).collect();
        for _ in 0..ROUNDS {
            let slopes = self.slopes(&depths)?;
            let mut worst = 0.0_f64;
            for (run, wanted) in runs.iter().enumerate() {
                for (k, z) in wanted.iter().enumerate().filter(|(_, z)| **z > 0.0) {
                    let y = depths[run][k];
                    let miss = y + mm_per_n * forces[run][k] - z;
                    let (damping, before) = &mut steps[run][k];
                    if miss * *before < 0.0 && miss.abs() > 0.5 * before.abs() {
                        *damping *= 0.5;
                    }
                    *before = miss;
                    worst = worst.max(miss.abs());
                    depths[run][k] = (y - *damping * miss / (1.0 + mm_per_n * slopes[run][k])).clamp(0.0, *z);
                }
            }
            if worst < SHARED_MM {
                return Ok(forces);
            }
            forces = self.along(&depths, clock)?;
        }
        Err(self.failed(SolveError::Parameter {
            parameter: "mm_per_N",
            value: mm_per_n,
            expected: "but machine and coupon do not come to share the depth".to_owned(),
        }))
    }

    /// Forces (N, not below 0: platens do not pull) along depths (mm) of all runs on the coupon, which between runs is let go.
    fn along(&self, runs: &[Vec<f64>], (visit, step_s): (&Visit, f64)) -> Result<Vec<Vec<f64>>, SimulateError> {
        let (mut time_s, mut stretch) = (Vec::new(), Vec::new());
        let first_s = visit.starts_s.first().copied().unwrap_or(0.0);
        let mut begins = Vec::new();
        for (run, start_s) in runs.iter().zip(&visit.starts_s) {
            let mut begin_s = start_s - first_s;
            if let Some(last) = time_s.last().copied() {
                begin_s = begin_s.max(last + 3.0 * APART_S);
                time_s.extend([last + APART_S, begin_s - APART_S]);
                stretch.extend([self.rest, self.rest]);
            }
            begins.push(time_s.len());
            time_s.extend((0..run.len()).map(|k| begin_s + step_s * k as f64));
            stretch.extend(run.iter().map(|d| self.stretch(*d)));
        }
        let response = self.coupon.follow(&Programme { time_s, stretch }, &[]).map_err(|cause| self.failed(cause))?;
        let force_n = |p: f64| (-self.scale * self.coupon.area_mm2 * p).max(0.0);
        let own = |(begin, run): (usize, &Vec<f64>)| {
            let read = response.stress_mpa[begin..begin + run.len()].iter().zip(run);
            read.map(|(p, d)| if *d > 0.0 { force_n(*p) } else { 0.0 }).collect()
        };
        Ok(begins.into_iter().zip(runs).map(own).collect())
    }

    /// Slope (N/mm) of the elastic force at depths (mm).
    fn slopes(&self, runs: &[Vec<f64>]) -> Result<Vec<Vec<f64>>, SimulateError> {
        let mut elastic = self.coupon.clone();
        (elastic.material.prony, elastic.material.softening) = (Vec::new(), None);
        let at = |run: &[f64], by: f64| {
            let stretch = run.iter().map(|d| self.stretch(*d) - by).collect();
            let time_s = (0..run.len()).map(|k| k as f64).collect();
            let response = elastic.follow(&Programme { time_s, stretch }, &[]).map_err(|cause| self.failed(cause))?;
            Ok::<Vec<f64>, SimulateError>(response.force_n(&elastic))
        };
        let own = |run: &Vec<f64>| {
            let (here, there) = (at(run, 0.0)?, at(run, SLOPE)?);
            let slope = |(a, b): (&f64, &f64)| self.scale * (a - b) / (SLOPE * self.height_mm);
            Ok(here.iter().zip(&there).map(slope).collect())
        };
        runs.iter().map(own).collect()
    }

    fn stretch(&self, depth_mm: f64) -> f64 {
        self.rest - depth_mm.max(0.0) / self.height_mm
    }

    fn failed(&self, cause: SolveError) -> SimulateError {
        SimulateError::Solve { place: self.place.clone(), cause }
    }
}
