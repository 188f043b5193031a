//! A computed force-depth curve: a ramp, smoothed over the marks its mesh leaves.

use std::time::Instant;

use super::{DepthProfile, RampRelaxation, Record, Sample, Simulation, Watcher};
use crate::solid::law::Law;
use crate::solid::solve::{SolveError, Target};

/// What a solve cost.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Stats {
    /// Unknowns of the finest mesh.
    pub unknowns: usize,
    /// Corrections of Newton's method, all meshes.
    pub iterations: usize,
    /// Factorisations, all meshes.
    pub factorisations: usize,
    /// Depth steps of all meshes.
    pub steps: usize,
    /// Steps that had to be cut.
    pub cuts: usize,
    /// Wall time (s).
    pub seconds: f64,
    /// Largest relative difference of contact force and base reaction.
    pub imbalance: f64,
}

/// Force of the ball over depth.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Depths (mm).
    pub depth_mm: Vec<f64>,
    /// Force at each depth (N).
    pub force_n: Vec<f64>,
    /// The curve as a function of depth.
    pub profile: DepthProfile,
    /// Estimated relative discretisation error of the force, from 1/8 of the
    /// largest depth on: scatter of the stations about the smooth profile and,
    /// with two meshes, half their difference.
    pub discretisation: f64,
    /// What it cost.
    pub stats: Stats,
}

/// Terms of the depth profile.
pub(super) const TERMS: usize = 10;

/// Largest relative difference of contact force and base reaction: ten times what Newton's
/// tolerance leaves at the first stations.
const IMBALANCE: f64 = 0.02;

/// Largest relative scatter of the equilibria about the smooth curve: beyond, the curve's shape is
/// not that of an indentation (measured in the promised region: 0.0002 to 0.03).
const SCATTER: f64 = 0.05;

impl Simulation {
    /// Force over depth of a motion that is one ramp from touch, at the given depths (mm), each
    /// at most its end.
    ///
    /// # Errors
    /// See [`SolveError`]; [`SolveError::Unreliable`] when forces do not balance or scatter;
    /// [`SolveError::Parameter`] when the motion is more than a ramp, when
    /// there is adhesion (its curve does not start like Hertz's), or a depth lies beyond the ramp.
    pub fn curve(&self, depths: &[f64]) -> Result<Curve, SolveError> {
        self.curve_watched(depths, &mut ())
    }

    /// As [`Simulation::curve`]; the observer sees the equilibria of every mesh, that of the finest last.
    ///
    /// # Errors
    /// As [`Simulation::curve`], and what the observer returns.
    pub(super) fn curve_watched(&self, depths: &[f64], observer: &mut impl Watcher) -> Result<Curve, SolveError> {
        let depth_max_mm = self.ramp()?;
        for &d in depths {
            if d.is_nan() || d > depth_max_mm * (1.0 + 1e-9) {
                let expected = format!("must not exceed the largest depth, {depth_max_mm} mm");
                return Err(SolveError::Parameter { parameter: "depth_mm", value: d, expected });
            }
        }
        let start = Instant::now();
        let mut stats = Stats::default();
        let mut fits = Vec::new();
        for refinement in self.resolution.refinements() {
            let (path, unknowns) = self.path(refinement, observer)?;
            let record = Record::new(path);
            stats.unknowns = unknowns;
            stats.iterations += record.iterations;
            stats.factorisations += record.factorisations;
            stats.steps += record.stations.len();
            stats.cuts += record.cuts;
            for s in &record.stations {
                stats.imbalance = stats.imbalance.max((s.base_force_n / s.force_n - 1.0).abs());
            }
            fits.push(self.ramp_profile(&record, depth_max_mm, refinement));
        }
        let (profile, discretisation) = combine(&fits);
        self.trust("the largest difference of contact force and base reaction", stats.imbalance, IMBALANCE)?;
        self.trust("the scatter of the equilibria about a smooth curve", discretisation, SCATTER)?;
        stats.seconds = start.elapsed().as_secs_f64();
        Ok(Curve {
            depth_mm: depths.to_vec(),
            force_n: depths.iter().map(|&d| profile.force_n(d)).collect(),
            profile,
            discretisation,
            stats,
        })
    }

