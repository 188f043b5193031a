//! Force of the ball on every specimen of a tour, by finite elements at the rate of the tour.

use lut_gen::solid::contact::{Ball, Interface};
use lut_gen::solid::law::{Hyperfoam, Material, Ogden, PronyTerm};
use lut_gen::solid::model::{Resolution, Simulation, Specimen};
use lut_gen::solid::solve::{Motion, SolveError};
use rayon::prelude::*;

use super::press::TourError;
use super::stops::{Law, Stop, Tour};
use crate::demo::BALL_RADIUS_MM;
use crate::plant::{Curve, Foam};

/// Step of the curves, mm.
const STEP_MM: f64 = 0.02;
/// How much deeper than a palpation the curves go, mm: contact is believed up to some tenths too low.
const BEYOND_MM: f64 = 0.3;

/// Forces over depth of all stops, in their order.
#[derive(Debug, Clone, PartialEq)]
pub struct Specimens {
    /// N at even steps of [`STEP_MM`], fresh.
    forces_n: Vec<Vec<f64>>,
}

impl Specimens {
    /// Presses every stop to a depth (mm) at a rate (mm/s); `told` hears how many are done.
    ///
    /// # Errors
    /// [`TourError::Solve`] with the stop that cannot be followed.
    pub fn solved(
        tour: &Tour,
        (depth_mm, rate_mm_s): (f64, f64),
        told: &(dyn Fn(usize) + Sync),
    ) -> Result<Self, TourError> {
        let steps = ((depth_mm + BEYOND_MM) / STEP_MM).round() as usize;
        let depths: Vec<f64> = (1..=steps).map(|i| STEP_MM * i as f64).collect();
        let done = std::sync::atomic::AtomicUsize::new(0);
        let each = tour.stops.par_iter().map(|stop| {
            let force_n = pressed(stop, &depths, rate_mm_s)
                .map_err(|source| TourError::Solve { stop: stop.name.clone(), source: Box::new(source) })?;
            told(done.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1);
            Ok(force_n)
        });
        Ok(Self { forces_n: each.collect::<Result<_, TourError>>()? })
    }

    /// A stop in one of its presses, from 1, as the bench lays it under the probe.
    #[must_use]
    pub fn foam(&self, tour: &Tour, stop: usize, press: usize) -> Option<Foam> {
        let (own, fresh) = (tour.stops.get(stop)?, self.forces_n.get(stop)?);
        let force_n: Vec<f64> = fresh.iter().map(|force| own.softened(press) * force).collect();
        Some(Foam {
            name: own.name.clone(),
            mu_mpa: own.mu_mpa * own.softened(press),
            alpha: own.alpha,
            height_mm: own.height_mm,
            curve: Curve::new(STEP_MM, &force_n)?,
        })
    }

    /// Depth (mm) and force (N) of a fresh stop.
    #[must_use]
    pub fn fresh(&self, stop: usize) -> Vec<(f64, f64)> {
        let forces = self.forces_n.get(stop).map_or(&[][..], Vec::as_slice);
        forces.iter().enumerate().map(|(k, force)| (STEP_MM * (k + 1) as f64, *force)).collect()
    }
}

fn pressed(stop: &Stop, depths: &[f64], rate_mm_s: f64) -> Result<Vec<f64>, SolveError> {
    let elastic: Material = match stop.law {
        Law::Hyperfoam => Hyperfoam::one_term(stop.mu_mpa, stop.alpha)?.into(),
        Law::Ogden { d_mu } => Ogden::one_term(stop.mu_mpa, stop.alpha, d_mu / stop.mu_mpa)?.into(),
    };
    let relaxing = stop.relaxes.map(|(g, k, tau_s)| PronyTerm { g, k, tau_s });
    let deepest_mm = depths.iter().copied().fold(0.0, f64::max);
    let simulation = Simulation {
        material: elastic.relaxing(relaxing.into_iter().collect())?,
        specimen: Specimen::of_height(stop.height_mm),
        ball: Ball { radius_mm: BALL_RADIUS_MM },
        interface: Interface::default(),
        motion: Motion::ramp(deepest_mm, rate_mm_s),
        resolution: Resolution::Standard,
    };
    Ok(simulation.curve(depths)?.force_n.iter().map(|force| force.max(0.0)).collect())
}
