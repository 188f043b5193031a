//! One indentation: a specimen, a law, a ball, a depth.

use std::time::Instant;

use super::profile::DepthProfile;
use super::{Curve, Sample, Stats};
use crate::contact::{Ball, Surface};
use crate::element::Quadrature;
use crate::law::{Hyperfoam, Law};
use crate::mesh::{BlockMesh, Sizes};
use crate::solve::{Base, Newton, Path, SolveError, Stepping, System};

/// A cylindrical block with free sides.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Specimen {
    /// Height `h` [mm].
    pub height_mm: f64,
    /// Radius `W` [mm].
    pub radius_mm: f64,
    /// How its bottom is held.
    pub base: Base,
}

impl Specimen {
    /// A bonded block of the default radius, 25 mm.
    #[must_use]
    pub fn of_height(height_mm: f64) -> Self {
        Self {
            height_mm,
            radius_mm: 25.0,
            base: Base::Bonded,
        }
    }
}

/// How finely an indentation is resolved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Resolution {
    /// One mesh: 0.2 % typical from an eighth of the depth on.
    Standard,
    /// Two meshes and Richardson extrapolation, with a stated error.
    Fine,
    /// One mesh with all element sizes divided by the given factor.
    Refined(f64),
}

impl Resolution {
    fn refinements(self) -> Vec<f64> {
        match self {
            Self::Standard => vec![1.0],
            Self::Fine => vec![1.0, 1.5],
            Self::Refined(factor) => vec![factor],
        }
    }
}

/// A ball pressed into a block.
#[derive(Debug, Clone, PartialEq)]
pub struct Indentation {
    /// Material of the block.
    pub law: Hyperfoam,
    /// The block.
    pub specimen: Specimen,
    /// The ball.
    pub ball: Ball,
    /// Largest depth [mm].
    pub depth_mm: f64,
    /// Mesh.
    pub resolution: Resolution,
}

/// Depths of [`Indentation::solve`], as in the thesis' storage matrices.
pub const DEPTHS: usize = 200;

/// Penalty in units of `mu / R`: mean penetration under one percent of the
/// depth, whose effect on the force is then removed to first order.
const PENALTY: f64 = 400.0;

/// Contact quadrature points per element edge.
const POINTS_PER_EDGE: usize = 8;

/// Terms of the depth profile.
pub(super) const TERMS: usize = 10;

/// Element sizes in ball radii.
const SIZES: Sizes = Sizes {
    axis: 0.05,
    growth_under: 0.06,
    near: 1.1,
    growth_far: 0.4,
    surface: 0.05,
    growth_down: 0.25,
    refinement: 1.0,
};

impl Indentation {
    /// The curve at 200 equal steps up to the largest depth.
    ///
    /// # Errors
    /// See [`SolveError`].
    pub fn solve(&self) -> Result<Curve, SolveError> {
        let depths: Vec<f64> = (1..=DEPTHS)
            .map(|i| self.depth_mm * i as f64 / DEPTHS as f64)
            .collect();
        self.solve_at(&depths)
    }

    /// The curve at the given depths [mm], each at most the largest depth.
    ///
    /// # Errors
    /// See [`SolveError`].
    pub fn solve_at(&self, depths: &[f64]) -> Result<Curve, SolveError> {
        self.check()?;
        for &d in depths {
            if !(d <= self.depth_mm * (1.0 + 1e-9)) {
                return Err(parameter("depth_mm", d, format!("must not exceed the largest depth, {} mm", self.depth_mm)));
            }
        }
        let start = Instant::now();
        let mut stats = Stats::default();
        let mut fits = Vec::new();
        let mut paths = Vec::new();
        for factor in self.resolution.refinements() {
            let (path, unknowns) = self.path(factor)?;
            stats.unknowns = unknowns;
            stats.iterations += path.iterations;
            stats.steps += path.stations.len();
            stats.cuts += path.cuts;
            for s in &path.stations {
                stats.imbalance = stats.imbalance.max((s.base_force_n / s.force_n - 1.0).abs());
            }
            fits.push(self.profile(&path, factor));
            paths.push((factor, path));
        }
        let (profile, discretisation) = combine(&fits);
        stats.seconds = start.elapsed().as_secs_f64();
        Ok(Curve {
            depth_mm: depths.to_vec(),
            force_n: depths.iter().map(|&d| profile.force_n(d)).collect(),
            profile,
            discretisation,
            stats,
        })
    }

    /// Hertz's factor `4/3 E* sqrt(R)` [N/mm^1.5] with `E* = E/(1-nu^2) = 2 mu/(1-nu)`.
    #[must_use]
    pub fn hertz_factor(&self) -> f64 {
        let plane = 2.0 * self.law.shear_modulus_mpa() / (1.0 - self.law.poisson_ratio());
        4.0 / 3.0 * plane * self.ball.radius_mm.sqrt()
    }

