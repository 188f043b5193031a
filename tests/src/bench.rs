//! Recordings as an experiment folder would hold them, made of forces that a simulation gave.

use std::path::PathBuf;

use palpate::experiment::{Base, BaseLaw, Experiment, Indenter, Length, Run, Sensor, Specimen};
use palpate::study::subject::pressed;
use rand_pcg::Pcg64;

pub use palpate::study::subject::STEP_MM;
/// Radius of every specimen, mm.
pub const RADIUS_MM: f64 = 25.0;

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
        let recording = pressed(forces_n, self.noise, &mut self.chance);
        self.experiment.runs.push(Run::indentation(
            format!("press {}", self.experiment.runs.len() + 1),
            specimen,
            indenter,
            recording,
        ));
    }
}
