//! The continuous force model over the exponent, and optionally the height.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use super::chebyshev::polynomials;
use super::profile::{MAX_TERMS, assemble};
use super::{Axis, DepthProfile, Indentation, Resolution, Scale, Specimen};
use crate::contact::Ball;
use crate::law::{Hyperfoam, Term};
use crate::solve::SolveError;

/// What a force model covers.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelSpec {
    /// The block; its height is the only one unless `heights_mm` is given.
    pub specimen: Specimen,
    /// The ball.
    pub ball: Ball,
    /// Poisson's ratio of the one-term law.
    pub nu: f64,
    /// Range of the exponent, within [1, 24] tested.
    pub alpha: (f64, f64),
    /// Chebyshev nodes over the exponent.
    pub alpha_nodes: usize,
    /// Range of heights (mm) and number of nodes, for specimens of unknown height.
    pub heights_mm: Option<(f64, f64, usize)>,
    /// Largest depth (mm).
    pub depth_mm: f64,
    /// Mesh of every solve.
    pub resolution: Resolution,
}

impl ModelSpec {
    /// One known height, `nu = 0`, alpha 1 to 24, standard mesh.
    #[must_use]
    pub fn new(specimen: Specimen, ball: Ball, depth_mm: f64) -> Self {
        Self {
            specimen,
            ball,
            nu: 0.0,
            alpha: (1.0, 24.0),
            alpha_nodes: 10,
            heights_mm: None,
            depth_mm,
            resolution: Resolution::Standard,
        }
    }
}

/// Error of the forces, relative to the force at the largest depth unless said otherwise.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ErrorBound {
    /// Finite elements against a refined mesh.
    pub discretisation: f64,
    /// Interpolation between the solves, against solves left out.
    pub interpolation: f64,
}

impl ErrorBound {
    /// Sum of the parts.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.discretisation + self.interpolation
    }
}

/// Force and its derivatives.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ForceGradient {
    /// Force (N).
    pub force_n: f64,
    /// By the shear modulus (N/MPa).
    pub d_mu: f64,
    /// By the exponent (N).
    pub d_alpha: f64,
    /// By the depth (N/mm).
    pub d_depth: f64,
    /// By the height (N/mm); 0 when the model has one height.
    pub d_height: f64,
}

/// `F = mu d^(3/2) [ H + s sum_ijk c_ijk T_i(y) T_j(x) T_k(2s - 1) ]`: Chebyshev in
/// the exponent, in the reciprocal height and in `s = sqrt(d / d_max)`.
///
/// Force is exactly linear in `mu` for one frictionless term, so `mu` is no axis.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceModel {
    spec: ModelSpec,
    alpha: Axis,
    height: Axis,
    /// Hertz factor per MPa.
    hertz: f64,
    /// `[height][alpha][depth]`.
    coefficients: Vec<f64>,
    terms: usize,
    error: ErrorBound,
    solves: usize,
}

/// A solve of the plan: exponent, height, mesh.
type Job = (f64, f64, Resolution);

impl ForceModel {
    /// Builds the model; solves run in parallel, the result does not depend on their order.
    ///
    /// `progress(done, total)` is called after every solve.
    ///
    /// # Errors
    /// The first failing solve (in the order of the plan) or a parameter out of range.
    pub fn build(spec: &ModelSpec, progress: &(dyn Fn(usize, usize) + Send + Sync)) -> Result<Self, SolveError> {
        let alpha = Axis { low: spec.alpha.0, high: spec.alpha.1, nodes: spec.alpha_nodes, scale: Scale::Log };
        let height = match spec.heights_mm {
            Some((low, high, nodes)) => Axis { low, high, nodes, scale: Scale::Reciprocal },
            None => {
                Axis { low: spec.specimen.height_mm, high: spec.specimen.height_mm, nodes: 1, scale: Scale::Reciprocal }
            }
        };
        check(&alpha, &height)?;
        let mut plan: Vec<Job> = Vec::new();
        for i in 0..height.nodes {
            for j in 0..alpha.nodes {
                plan.push((alpha.node(j), height.node(i), spec.resolution));
            }
        }
        let nodes = plan.len();
        plan.extend(checks(&alpha, &height, spec.resolution));
        let profiles = solve_all(spec, &plan, progress)?;
        let mut model = Self {
            spec: spec.clone(),
            alpha,
            height,
            hertz: profiles[0].hertz,
            terms: profiles[0].coefficients.len(),
            coefficients: Vec::new(),
            error: ErrorBound::default(),
            solves: plan.len(),
        };
        model.coefficients = model.transform(&profiles[..nodes]);
        model.error = model.compare(&plan[nodes..], &profiles[nodes..]);
        Ok(model)
    }