    fn check(&self) -> Result<(), SolveError> {
        let positive = [
            ("height_mm", self.specimen.height_mm),
            ("radius_mm of the specimen", self.specimen.radius_mm),
            ("radius_mm of the ball", self.ball.radius_mm),
            ("depth_mm", self.depth_mm),
        ];
        for (name, value) in positive {
            if !(value.is_finite() && value > 0.0) {
                return Err(parameter(name, value, "must be positive".into()));
            }
        }
        if self.depth_mm >= 0.95 * self.specimen.height_mm {
            let expected = format!("must stay below 95 % of the height, {} mm", self.specimen.height_mm);
            return Err(parameter("depth_mm", self.depth_mm, expected));
        }
        if self.specimen.radius_mm < 1.5 * self.ball.radius_mm {
            let expected = format!("must be at least 1.5 ball radii, {} mm", 1.5 * self.ball.radius_mm);
            return Err(parameter("radius_mm of the specimen", self.specimen.radius_mm, expected));
        }
        if let Resolution::Refined(factor) = self.resolution
            && !(0.3..=6.0).contains(&factor)
        {
            return Err(parameter("refinement", factor, "must lie in 0.3..6".into()));
        }
        Ok(())
    }

    /// Solves on the mesh of one refinement; returns the path and the unknowns.
    fn path(&self, refinement: f64) -> Result<(Path, usize), SolveError> {
        let sizes = Sizes { refinement, ..SIZES };
        let radius = self.ball.radius_mm;
        let mesh = BlockMesh::new(self.specimen.radius_mm, self.specimen.height_mm, radius, &sizes);
        let penalty = PENALTY * self.law.shear_modulus_mpa() / radius;
        let surface = Surface::new(&mesh.nodes, &mesh.top, 2.5 * radius, POINTS_PER_EDGE, penalty);
        let system = System::new(&mesh, self.specimen.base, self.ball, surface, Quadrature::Reduced);
        let path = Stepping::default().follow(
            &system,
            &self.law,
            &Newton::default(),
            radius,
            self.depth_mm,
            &self.label(),
        )?;
        Ok((path, system.unknowns()))
    }

    fn label(&self) -> String {
        let terms: Vec<String> = self
            .law
            .terms()
            .iter()
            .map(|t| format!("mu {} MPa, alpha {}, nu {}", t.mu_mpa, t.alpha, t.nu))
            .collect();
        format!("hyperfoam {}; height {} mm, ball {} mm", terms.join(" + "), self.specimen.height_mm, self.ball.radius_mm)
    }

    fn profile(&self, path: &Path, refinement: f64) -> (DepthProfile, f64) {
        let samples = samples(path, self.ball.radius_mm * SIZES.axis / refinement);
        DepthProfile::fit(&samples, self.depth_mm, self.hertz_factor(), TERMS, self.depth_mm / 8.0)
    }
}

fn parameter(parameter: &'static str, value: f64, expected: String) -> SolveError {
    SolveError::Parameter { parameter, value, expected }
}

/// Forces freed from the penalty to first order: with the penalty energy `E` the
/// potential exceeds that of hard contact by `-E + O(1/k^2)`, hence `F = F_k + dE/dd`.
/// Weights: an error of second order in element size over contact radius.
fn samples(path: &Path, size_mm: f64) -> Vec<Sample> {
    let stations = &path.stations;
    let at = |i: usize| {
        if i == 0 { (0.0, 0.0) } else { (stations[i - 1].depth_mm, stations[i - 1].penalty_energy) }
    };
    stations
        .iter()
        .enumerate()
        .map(|(i, s)| {
            let last = i + 1 == stations.len();
            let three = if last && i > 0 { [at(i - 1), at(i), at(i + 1)] } else { [at(i), at(i + 1), at((i + 2).min(stations.len()))] };
            Sample {
                depth_mm: s.depth_mm,
                force_n: s.force_n + parabola_slope(&three, s.depth_mm),
                error: 5e-4 + 0.2 * (size_mm / s.contact_radius_mm).powi(2),
            }
        })
        .collect()
}

/// Slope at `x` of the parabola through three points.
fn parabola_slope(p: &[(f64, f64); 3], x: f64) -> f64 {
    let first = (p[1].1 - p[0].1) / (p[1].0 - p[0].0);
    if p[2].0 <= p[1].0 {
        return first;
    }
    let second = ((p[2].1 - p[1].1) / (p[2].0 - p[1].0) - first) / (p[2].0 - p[0].0);
    first + second * (2.0 * x - p[0].0 - p[1].0)
}

/// One fit is taken as it is; of two meshes the finer is extrapolated.
fn combine(fits: &[(DepthProfile, f64)]) -> (DepthProfile, f64) {
    let (last, scatter) = &fits[fits.len() - 1];
    if fits.len() == 1 {
        return (last.clone(), *scatter);
    }
    let first = &fits[0].0;
    let mut out = last.clone();
    for (o, f) in out.coefficients.iter_mut().zip(&first.coefficients) {
        *o += EXTRAPOLATION * (*o - f);
    }
    let difference = (8..=64)
        .map(|i| {
            let d = last.depth_max_mm * f64::from(i) / 64.0;
            (last.force_n(d) / first.force_n(d) - 1.0).abs()
        })
        .fold(0.0, f64::max);
    (out, scatter.hypot(0.5 * difference))
}

/// Richardson's factor `1 / (q^p - 1)` for the refinement q = 1.5 and the
/// measured order p = 2 of the force.
const EXTRAPOLATION: f64 = 0.8;
