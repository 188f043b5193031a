//! The script of thesis appendix C on its liver: the printed simplex from the printed start, each evaluation a finite-element solve of ramp and hold.
//!
//! The script ran Abaqus for every evaluation of Eq. 14 over `(mu, alpha, D, g, k, tau)` and took the absolute value of each. Its recording is not
//! printed; ours is simulated with what section 2.11 found. The contact point is known, as to the script. It assigns `m = fabs(x[0])` and then uses `mu`, which is
//! read as one name. Where no material is (a part that relaxes of 1 or more) Abaqus ends with an error; here the point counts as infinitely bad.

mod page;
pub mod simplex;

use std::collections::BTreeMap;

use lut_gen::solid::contact::{Ball, Interface};
use lut_gen::solid::law::{Material, Ogden, PronyTerm};
use lut_gen::solid::model::{Resolution, Simulation, Specimen as Block};
use lut_gen::solid::solve::{Base as Support, Motion, SolveError};
use rand::SeedableRng;
use rand_distr::{Distribution, Normal};
use rand_pcg::Pcg64;

use crate::experiment::{Base, BaseLaw, Experiment, Indenter, Length, Recording, Run, Sensor, Specimen};
use crate::identify::fe::Progress;
use crate::identify::newton::track::Track;

use super::StudyError;

pub use page::study;
pub use simplex::{Visit, printed};

/// Names of the six, in the script's order.
pub const NAMES: [&str; 6] = ["mu_MPa", "alpha", "D_per_MPa", "g", "k", "tau_s"];
/// What the script begins with.
pub const START: [f64; 6] = [0.012, 7.429, 2.5, 0.8, 0.0, 1.0];
/// What section 2.11 found, and what the recording is simulated with.
pub const LIVER: [f64; 6] = [5.329e-4, 21.8, 2.5, 0.822, 0.003, 0.999];

/// How the liver is pressed: ball, rate, depth, samples a second and length of the hold are the thesis' (sections 2.6 and 2.11, appendix C), the depth a
/// little less so that the ball stays above its equator; the specimen is not printed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Press {
    /// Height of the block, mm.
    pub height_mm: f64,
    /// Radius of the ball, mm.
    pub ball_mm: f64,
    /// Depth, mm.
    pub depth_mm: f64,
    /// Rate, mm/s.
    pub rate_mm_s: f64,
    /// Hold, s.
    pub hold_s: f64,
    /// Samples a second.
    pub hz: f64,
    /// Standard deviation of the noise, as a share of the largest force.
    pub noise: f64,
    /// Seed of the noise.
    pub seed: u64,
    /// Mesh of every evaluation; the recording's is finer by a half.
    pub refinement: f64,
}

impl Default for Press {
    fn default() -> Self {
        Self {
            height_mm: 30.0,
            ball_mm: 4.0,
            depth_mm: 3.8,
            rate_mm_s: 1.0,
            hold_s: 2.0,
            hz: 50.0,
            noise: 0.01,
            seed: 1,
            refinement: 1.0,
        }
    }
}

const BLOCK_RADIUS_MM: f64 = 25.0;
/// The recording's mesh is this much finer than that of an evaluation.
const FINER: f64 = 1.5;
/// Recorded above the specimen for those who look for the contact, mm.
const AIR_MM: f64 = 0.3;

impl Press {
    /// Force over time for `(mu, alpha, D, g, k, tau)`, by a solve for a unit modulus, to which force is proportional at fixed `mu D`.
    fn track(&self, x: &[f64; 6], refinement: f64) -> Result<Track, SolveError> {
        let [mu, alpha, d, g, k, tau_s] = *x;
        let elastic: Material = Ogden::one_term(1.0, alpha, d * mu)?.into();
        let simulation = Simulation {
            material: elastic.relaxing(vec![PronyTerm { g, k, tau_s }])?,
            specimen: Block { height_mm: self.height_mm, radius_mm: BLOCK_RADIUS_MM, base: Support::Bonded },
            ball: Ball { radius_mm: self.ball_mm },
            interface: Interface::default(),
            motion: Motion::ramp(self.depth_mm, self.rate_mm_s).hold(self.hold_s),
            resolution: Resolution::Refined(refinement),
        };
        let press = simulation.press(&[])?;
        let values: Vec<f64> = press.ramp.iter().chain(&press.hold).copied().collect();
        Ok(Track::new(press.depth_max_mm, press.hold_s, &values, mu.ln()))
    }

    /// Times (s) since touch at which the script reads forces.
    fn times(&self) -> Vec<f64> {
        let end = self.depth_mm / self.rate_mm_s + self.hold_s;
        (0..).map(|i| f64::from(i) / self.hz).take_while(|t| *t <= end + 1e-9).collect()
    }

    fn forces(&self, track: &Track, times: &[f64]) -> Vec<f64> {
        let peak_s = self.depth_mm / self.rate_mm_s;
        let at = |t: &f64| {
            if *t <= peak_s { track.ramp(self.rate_mm_s * t).0 } else { track.hold(self.depth_mm, t - peak_s).0 }
        };
        times.iter().map(at).collect()
    }
}

