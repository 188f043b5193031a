//! The continuous force model over the exponent, and optionally height and Poisson's ratio.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::expansion::Expansion;
use super::nodes::{Nodes, twice};
use super::plan::{Job, ModelSpec, check, checks};
use super::potential::{Potential, Ramp};
use super::slice::ForceSlice;
use super::{Axis, Indentation, Scale, Specimen};
use crate::solid::law::{Hyperfoam, Parameter, Term};
use crate::solid::solve::SolveError;
use crate::solid::verify::hertz_force_n;

/// Error of the forces, relative to the force at the largest depth unless said otherwise.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
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
    /// By Poisson's ratio (N); 0 when the model has one.
    pub d_nu: f64,
    /// By the ball's radius (N/mm) at fixed depth and height, the block's radius in proportion: from
    /// `F = mu R^2 phi(d/R, h/R, W/R)`, `R dF/dR = 2 F - d dF/dd - h dF/dh`. 0 when the model has one height.
    pub d_radius: f64,
}

/// `F = mu H(nu) d^(3/2) exp(s q)`, `q` a Chebyshev expansion in Poisson's ratio, the reciprocal
/// height, the logarithm of the exponent and `s = sqrt(d / d_max)`; `H` is Hertz's factor.
///
/// The logarithm, since forces of confined foams span decades: for Poisson's ratio it was measured
/// to need two nodes less than the force, for the other parameters as many.
/// Force is exactly linear in `mu` for one frictionless term, so `mu` is no axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ForceModel {
    spec: ModelSpec,
    expansion: Expansion,
    error: ErrorBound,
    solves: usize,
}

/// Terms in depth.
pub(super) const TERMS: usize = 12;
/// `s = sqrt(d / d_max)`.
pub(super) const DEPTH: Axis = Axis { low: 0.0, high: 1.0, nodes: TERMS, scale: Scale::Linear };

impl ForceModel {
    /// Builds the model; solves run in parallel, the result does not depend on their order.
    ///
    /// `progress(done, total)` is called after every solve.
    ///
    /// # Errors
    /// The first failing solve (in the order of the plan) or a parameter out of range.
    pub fn build(spec: &ModelSpec, progress: &(dyn Fn(usize, usize) + Send + Sync)) -> Result<Self, SolveError> {
        let axes = spec.axes();
        check(spec, &axes)?;
        let [nu, height, alpha] = &axes;
        let mut plan: Vec<Job> = Vec::new();
        for i in 0..nu.nodes {
            for j in 0..height.nodes {
                plan.extend((0..alpha.nodes).map(|k| ([nu.node(i), height.node(j), alpha.node(k)], spec.resolution)));
            }
        }
        let solved = plan.len();
        if spec.checked {
            plan.extend(checks(&axes, spec.resolution));
        }
        let ramps = solve_all(spec, &plan, progress)?;
        let (nodes, axes) = at_nodes(spec, &ramps[..solved], axes);
        let mut model = Self {
            spec: spec.clone(),
            expansion: Expansion::through(axes, TERMS, nodes.coefficients()),
            error: ErrorBound::default(),
            solves: plan.len(),
        };
        model.error = model.compare(&plan[solved..], &ramps[solved..]);
        Ok(model)
    }

    /// The same model for a ball of another radius (mm): depths, heights and the block's radius scale
    /// with it, exactly, and so do the forces.
    ///
    /// # Errors
    /// [`SolveError::Parameter`] when the radius is not positive.
    pub fn rescaled(&self, radius_mm: f64) -> Result<Self, SolveError> {
        if !(radius_mm.is_finite() && radius_mm > 0.0) {
            return Err(SolveError::parameter("radius_mm of the ball", radius_mm, "must be positive"));
        }
        let by = radius_mm / self.spec.ball.radius_mm;
        let mut out = self.clone();
        out.spec.ball.radius_mm = radius_mm;
        out.spec.specimen.height_mm *= by;
        out.spec.specimen.radius_mm *= by;
        out.spec.depth_mm *= by;
        out.spec.heights_mm = self.spec.heights_mm.map(|(low, high, n)| (by * low, by * high, n));
        let height = &mut out.expansion.axes[1];
        (height.low, height.high) = (by * height.low, by * height.high);
        Ok(out)
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
        self.gradient_of(mu_mpa, alpha, self.spec.nu, depth_mm, height_mm)
    }

    /// As [`ForceModel::gradient_at`] at another Poisson's ratio within the model's range.
    #[must_use]
    pub fn gradient_of(&self, mu_mpa: f64, alpha: f64, nu: f64, depth_mm: f64, height_mm: f64) -> ForceGradient {
        if depth_mm <= 0.0 {
            return ForceGradient::default();
        }
        let [range, ..] = &self.expansion.axes;
        let nu = nu.clamp(range.low, range.high);
        let d = depth_mm.min(self.spec.depth_mm);
        let s = (d / self.spec.depth_mm).sqrt();
        let q = self.expansion.at(s, [nu, height_mm, alpha]);
        let force = hertz_force_n(mu_mpa, nu, self.spec.ball.radius_mm, d) * (s * q.value).exp();
        // of ln F: by the depth, by each parameter, and both; ds/dd = s / (2 d)
        let by_depth = (1.5 + 0.5 * s * (q.value + s * q.by_s)) / d;
        let mut by = q.by.map(|x| s * x);
        if range.nodes > 1 {
            by[0] += 1.0 / (1.0 - nu);
        }
        let beyond = depth_mm - d;
        let each: [f64; 3] = std::array::from_fn(|i| {
            let mixed = 0.5 * s * (q.by[i] + s * q.by_s_and[i]) / d;
            force * (by[i] + beyond * (by[i] * by_depth + mixed))
        });
        let (slope, force_n) = (force * by_depth, force * (1.0 + beyond * by_depth));
        let scaled = 2.0 * force_n - depth_mm * slope - height_mm * each[1];
        let one_height = self.expansion.axes[1].nodes == 1;
        ForceGradient {
            force_n,
            d_mu: force_n / mu_mpa,
            d_alpha: each[2],
            d_depth: slope,
            d_height: each[1],
            d_nu: each[0],
            d_radius: if one_height { 0.0 } else { scaled / self.spec.ball.radius_mm },
        }
    }

