//! The thesis' storage matrix: force curves over a grid of shear modulus and exponent.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use crate::effect::softening;
use crate::solid::contact::{Ball, Interface};
use crate::solid::law::{Hyperfoam, Material, PronyTerm, Term};
use crate::solid::model::{Axis, Curve, DepthProfile, ErrorBound, Resolution, Scale, Simulation, Specimen};
use crate::solid::solve::{Base, Motion, SolveError};

/// A second term of the Hyperfoam energy that all materials of a grid share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SecondTerm {
    /// Its shear modulus over that of the first term.
    pub mu_ratio: f64,
    /// Its exponent.
    pub alpha: f64,
}

/// A spot that was pressed before, at least to the depth of the table: [`softening::factor`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UsedSpot {
    /// Largest part of the force that is lost, in [0, 1).
    pub loss: f64,
    /// Share of the largest energy over which it is lost, positive.
    pub scale: f64,
}

/// What a grid covers.
#[derive(Debug, Clone, PartialEq)]
pub struct GridSpec {
    /// The block.
    pub specimen: Specimen,
    /// The ball.
    pub ball: Ball,
    /// Coefficient of Coulomb friction between them.
    pub friction: f64,
    /// Poisson's ratio of every material of the grid.
    pub nu: f64,
    /// Second term of their law, if they have one.
    pub second: Option<SecondTerm>,
    /// Softening of a spot that was pressed before; none on a fresh one.
    pub used: Option<UsedSpot>,
    /// Relaxation of every material of the grid; none for elastic foams.
    pub relaxation: Vec<PronyTerm>,
    /// Rate of the indentation (mm/s); it decides nothing without relaxation.
    pub rate_mm_s: f64,
    /// Shear moduli (MPa), rising; force is proportional to them.
    pub mu_mpa: Vec<f64>,
    /// Exponents, rising; one finite-element solve each.
    pub alpha: Vec<f64>,
    /// Depths (mm), rising.
    pub depth_mm: Vec<f64>,
    /// Mesh.
    pub resolution: Resolution,
}

impl GridSpec {
    /// The thesis' grid (section 3.2.2): mu 0.0005 to 0.3 MPa and alpha 1 to 24,
    /// both divided uniformly by 30 points, 200 depths to 4 mm at 1 mm/s; elastic, without friction.
    #[must_use]
    pub fn thesis(specimen: Specimen, ball: Ball) -> Self {
        let even = |low: f64, high: f64, n: usize| -> Vec<f64> {
            (0..n).map(|i| low + (high - low) * i as f64 / (n - 1) as f64).collect()
        };
        Self {
            specimen,
            ball,
            friction: 0.0,
            nu: 0.0,
            second: None,
            used: None,
            relaxation: Vec::new(),
            rate_mm_s: 1.0,
            mu_mpa: even(0.0005, 0.3, 30),
            alpha: even(1.0, 24.0, 30),
            depth_mm: even(0.02, 4.0, 200),
            resolution: Resolution::Standard,
        }
    }
}

/// Force curves of a grid.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceGrid {
    /// What it covers.
    pub spec: GridSpec,
    /// Force per MPa of shear modulus (N/MPa): `[alpha][depth]`.
    pub force_per_mpa: Vec<Vec<f64>>,
    /// Error of the forces relative to a curve's peak: of the mesh, and of interpolation between depths
    /// and, in a grid of many exponents, between the solves.
    pub error: ErrorBound,
    /// Model, mesh and engine version, one line.
    pub provenance: String,
    /// Finite-element solves, checks included.
    pub solves: usize,
}

impl ForceGrid {
    /// Solves the grid in parallel; `progress(done, total)` is called after every solve.
    ///
    /// A grid of few exponents is solved at each. One of many is solved at Chebyshev nodes in
    /// `ln alpha` and interpolated; solves left out in between state the error of that.
    ///
    /// # Errors
    /// The first failing solve, or an empty or falling axis.
    pub fn build(spec: &GridSpec, progress: &(dyn Fn(usize, usize) + Send + Sync)) -> Result<Self, SolveError> {
        rising("mu_mpa", &spec.mu_mpa)?;
        rising("alpha", &spec.alpha)?;
        rising("depth_mm", &spec.depth_mm)?;
        let plan = Plan::of(spec);
        let done = AtomicUsize::new(0);
        let total = plan.jobs.len();
        let curves: Result<Vec<Curve>, SolveError> = plan
            .jobs
            .par_iter()
            .map(|&(alpha, resolution)| {
                let curve = problem(spec, 1.0, alpha, resolution)?.curve(&spec.depth_mm)?;
                progress(done.fetch_add(1, Ordering::Relaxed) + 1, total);
                Ok(curve)
            })
            .collect::<Vec<_>>()
            .into_iter()
            .collect();
        let curves = curves?;
        let (own, checks) = curves.split_at(plan.own);
        let profiles = plan.profiles(spec, own);
        Ok(Self {
            provenance: provenance(spec, own[0].stats.unknowns),
            force_per_mpa: profiles.iter().map(|p| forces_n(spec, p)).collect(),
            error: plan.error(spec, own, &profiles, checks),
            spec: spec.clone(),
            solves: total,
        })
    }
}