    /// What the model covers.
    #[must_use]
    pub fn spec(&self) -> &ModelSpec {
        &self.spec
    }

    /// Its error bound.
    #[must_use]
    pub fn error(&self) -> ErrorBound {
        self.error
    }

    /// Number of finite-element solves it took, checks included.
    #[must_use]
    pub fn solves(&self) -> usize {
        self.solves
    }

    /// Force (N) at the model's own height (the specimen's).
    #[must_use]
    pub fn force_n(&self, mu_mpa: f64, alpha: f64, depth_mm: f64) -> f64 {
        self.gradient(mu_mpa, alpha, depth_mm).force_n
    }

    /// Force and derivatives at the specimen's height. 0 for `depth <= 0`; beyond
    /// the largest depth the force continues linearly, beyond the exponent's
    /// range it stays constant.
    #[must_use]
    pub fn gradient(&self, mu_mpa: f64, alpha: f64, depth_mm: f64) -> ForceGradient {
        self.gradient_at(mu_mpa, alpha, depth_mm, self.spec.specimen.height_mm)
    }

    /// As [`ForceModel::gradient`] at another height (mm) within the model's range.
    #[must_use]
    pub fn gradient_at(&self, mu_mpa: f64, alpha: f64, depth_mm: f64, height_mm: f64) -> ForceGradient {
        if depth_mm <= 0.0 {
            return ForceGradient::default();
        }
        let d = depth_mm.min(self.spec.depth_mm);
        let s = (d / self.spec.depth_mm).sqrt();
        let (mut t, mut dt) = ([0.0; MAX_TERMS], [0.0; MAX_TERMS]);
        let (mut a, mut da) = ([0.0; MAX_TERMS], [0.0; MAX_TERMS]);
        let (mut b, mut db) = ([0.0; MAX_TERMS], [0.0; MAX_TERMS]);
        let (x, dx) = self.alpha.local(alpha);
        let (y, dy) = self.height.local(height_mm);
        let (nt, na, nb) = (self.terms, self.alpha.nodes, self.height.nodes);
        polynomials(2.0 * s - 1.0, &mut t[..nt], &mut dt[..nt]);
        polynomials(x, &mut a[..na], &mut da[..na]);
        polynomials(y, &mut b[..nb], &mut db[..nb]);
        // q, its s-, alpha- and height-derivative
        let mut sum = [0.0; 4];
        let mut rows = self.coefficients.chunks_exact(nt);
        for i in 0..nb {
            for (j, row) in (0..na).zip(rows.by_ref()) {
                let (mut q, mut dq) = (0.0, 0.0);
                for k in 0..nt {
                    q += row[k] * t[k];
                    dq += row[k] * dt[k];
                }
                sum[0] += a[j] * b[i] * q;
                sum[1] += a[j] * b[i] * dq;
                sum[2] += da[j] * b[i] * q;
                sum[3] += a[j] * db[i] * q;
            }
        }
        let (f, slope) = assemble(d, s, self.hertz, sum[0], 2.0 * sum[1]);
        let (by_alpha, slope_alpha) = (d * d.sqrt() * s * sum[2] * dx, 0.0);
        let by_height = d * d.sqrt() * s * sum[3] * dy;
        let beyond = depth_mm - d;
        let per_mpa = f + slope * beyond;
        ForceGradient {
            force_n: mu_mpa * per_mpa,
            d_mu: per_mpa,
            d_alpha: mu_mpa * (by_alpha + slope_alpha * beyond),
            d_depth: mu_mpa * slope,
            d_height: mu_mpa * by_height,
        }
    }

    /// Values at the nodes to Chebyshev coefficients along alpha, then height.
    fn transform(&self, profiles: &[DepthProfile]) -> Vec<f64> {
        let (na, nb, nt) = (self.alpha.nodes, self.height.nodes, self.terms);
        let mut c: Vec<f64> = profiles.iter().flat_map(|p| p.coefficients.iter().copied()).collect();
        for k in 0..nt {
            for i in 0..nb {
                let line: Vec<f64> = (0..na).map(|j| c[(i * na + j) * nt + k]).collect();
                for (j, v) in self.alpha.coefficients(&line).into_iter().enumerate() {
                    c[(i * na + j) * nt + k] = v;
                }
            }
            for j in 0..na {
                let line: Vec<f64> = (0..nb).map(|i| c[(i * na + j) * nt + k]).collect();
                for (i, v) in self.height.coefficients(&line).into_iter().enumerate() {
                    c[(i * na + j) * nt + k] = v;
                }
            }
        }
        c
    }