    /// The model's force over depth at one exponent, Poisson's ratio and height (mm), each moved into its range.
    #[must_use]
    pub fn slice(&self, alpha: f64, nu: f64, height_mm: f64) -> ForceSlice {
        let [nus, heights, alphas] = &self.expansion.axes;
        let within = |axis: &Axis, x: f64| if axis.nodes == 1 { x } else { x.clamp(axis.low, axis.high) };
        let nu = if nus.nodes == 1 { self.spec.nu } else { nu.clamp(nus.low, nus.high) };
        let at = [nu, within(heights, height_mm), within(alphas, alpha)];
        ForceSlice {
            depth_max_mm: self.spec.depth_mm,
            hertz: hertz_force_n(1.0, nu, self.spec.ball.radius_mm, 1.0),
            coefficients: self.expansion.slice(at),
        }
    }

    /// Interpolation from left-out solves on the same mesh; discretisation from
    /// the pairs on a refined mesh at the same parameters.
    fn compare(&self, plan: &[Job], ramps: &[Ramp]) -> ErrorBound {
        if !self.spec.checked {
            return ErrorBound { discretisation: f64::NAN, interpolation: f64::NAN };
        }
        let mut error = ErrorBound::default();
        let depths: Vec<f64> = (1..=40).map(|i| self.spec.depth_mm * f64::from(i) / 40.0).collect();
        for ((at, resolution), Ramp { profile, .. }) in plan.iter().zip(ramps) {
            let scale = profile.force_n(self.spec.depth_mm);
            let [nu, height, alpha] = *at;
            let model: Vec<f64> = depths.iter().map(|&d| self.gradient_of(1.0, alpha, nu, d, height).force_n).collect();
            if *resolution == self.spec.resolution {
                let worst =
                    depths.iter().zip(&model).map(|(&d, f)| (f - profile.force_n(d)).abs() / scale).fold(0.0, f64::max);
                error.interpolation = error.interpolation.max(worst);
                continue;
            }
            let twin = plan.iter().position(|j| j.0 == *at);
            if let Some(twin) = twin {
                let worst = depths
                    .iter()
                    .map(|&d| (ramps[twin].profile.force_n(d) - profile.force_n(d)).abs() / scale)
                    .fold(0.0, f64::max);
                error.discretisation = error.discretisation.max(worst);
            }
        }
        error
    }
}

/// What is expanded, at the nodes of axes: those of the solves, with twice as many where slopes are told.
fn at_nodes(spec: &ModelSpec, ramps: &[Ramp], mut axes: [Axis; 3]) -> (Nodes, [Axis; 3]) {
    let mut nodes = Nodes::of(ramps, axes.map(|axis| axis.nodes));
    // of Hertz's factor, which is in proportion to 1 / (1 - nu)
    let hertz = |at: usize, value: f64| if at == 0 { 1.0 / (1.0 - value) } else { 0.0 };
    let each = spec.sloped().into_iter().enumerate();
    let mut left: Vec<(usize, Nodes)> = each
        .map(|(parameter, (at, _))| (at, nodes.slopes(ramps, (at, &axes[at]), parameter, |value| hertz(at, value))))
        .collect();
    // the exponent first: the slopes by another parameter follow it
    while let Some((at, slopes)) = left.pop() {
        nodes = nodes.osculated(&slopes, (at, &axes[at]));
        left.iter_mut().for_each(|(_, other)| *other = other.interpolated((at, &axes[at])));
        axes[at] = twice(&axes[at]);
    }
    (nodes, axes)
}

fn solve_all(
    spec: &ModelSpec,
    plan: &[Job],
    progress: &(dyn Fn(usize, usize) + Send + Sync),
) -> Result<Vec<Ramp>, SolveError> {
    let done = AtomicUsize::new(0);
    let solved: Vec<Result<Ramp, SolveError>> = plan
        .par_iter()
        .map(|&([nu, height_mm, alpha], resolution)| {
            let law = Hyperfoam::new(vec![Term { mu_mpa: 1.0, alpha, nu }])?;
            let specimen = Specimen { height_mm, ..spec.specimen };
            let problem = Indentation { law, specimen, ball: spec.ball, depth_mm: spec.depth_mm, resolution };
            let followed: Vec<Parameter> = spec.sloped().into_iter().map(|(_, parameter)| parameter).collect();
            let ramp = if followed.is_empty() {
                Ramp::alone(problem.solve_at(&[])?.profile)
            } else {
                let mut energy = Potential::of(followed);
                let curve = problem.simulation().curve_watched(&[], &mut energy)?;
                energy.ramp(curve.profile)
            };
            progress(done.fetch_add(1, Ordering::Relaxed) + 1, plan.len());
            Ok(ramp)
        })
        .collect();
    solved.into_iter().collect()
}
