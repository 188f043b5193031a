//! One indentation: a specimen, a law, a ball, a depth.

use std::time::Instant;

use super::profile::DepthProfile;
use super::{Curve, Sample, Stats};
use crate::contact::{Ball, Surface};
use crate::element::Quadrature;
use crate::law::{Hyperfoam, Law};
use crate::mesh::{BlockMesh, Sizes};
use crate::solve::{Base, Newton, Path, SolveError, Station, Stepping, System};
use crate::verify::hertz_force_n;

/// A cylindrical block with free sides.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Specimen {
    /// Height `h` (mm).
    pub height_mm: f64,
    /// Radius `W` (mm).
    pub radius_mm: f64,
    /// How its bottom is held.
    pub base: Base,
}

impl Specimen {
    /// A bonded block of the default radius, 25 mm.
    #[must_use]
    pub fn of_height(height_mm: f64) -> Self {
        Self { height_mm, radius_mm: 25.0, base: Base::Bonded }
    }
}

/// How finely an indentation is resolved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Resolution {
    /// One mesh: within 0.25 % of a mesh refined 2.5 times from 0.25 mm on for a 4 mm depth (docs/physics.md).
    Standard,
    /// Two meshes, the finer with all sizes divided by 1.5: their difference states the error.
    Fine,
    /// One mesh with all element sizes divided by the given factor.
    Refined(f64),
}

impl Resolution {
    /// A mesh with elements smaller by 1.5 than the finest of this one, to measure its error with.
    #[must_use]
    pub fn finer(self) -> Self {
        let finest = self.refinements().into_iter().fold(0.0, f64::max);
        Self::Refined(1.5 * finest)
    }

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
    /// Largest depth (mm).
    pub depth_mm: f64,
    /// Mesh.
    pub resolution: Resolution,
}

/// Depths of [`Indentation::solve`], as in the thesis' storage matrices.
pub const DEPTHS: usize = 200;

/// Penalty in units of expected mean pressure over ball radius: the mean
/// penetration stays near `R / 400`, about half a percent of the depth at
/// any depth, and its effect on the force is removed to first order.
const PENALTY: f64 = 400.0;

/// Least pressure the penalty is scaled with, in units of `mu`.
const LEAST_PRESSURE: f64 = 1.0;

/// Factor on the penalty when a solve fails, and how often that is tried. A soft
/// penalty lets a thin or low-exponent surface slide off the ball's flank.
const STIFFER: f64 = 4.0;
const ATTEMPTS: i32 = 3;

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
        let depths: Vec<f64> = (1..=DEPTHS).map(|i| self.depth_mm * i as f64 / DEPTHS as f64).collect();
        self.solve_at(&depths)
    }

    /// The curve at the given depths (mm), each at most the largest depth.
    ///
    /// # Errors
    /// See [`SolveError`].
    pub fn solve_at(&self, depths: &[f64]) -> Result<Curve, SolveError> {
        self.check()?;
        for &d in depths {
            if d.is_nan() || d > self.depth_mm * (1.0 + 1e-9) {
                return Err(parameter(
                    "depth_mm",
                    d,
                    format!("must not exceed the largest depth, {} mm", self.depth_mm),
                ));
            }
        }
        let start = Instant::now();
        let mut stats = Stats::default();
        let mut fits = Vec::new();
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

    /// The computed equilibria of the finest mesh, before any smoothing; forces
    /// as they are with the penalty.
    ///
    /// # Errors
    /// See [`SolveError`].
    pub fn stations(&self) -> Result<Vec<Station>, SolveError> {
        self.check()?;
        let finest = self.resolution.refinements().into_iter().fold(0.0, f64::max);
        Ok(self.path(finest)?.0.stations)
    }

    /// Hertz's factor `F / d^(3/2)` (N/mm^1.5) of the limit `d -> 0`, see [`hertz_force_n`].
    #[must_use]
    pub fn hertz_factor(&self) -> f64 {
        hertz_force_n(self.law.shear_modulus_mpa(), self.law.poisson_ratio(), self.ball.radius_mm, 1.0)
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

    /// Pressure scale of the penalty (MPa): uniaxial stress at the compression
    /// of the ball's neighbourhood (a quarter) plus that of the whole block.
    fn pressure_mpa(&self) -> f64 {
        let l = (0.75 - self.depth_mm / self.specimen.height_mm).max(0.2);
        let p = self.law.stress([l, 1.0, 1.0]).1[0].abs();
        p.max(LEAST_PRESSURE * self.law.shear_modulus_mpa())
    }

    /// Solves on the mesh of one refinement, with a stiffer penalty if need be.
    fn path(&self, refinement: f64) -> Result<(Path, usize), SolveError> {
        let penalty = PENALTY * self.pressure_mpa() / self.ball.radius_mm;
        let mut outcome = self.path_with(refinement, penalty);
        for attempt in 1..ATTEMPTS {
            if outcome.is_ok() {
                break;
            }
            outcome = self.path_with(refinement, penalty * STIFFER.powi(attempt));
        }
        outcome
    }

    /// Solves with a given penalty (MPa/mm); returns the path and the unknowns.
    fn path_with(&self, refinement: f64, penalty: f64) -> Result<(Path, usize), SolveError> {
        let sizes = Sizes { refinement, ..SIZES };
        let radius = self.ball.radius_mm;
        let mesh = BlockMesh::new(self.specimen.radius_mm, self.specimen.height_mm, radius, &sizes);
        let surface = Surface::new(self.ball, &mesh.nodes, &mesh.top, 2.5 * radius, POINTS_PER_EDGE, penalty);
        let system = System::new(&mesh, self.specimen.base, surface, Quadrature::Reduced);
        let path =
            Stepping::default().follow(&system, &self.law, &Newton::default(), radius, self.depth_mm, &self.label())?;
        Ok((path, system.unknowns()))
    }

    fn label(&self) -> String {
        let terms: Vec<String> =
            self.law.terms().iter().map(|t| format!("mu {} MPa, alpha {}, nu {}", t.mu_mpa, t.alpha, t.nu)).collect();
        format!(
            "hyperfoam {}; height {} mm, ball {} mm",
            terms.join(" + "),
            self.specimen.height_mm,
            self.ball.radius_mm
        )
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
            let three = if last && i > 0 {
                [at(i - 1), at(i), at(i + 1)]
            } else {
                [at(i), at(i + 1), at((i + 2).min(stations.len()))]
            };
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

/// The finest fit; with two meshes, half their difference adds to the scatter.
///
/// There is no extrapolation: on these meshes the error is scatter of the contact
/// edge between mesh lines, not bias, and Richardson's rule was measured to enlarge it.
fn combine(fits: &[(DepthProfile, f64)]) -> (DepthProfile, f64) {
    let (last, scatter) = &fits[fits.len() - 1];
    let first = &fits[0].0;
    let difference = (8..=64)
        .map(|i| {
            let d = last.depth_max_mm * f64::from(i) / 64.0;
            (last.force_n(d) / first.force_n(d) - 1.0).abs()
        })
        .fold(0.0, f64::max);
    (last.clone(), scatter.hypot(0.5 * difference))
}