    /// Interpolation from left-out solves on the same mesh; discretisation from
    /// the pairs on a refined mesh at the same parameters.
    fn compare(&self, plan: &[Job], profiles: &[DepthProfile]) -> ErrorBound {
        let mut error = ErrorBound::default();
        let depths: Vec<f64> = (1..=40).map(|i| self.spec.depth_mm * f64::from(i) / 40.0).collect();
        for ((alpha, height, resolution), profile) in plan.iter().zip(profiles) {
            let scale = profile.force_n(self.spec.depth_mm);
            let model: Vec<f64> = depths.iter().map(|&d| self.gradient_at(1.0, *alpha, d, *height).force_n).collect();
            if *resolution == self.spec.resolution {
                let worst =
                    depths.iter().zip(&model).map(|(&d, f)| (f - profile.force_n(d)).abs() / scale).fold(0.0, f64::max);
                error.interpolation = error.interpolation.max(worst);
                continue;
            }
            let twin = plan.iter().position(|j| j.0 == *alpha && j.1 == *height);
            if let Some(twin) = twin {
                let worst = depths
                    .iter()
                    .map(|&d| (profiles[twin].force_n(d) - profile.force_n(d)).abs() / scale)
                    .fold(0.0, f64::max);
                error.discretisation = error.discretisation.max(worst);
            }
        }
        error
    }
}

fn check(alpha: &Axis, height: &Axis) -> Result<(), SolveError> {
    let bad = |parameter, value, expected: &str| {
        Err(SolveError::Parameter { parameter, value, expected: expected.to_owned() })
    };
    if !(alpha.low > 0.0 && alpha.high > alpha.low) {
        return bad("alpha", alpha.low, "must be positive and below the upper end of its range");
    }
    if !(2..=MAX_TERMS).contains(&alpha.nodes) {
        return bad("alpha_nodes", alpha.nodes as f64, "must lie in 2..=24");
    }
    if !(1..=MAX_TERMS).contains(&height.nodes) {
        return bad("height nodes", height.nodes as f64, "must lie in 1..=24");
    }
    if height.nodes > 1 && !(height.low > 0.0 && height.high > height.low) {
        return bad("heights_mm", height.low, "must be positive and below the upper end of its range");
    }
    Ok(())
}

/// Solves that are not nodes: three exponents between nodes (on two heights if
/// height is an axis), each on the model's mesh and on a refined one.
fn checks(alpha: &Axis, height: &Axis, resolution: Resolution) -> Vec<Job> {
    let heights: &[f64] = if height.nodes > 1 { &[-0.6, 0.6] } else { &[0.0] };
    let mut plan = Vec::new();
    // the extrema of the first neglected polynomial, near the ends and the middle
    let n = alpha.nodes as f64;
    for k in [1.0, (n / 2.0).floor(), n - 1.0] {
        let a = alpha.value((std::f64::consts::PI * k / n).cos());
        for &y in heights {
            plan.push((a, if height.nodes > 1 { height.value(y) } else { height.low }, resolution));
        }
    }
    let refined = resolution.finer();
    let twins: Vec<Job> = plan.iter().map(|&(a, h, _)| (a, h, refined)).collect();
    plan.extend(twins);
    plan
}

fn solve_all(
    spec: &ModelSpec,
    plan: &[Job],
    progress: &(dyn Fn(usize, usize) + Send + Sync),
) -> Result<Vec<DepthProfile>, SolveError> {
    let done = AtomicUsize::new(0);
    let solved: Vec<Result<DepthProfile, SolveError>> = plan
        .par_iter()
        .map(|&(alpha, height_mm, resolution)| {
            let law = Hyperfoam::new(vec![Term { mu_mpa: 1.0, alpha, nu: spec.nu }])?;
            let specimen = Specimen { height_mm, ..spec.specimen };
            let problem = Indentation { law, specimen, ball: spec.ball, depth_mm: spec.depth_mm, resolution };
            let curve = problem.solve_at(&[])?;
            progress(done.fetch_add(1, Ordering::Relaxed) + 1, plan.len());
            Ok(curve.profile)
        })
        .collect();
    solved.into_iter().collect()
}