/// Most exponents of a grid that are each solved for themselves.
const SOLVED: usize = 12;

/// Chebyshev nodes over the exponents of a larger grid: they reach 0.02 % over 1 to 24.
const NODES: usize = 10;

/// The solves of a grid: its own first, then those that state its error.
struct Plan {
    jobs: Vec<(f64, Resolution)>,
    own: usize,
    /// The axis of the nodes, when exponents are interpolated.
    axis: Option<Axis>,
    /// Own solves that are repeated on a finer mesh.
    refined: Vec<usize>,
}

impl Plan {
    fn of(spec: &GridSpec) -> Self {
        let n = spec.alpha.len();
        let (low, high) = (spec.alpha[0], spec.alpha[n - 1]);
        let axis = (n > SOLVED).then_some(Axis { low, high, nodes: NODES, scale: Scale::Log });
        let own: Vec<f64> = match &axis {
            Some(axis) => (0..NODES).map(|k| axis.node(k)).collect(),
            None => spec.alpha.clone(),
        };
        let mut refined = vec![0, own.len() / 2, own.len() - 1];
        refined.dedup();
        let mut jobs: Vec<(f64, Resolution)> = own.iter().map(|&a| (a, spec.resolution)).collect();
        jobs.extend(refined.iter().map(|&i| (own[i], spec.resolution.finer())));
        if axis.is_some() {
            // exponents of the grid, near both ends and in the middle
            jobs.extend([1, n / 2, n - 2].map(|i| (spec.alpha[i], spec.resolution)));
        }
        Self { own: own.len(), jobs, axis, refined }
    }

    /// The profile of every exponent of the grid.
    fn profiles(&self, spec: &GridSpec, own: &[Curve]) -> Vec<DepthProfile> {
        let Some(axis) = &self.axis else {
            return own.iter().map(|c| c.profile.clone()).collect();
        };
        let lines: Vec<Vec<f64>> = (0..own[0].profile.coefficients.len())
            .map(|k| axis.coefficients(&own.iter().map(|c| c.profile.coefficients[k]).collect::<Vec<_>>()))
            .collect();
        let at = |alpha: f64| DepthProfile {
            coefficients: lines.iter().map(|line| axis.evaluate(line, alpha)).collect(),
            ..own[0].profile.clone()
        };
        spec.alpha.iter().map(|&a| at(a)).collect()
    }

    /// Discretisation: the largest difference to solves on a mesh refined by 1.5. Interpolation:
    /// that of straight lines between depths and, where exponents are interpolated, to the solves
    /// left out. All relative to a curve's peak.
    fn error(&self, spec: &GridSpec, own: &[Curve], profiles: &[DepthProfile], checks: &[Curve]) -> ErrorBound {
        let (fine, left_out) = checks.split_at(self.refined.len());
        let worst = |list: &mut dyn Iterator<Item = f64>| list.fold(0.0, f64::max);
        let discretisation =
            worst(&mut self.refined.iter().zip(fine).map(|(&i, f)| difference(&own[i].force_n, &f.force_n)));
        let chords = worst(&mut profiles.iter().map(|p| chord_error(&spec.depth_mm, p)));
        let between = worst(&mut self.jobs[self.own + fine.len()..].iter().zip(left_out).map(|((alpha, _), curve)| {
            let at = spec.alpha.iter().position(|a| a == alpha).unwrap_or(0);
            let forces: Vec<f64> = spec.depth_mm.iter().map(|&d| profiles[at].force_n(d)).collect();
            difference(&forces, &curve.force_n)
        }));
        // three exponents do not find the worst one: twice what they show is stated
        ErrorBound { discretisation, interpolation: chords + 2.0 * between }
    }
}

/// Forces (N) of a profile at the depths of a grid, softened where the spot was pressed before.
pub(super) fn forces_n(spec: &GridSpec, profile: &DepthProfile) -> Vec<f64> {
    let mut forces: Vec<f64> = spec.depth_mm.iter().map(|&d| profile.force_n(d)).collect();
    if let Some(used) = spec.used {
        let energy = energies(spec, profile);
        let whole = energy.last().copied().unwrap_or(0.0).max(f64::MIN_POSITIVE);
        for (force, stored) in forces.iter_mut().zip(&energy) {
            *force *= softening::factor(used.loss, used.scale, stored / whole);
        }
    }
    forces
}

