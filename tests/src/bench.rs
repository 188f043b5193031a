//! Recordings as an experiment folder would hold them, made of forces that a simulation gave.

use std::path::PathBuf;

use palpate::experiment::{Base, BaseLaw, Experiment, Indenter, Length, Recording, Run, Sensor, Specimen};
use rand::Rng;
use rand_distr::{Distribution, Normal};
use rand_pcg::Pcg64;

/// Way between two samples, mm: 50 Hz at 1 mm/s.
pub const STEP_MM: f64 = 0.02;
/// Radius of every specimen, mm.
pub const RADIUS_MM: f64 = 25.0;
/// Where a ball touches, mm of its reading.
const TOUCH_MM: std::ops::Range<f64> = 0.2..0.6;

/// Specimens of one material, balls, and what was recorded with them.
#[derive(Debug)]
pub struct Bench {
    /// The experiment so far.
    pub experiment: Experiment,
    base_law: BaseLaw,
    noise: f64,
    chance: Pcg64,
}

impl Bench {
    /// An empty bench. `noise` is the standard deviation of a sample as a share of the run's largest force.
    #[must_use]
    pub fn new(base_law: BaseLaw, noise: f64, chance: Pcg64) -> Self {
        let experiment = Experiment {
            name: "blind".to_owned(),
            folder: PathBuf::new(),
            specimens: Vec::new(),
            indenters: Vec::new(),
            sensor: Sensor::default(),
            runs: Vec::new(),
        };
        Bench { experiment, base_law, noise, chance }
    }

    /// Puts a bonded block on the bench; returns its number. All are of the material "foam".
    pub fn specimen(&mut self, name: &str, height_mm: f64) -> usize {
        self.experiment.specimens.push(Specimen {
            name: name.to_owned(),
            material: "foam".to_owned(),
            base_law: self.base_law,
            terms: 1,
            height_mm: Length::Known(height_mm),
            radius_mm: Length::Known(RADIUS_MM),
            base: Base::Bonded,
        });
        self.experiment.specimens.len() - 1
    }

    /// Adds a ball; returns its number.
    pub fn ball(&mut self, radius_mm: f64) -> usize {
        let name = format!("r{radius_mm}");
        self.experiment.indenters.push(Indenter { name, radius_mm: Length::Known(radius_mm) });
        self.experiment.indenters.len() - 1
    }

    /// Records a press at 1 mm/s through `forces_n` at multiples of [`STEP_MM`] past the contact point, which is chance.
    pub fn press(&mut self, specimen: usize, indenter: usize, forces_n: &[f64]) {
        let contact_mm = self.chance.random_range(TOUCH_MM);
        let before = (contact_mm / STEP_MM) as usize;
        let peak = forces_n.last().copied().unwrap_or(0.0);
        let normal = Normal::new(0.0, self.noise * peak).ok();
        let count = before + forces_n.len();
        let time = (0..count).map(|i| i as f64 * STEP_MM).collect();
        // The first of the forces lies one step past contact.
        let depth = (0..count).map(|i| (i as f64 + 1.0 - before as f64) * STEP_MM + contact_mm).collect();
        let force = (0..count)
            .map(|i| {
                let clean = i.checked_sub(before).map_or(0.0, |at| forces_n[at]);
                clean + normal.map_or(0.0, |normal| normal.sample(&mut self.chance))
            })
            .collect();
        self.experiment.runs.push(Run::indentation(
            format!("press {}", self.experiment.runs.len() + 1),
            specimen,
            indenter,
            Recording::from_samples(time, depth, force),
        ));
    }
}