/// The recording, and what was asked of it.
pub struct Liver {
    /// How it is pressed.
    pub press: Press,
    /// Times since touch, s.
    pub time_s: Vec<f64>,
    /// Forces with noise, N.
    pub force_n: Vec<f64>,
    /// Forces of a unit modulus that were solved, by the other parameters' bits.
    solved: BTreeMap<[u64; 5], Option<Track>>,
    /// Why solves failed.
    pub failures: Vec<String>,
}

impl Liver {
    /// Simulates the recording.
    ///
    /// # Errors
    /// When the solve fails.
    pub fn recorded(press: Press) -> Result<Self, StudyError> {
        let track = press.track(&LIVER, FINER * press.refinement)?;
        let time_s = press.times();
        let clean = press.forces(&track, &time_s);
        let peak = clean.iter().copied().fold(0.0, f64::max);
        let mut chance = Pcg64::seed_from_u64(press.seed);
        let normal = Normal::new(0.0, press.noise * peak).ok();
        let force_n = clean.iter().map(|f| f + normal.map_or(0.0, |normal| normal.sample(&mut chance))).collect();
        Ok(Self { press, time_s, force_n, solved: BTreeMap::new(), failures: Vec::new() })
    }

    /// Eq. 14 (N) at what the script makes of a point: the absolute value of each coordinate; infinite where there is no material.
    pub fn objective_n(&mut self, x: &[f64]) -> f64 {
        self.forces_at(x).map_or(f64::INFINITY, |model| {
            model.iter().zip(&self.force_n).map(|(model, measured)| (model - measured).abs()).sum()
        })
    }

    /// Modelled forces (N) there.
    pub fn forces_at(&mut self, x: &[f64]) -> Option<Vec<f64>> {
        let x: [f64; 6] = std::array::from_fn(|i| x.get(i).copied().unwrap_or(0.0).abs());
        let unit = [1.0, x[1], x[0] * x[2], x[3], x[4], x[5]];
        let key = [unit[1], unit[2], unit[3], unit[4], unit[5]].map(f64::to_bits);
        if !self.solved.contains_key(&key) {
            let outcome = self.press.track(&unit, self.press.refinement);
            self.failures.extend(outcome.as_ref().err().map(ToString::to_string));
            self.solved.insert(key, outcome.ok());
        }
        let track = self.solved.get(&key)?.as_ref()?;
        let forces = self.press.forces(track, &self.time_s);
        Some(forces.into_iter().map(|f| x[0] * f).collect())
    }

    /// Solves so far.
    #[must_use]
    pub fn solves(&self) -> usize {
        self.solved.len()
    }

    /// The same recording as `identify` takes it, with some air before, so that it has to find the contact.
    #[must_use]
    pub fn experiment(&self) -> Experiment {
        let (p, step) = (self.press, 1.0 / self.press.hz);
        let before = (AIR_MM / p.rate_mm_s / step) as usize;
        let times = (0..before).map(|i| (i as f64 - before as f64) * step).chain(self.time_s.iter().copied());
        let times: Vec<f64> = times.collect();
        let depth = times.iter().map(|t| (t * p.rate_mm_s).min(p.depth_mm) + AIR_MM).collect();
        let mut chance = Pcg64::seed_from_u64(p.seed.wrapping_add(1));
        let peak = self.force_n.iter().copied().fold(0.0, f64::max);
        let normal = Normal::new(0.0, p.noise * peak).ok();
        let air = (0..before).map(|_| normal.map_or(0.0, |normal| normal.sample(&mut chance)));
        let force = air.chain(self.force_n.iter().copied()).collect();
        let time = times.iter().map(|t| t - times[0]).collect();
        Experiment {
            name: "simulated liver".to_owned(),
            folder: std::path::PathBuf::new(),
            specimens: vec![Specimen {
                name: "liver".to_owned(),
                material: "liver".to_owned(),
                base_law: BaseLaw::Ogden,
                terms: 1,
                height_mm: Length::Known(p.height_mm),
                radius_mm: Length::Known(BLOCK_RADIUS_MM),
                base: Base::Bonded,
            }],
            indenters: vec![Indenter { name: "ball".to_owned(), radius_mm: Length::Known(p.ball_mm) }],
            sensor: Sensor::default(),
            runs: vec![Run::indentation("liver".to_owned(), 0, 0, Recording::from_samples(time, depth, force))],
        }
    }
}

/// The script's search on a recording: every evaluation in order.
pub fn searched(liver: &mut Liver, most: usize, progress: &Progress<'_>) -> Vec<Visit> {
    let mut count = 0;
    printed(
        &mut |x: &[f64]| {
            count += 1;
            progress("the script of appendix C", count, most);
            liver.objective_n(x)
        },
        &START,
        most,
    )
}
