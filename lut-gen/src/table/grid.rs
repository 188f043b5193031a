//! The thesis' storage matrix: force curves over a grid of shear modulus and exponent.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use crate::contact::Ball;
use crate::law::Hyperfoam;
use crate::model::{Curve, ErrorBound, Indentation, Resolution, Specimen};
use crate::solve::{Base, SolveError};

/// What a grid covers.
#[derive(Debug, Clone, PartialEq)]
pub struct GridSpec {
    /// The block.
    pub specimen: Specimen,
    /// The ball.
    pub ball: Ball,
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
    /// both divided uniformly by 30 points, 200 depths to 4 mm.
    #[must_use]
    pub fn thesis(specimen: Specimen, ball: Ball) -> Self {
        let even = |low: f64, high: f64, n: usize| -> Vec<f64> {
            (0..n).map(|i| low + (high - low) * i as f64 / (n - 1) as f64).collect()
        };
        Self {
            specimen,
            ball,
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
    /// Discretisation: the largest difference to solves on a mesh refined by 1.5,
    /// at the ends and the middle of the exponents. Interpolation: the largest
    /// error of straight lines between depths. Both relative to a curve's peak.
    pub error: ErrorBound,
    /// Model, mesh and engine version, one line.
    pub provenance: String,
    /// Finite-element solves, checks included.
    pub solves: usize,
}

impl ForceGrid {
    /// Solves the grid in parallel; `progress(done, total)` is called after every solve.
    ///
    /// # Errors
    /// The first failing solve, or an empty or falling axis.
    pub fn build(spec: &GridSpec, progress: &(dyn Fn(usize, usize) + Send + Sync)) -> Result<Self, SolveError> {
        rising("mu_mpa", &spec.mu_mpa)?;
        rising("alpha", &spec.alpha)?;
        rising("depth_mm", &spec.depth_mm)?;
        let n = spec.alpha.len();
        let mut plan: Vec<(usize, Resolution)> = (0..n).map(|i| (i, spec.resolution)).collect();
        let mut checked = vec![0, n / 2, n - 1];
        checked.dedup();
        plan.extend(checked.iter().map(|&i| (i, spec.resolution.finer())));
        let done = AtomicUsize::new(0);
        let curves: Result<Vec<Curve>, SolveError> = plan
            .par_iter()
            .map(|&(i, resolution)| {
                let curve = problem(spec, spec.alpha[i], resolution)?.solve_at(&spec.depth_mm)?;
                progress(done.fetch_add(1, Ordering::Relaxed) + 1, plan.len());
                Ok(curve)
            })
            .collect::<Vec<_>>()
            .into_iter()
            .collect();
        let curves = curves?;
        let mut error = ErrorBound::default();
        for (&i, fine) in checked.iter().zip(&curves[n..]) {
            error.discretisation = error.discretisation.max(difference(&curves[i], fine));
        }
        for curve in &curves[..n] {
            error.interpolation = error.interpolation.max(chord_error(curve));
        }
        Ok(Self {
            provenance: provenance(spec, curves[0].stats.unknowns),
            spec: spec.clone(),
            force_per_mpa: curves.into_iter().take(n).map(|c| c.force_n).collect(),
            error,
            solves: plan.len(),
        })
    }
}

fn problem(spec: &GridSpec, alpha: f64, resolution: Resolution) -> Result<Indentation, SolveError> {
    Ok(Indentation {
        law: Hyperfoam::one_term(1.0, alpha)?,
        specimen: spec.specimen,
        ball: spec.ball,
        depth_mm: spec.depth_mm[spec.depth_mm.len() - 1],
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

/// Largest difference of two curves at the same depths, relative to the peak.
fn difference(a: &Curve, b: &Curve) -> f64 {
    let peak = b.force_n.iter().copied().fold(0.0, f64::max);
    let pairs = a.force_n.iter().zip(&b.force_n);
    pairs.map(|(x, y)| (x - y).abs() / peak).fold(0.0, f64::max)
}

/// Largest error of straight lines between the depths, from depth 0 on, relative to the peak.
fn chord_error(curve: &Curve) -> f64 {
    let peak = curve.force_n.iter().copied().fold(0.0, f64::max);
    let (mut d0, mut f0, mut worst) = (0.0, 0.0, 0.0_f64);
    for (&d, &f) in curve.depth_mm.iter().zip(&curve.force_n) {
        let middle = curve.profile.force_n(0.5 * (d0 + d));
        worst = worst.max((0.5 * (f0 + f) - middle).abs() / peak);
        (d0, f0) = (d, f);
    }
    worst
}

fn provenance(spec: &GridSpec, unknowns: usize) -> String {
    let base = match spec.specimen.base {
        Base::Bonded => "bonded",
        Base::Sliding => "sliding",
    };
    format!(
        "lut-gen {}; hyperfoam N=1 nu=0; ball R {} mm, block W {} h {} mm, base {base}, frictionless; axisymmetric Q8R, {unknowns} unknowns",
        env!("CARGO_PKG_VERSION"),
        spec.ball.radius_mm,
        spec.specimen.radius_mm,
        spec.specimen.height_mm,
    )
}
