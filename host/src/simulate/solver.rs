//! Finite-element solves, each distinct case once.

use std::collections::HashMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use lut_gen::solid::model::{DepthProfile, RampRelaxation, Record, Sample, Simulation};
use lut_gen::solid::solve::SolveError;

use super::interpolation::Smooth;

type Slot<T> = Arc<OnceLock<Result<Arc<T>, SolveError>>>;
type Cases<T> = Mutex<HashMap<String, Slot<T>>>;

/// Solves finite-element cases and remembers them. One solver may serve any number of specifications, from any number of
/// threads: whatever asks second waits for whoever asked first.
#[derive(Debug, Default)]
pub struct Solver {
    curves: Cases<Curve>,
    paths: Cases<Record>,
    solves: AtomicUsize,
}

impl Solver {
    /// Nothing solved yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Solves so far.
    #[must_use]
    pub fn solves(&self) -> usize {
        self.solves.load(Ordering::Relaxed)
    }

    /// The smooth curve of a ramp from touch.
    pub(super) fn curve(&self, case: &Simulation) -> Result<Arc<Curve>, SolveError> {
        slot(&self.curves, case)
            .get_or_init(|| {
                self.solves.fetch_add(1, Ordering::Relaxed);
                Ok(Arc::new(Curve::of(case, &case.solve()?)?))
            })
            .clone()
    }

    /// The equilibria of any motion.
    pub(super) fn path(&self, case: &Simulation) -> Result<Arc<Record>, SolveError> {
        slot(&self.paths, case)
            .get_or_init(|| {
                self.solves.fetch_add(1, Ordering::Relaxed);
                Ok(Arc::new(case.solve()?))
            })
            .clone()
    }
}

/// The elastic press.
#[derive(Debug)]
pub(super) struct Curve {
    /// Force over depth.
    pub profile: DepthProfile,
    /// Force of hard contact less that of the penalty, over the square of the latter (1/N), by depth: what the penalty's
    /// softness takes from a force grows with the square of the stress.
    pub softness: Smooth,
}

/// Terms of the profile, and the radial size of the elements at the axis of the standard mesh in ball radii.
const TERMS: usize = 10;
const AXIS: f64 = 0.05;

/// Largest relative scatter that is taken for an indentation; 0.0005 is usual on the finer mesh.
const SCATTER: f64 = 0.05;

impl Curve {
    /// The smooth curve through the equilibria; their scatter is of second order in element size over contact radius.
    ///
    /// # Errors
    /// [`SolveError::Unreliable`] when they scatter by more than [`SCATTER`]: what they follow is no indentation.
    fn of(case: &Simulation, record: &Record) -> Result<Self, SolveError> {
        let size_mm = case.ball.radius_mm * AXIS;
        let samples: Vec<Sample> = record
            .stations
            .iter()
            .zip(&record.force_n)
            .map(|(s, &force_n)| Sample {
                depth_mm: s.depth_mm,
                force_n,
                error: 5e-4 + 0.2 * (size_mm / s.contact_radius_mm.max(1e-3 * size_mm)).powi(2),
            })
            .collect();
        let depth = case.depth_mm();
        let (profile, scatter) =
            DepthProfile::fit(&samples, depth, case.hertz_factor(), RampRelaxation::default(), TERMS, 0.125 * depth);
        if scatter.is_nan() || scatter > SCATTER {
            let measure = "the scatter of the equilibria about a smooth curve";
            return Err(SolveError::Unreliable { measure, value: scatter, limit: SCATTER, case: case.label() });
        }
        let soft = record.stations.iter().zip(&record.force_n).filter(|(s, _)| s.force_n > 0.0);
        let softness = Smooth::through(soft.map(|(s, f)| (s.depth_mm, (f - s.force_n) / s.force_n.powi(2))), 0.0);
        Ok(Self { profile, softness })
    }

    /// Force of hard contact at a depth where the penalty's is `soft_n`.
    pub fn hard_n(&self, depth_mm: f64, soft_n: f64) -> f64 {
        soft_n + self.softness.at(depth_mm) * soft_n * soft_n
    }
}

/// The place of a case. Its name is the whole case, every number in full.
fn slot<T>(cases: &Cases<T>, case: &Simulation) -> Slot<T> {
    let mut cases = cases.lock().unwrap_or_else(PoisonError::into_inner);
    cases.entry(format!("{case:?}")).or_default().clone()
}