/// Energy (N mm) stored at every depth of a grid, by Simpson's rule from depth to depth.
fn energies(spec: &GridSpec, profile: &DepthProfile) -> Vec<f64> {
    let (mut sum, mut before) = (0.0, 0.0);
    let each = spec.depth_mm.iter().map(|&d| {
        let middle = 0.5 * (before + d);
        sum += (d - before) / 6.0 * (profile.force_n(before) + 4.0 * profile.force_n(middle) + profile.force_n(d));
        before = d;
        sum
    });
    each.collect()
}

/// One column of a grid. The force stays proportional to the modulus with friction and relaxation, so
/// that the grid itself is solved with 1 MPa.
pub(super) fn problem(
    spec: &GridSpec,
    mu_mpa: f64,
    alpha: f64,
    resolution: Resolution,
) -> Result<Simulation, SolveError> {
    let first = Term { mu_mpa, alpha, nu: spec.nu };
    let second = spec.second.map(|s| Term { mu_mpa: s.mu_ratio * mu_mpa, alpha: s.alpha, nu: spec.nu });
    let law = Hyperfoam::new(std::iter::once(first).chain(second).collect())?;
    Ok(Simulation {
        material: Material::from(law).relaxing(spec.relaxation.clone())?,
        specimen: spec.specimen,
        ball: spec.ball,
        interface: Interface { friction: spec.friction, adhesion: None },
        motion: Motion::ramp(spec.depth_mm[spec.depth_mm.len() - 1], spec.rate_mm_s),
        resolution,
    })
}

fn rising(parameter: &'static str, axis: &[f64]) -> Result<(), SolveError> {
    let falls = axis.windows(2).find(|w| w[1].is_nan() || w[1] <= w[0]).map(|w| w[1]);
    let bad = axis.iter().copied().find(|v| !(*v > 0.0 && v.is_finite())).or(falls);
    let expected = "must be a rising list of positive values".to_owned();
    match (bad, axis.is_empty()) {
        (Some(value), _) => Err(SolveError::Parameter { parameter, value, expected }),
        (None, true) => Err(SolveError::Parameter { parameter, value: f64::NAN, expected }),
        (None, false) => Ok(()),
    }
}

/// Largest difference of two curves at the same depths, relative to the peak of the second.
fn difference(a: &[f64], b: &[f64]) -> f64 {
    let peak = b.iter().copied().fold(0.0, f64::max);
    a.iter().zip(b).map(|(x, y)| (x - y).abs() / peak).fold(0.0, f64::max)
}

/// Largest error of straight lines between the depths, from depth 0 on, relative to the peak.
fn chord_error(depths: &[f64], profile: &DepthProfile) -> f64 {
    let (mut d0, mut f0, mut worst) = (0.0, 0.0, 0.0_f64);
    for &d in depths {
        let f = profile.force_n(d);
        worst = worst.max((0.5 * (f0 + f) - profile.force_n(0.5 * (d0 + d))).abs());
        (d0, f0) = (d, f);
    }
    worst / depths.iter().map(|&d| profile.force_n(d)).fold(0.0, f64::max)
}

fn provenance(spec: &GridSpec, unknowns: usize) -> String {
    let base = match spec.specimen.base {
        Base::Bonded => "bonded",
        Base::Sliding => "sliding",
    };
    let relaxation: Vec<String> =
        spec.relaxation.iter().map(|t| format!(", g {} k {} tau {} s", t.g, t.k, t.tau_s)).collect();
    let rate = if relaxation.is_empty() { String::new() } else { format!(" at {} mm/s", spec.rate_mm_s) };
    let second = spec.second.map_or(String::new(), |s| format!(" mu2/mu {} alpha2 {}", s.mu_ratio, s.alpha));
    let used = spec.used.map_or(String::new(), |u| format!(", used spot: loss {} scale {}", u.loss, u.scale));
    let friction = if spec.friction == 0.0 { "frictionless".to_owned() } else { format!("friction {}", spec.friction) };
    format!(
        "lut-gen {}; hyperfoam N={} nu={}{second}{}{rate}{used}; ball R {} mm, block W {} h {} mm, base {base}, {friction}; axisymmetric Q8R, {unknowns} unknowns",
        env!("CARGO_PKG_VERSION"),
        1 + usize::from(spec.second.is_some()),
        spec.nu,
        relaxation.concat(),
        spec.ball.radius_mm,
        spec.specimen.radius_mm,
        spec.specimen.height_mm,
    )
}