    /// Refuses a record whose forces do not balance, or that scatters about its smooth curve.
    pub(super) fn trust_record(&self, record: &Record, scatter: f64) -> Result<(), SolveError> {
        let unbalanced = |s: &crate::solid::solve::Station| (s.base_force_n / s.force_n - 1.0).abs();
        let imbalance = record.stations.iter().map(unbalanced).fold(0.0, f64::max);
        self.trust("the largest difference of contact force and base reaction", imbalance, IMBALANCE)?;
        self.trust("the scatter of the equilibria about a smooth curve", scatter, SCATTER)
    }

    fn trust(&self, measure: &'static str, value: f64, limit: f64) -> Result<(), SolveError> {
        if value <= limit {
            return Ok(());
        }
        Err(SolveError::Unreliable {
            measure,
            value,
            limit,
            case: format!("{}, depth {} mm", self.label(), self.depth_mm()),
        })
    }

    /// `d ln E* / d ln mu` of the contact modulus `E* = 4 mu (3K + mu) / (3K + 4 mu)`: the part of a small
    /// indentation that relaxes with the shear modulus; the rest relaxes with the bulk modulus.
    fn shear_share(&self) -> f64 {
        let nu = self.material.elastic.poisson_ratio();
        let three_k = 2.0 * (1.0 + nu) / (1.0 - 2.0 * nu);
        1.0 + 1.0 / (three_k + 1.0) - 4.0 / (three_k + 4.0)
    }

    /// Depth (mm) of the only segment.
    pub(super) fn ramp(&self) -> Result<f64, SolveError> {
        self.check()?;
        if self.interface.adhesion.is_some() {
            return Err(SolveError::parameter(
                "adhesion",
                1.0,
                "has no smooth curve: use the record of the simulation",
            ));
        }
        match self.motion.segments.as_slice() {
            [one] if self.motion.start_mm == 0.0 => match one.end {
                Target::DepthMm(d) if d > 0.0 => Ok(d),
                Target::DepthMm(d) => Err(SolveError::parameter("depth_mm", d, "must be positive")),
                Target::ForceN(f) => {
                    Err(SolveError::parameter("force_n", f, "is no depth: a curve needs a depth ramp"))
                }
            },
            all => Err(SolveError::parameter(
                "segments of the motion",
                all.len() as f64,
                "but a curve needs one ramp from touch",
            )),
        }
    }

    /// The smooth curve of this ramp from the record of it, which may go on with a hold; and the
    /// scatter of the stations about it.
    pub(crate) fn ramp_profile(&self, record: &Record, depth_max_mm: f64, refinement: f64) -> (DepthProfile, f64) {
        let size_mm = self.element_mm(refinement);
        let shear = self.shear_share();
        let rate = depth_max_mm / self.motion.duration_s();
        let elements =
            self.material.prony.iter().map(|t| (shear * t.g + (1.0 - shear) * t.k, rate * t.tau_s)).collect();
        let relaxation = RampRelaxation { elements };
        let samples = samples(record, self.motion.duration_s(), size_mm);
        DepthProfile::fit(&samples, depth_max_mm, self.hertz_factor(), relaxation, TERMS, depth_max_mm / 8.0)
    }
}

/// Forces with their weights: an error of second order in element size over contact radius.
fn samples(record: &Record, end_s: f64, size_mm: f64) -> Vec<Sample> {
    record
        .stations
        .iter()
        .zip(&record.force_n)
        .take_while(|(s, _)| s.time_s <= end_s * (1.0 + 1e-12))
        .map(|(s, &force_n)| Sample {
            depth_mm: s.depth_mm,
            force_n,
            error: 5e-4 + 0.2 * (size_mm / s.contact_radius_mm).powi(2),
        })
        .collect()
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
