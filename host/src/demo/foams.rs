//! The foams that lie on the bench.

use std::sync::atomic::{AtomicUsize, Ordering};

use lut_gen::solid::contact::Ball;
use lut_gen::solid::law::Hyperfoam;
use lut_gen::solid::model::{Indentation, Resolution, Specimen};
use lut_gen::table::foams;

use super::{BALL_RADIUS_MM, DemoError, Stage, Watcher};
use crate::plant::{Curve, Foam};

/// Step of the curves, mm.
pub(super) const STEP_MM: f64 = 0.02;

/// How much deeper than a palpation the curves go, mm: the arm overshoots by its stopping distance.
pub(super) const BEYOND_MM: f64 = 0.2;

/// The real foams of the library with curves of their own: each at its own height, on another mesh than the table's, to a
/// greater depth than `depth_mm`, that of the table.
///
/// # Errors
/// [`DemoError::Solve`] when a solve fails.
pub fn bench_foams(depth_mm: f64, watch: Watcher<'_>) -> Result<Vec<Foam>, DemoError> {
    use rayon::prelude::*;
    let real: Vec<_> = foams().into_iter().filter(|f| !f.dummy).collect();
    let steps = ((depth_mm + BEYOND_MM) / STEP_MM).round() as usize;
    let depths: Vec<f64> = (1..=steps).map(|i| STEP_MM * i as f64).collect();
    let done = AtomicUsize::new(0);
    real.par_iter()
        .map(|foam| {
            let failed = |source| DemoError::Solve { what: format!("curve of {}", foam.name), source };
            let indentation = Indentation {
                law: Hyperfoam::one_term(foam.mu_mpa, foam.alpha).map_err(|e| failed(e.into()))?,
                specimen: Specimen::of_height(foam.height_mm),
                ball: Ball { radius_mm: BALL_RADIUS_MM },
                depth_mm: STEP_MM * steps as f64,
                resolution: Resolution::Fine,
            };
            let solved = indentation.solve_at(&depths).map_err(failed)?;
            let curve =
                Curve::new(STEP_MM, &solved.force_n).ok_or_else(|| DemoError::Curve { name: foam.name.to_owned() })?;
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            watch(Stage::Solving { what: "foams of the bench", done, total: real.len() });
            Ok(Foam {
                name: foam.name.to_owned(),
                mu_mpa: foam.mu_mpa,
                alpha: foam.alpha,
                height_mm: foam.height_mm,
                curve,
            })
        })
        .collect::<Vec<_>>()
        .into_iter()
        .collect()
}
