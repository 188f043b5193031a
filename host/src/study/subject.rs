//! Whose recordings a study looks at.

use std::path::PathBuf;

use lut_gen::solid::contact::Ball;
use lut_gen::solid::law::Hyperfoam;
use lut_gen::solid::model::{Indentation, Resolution, Specimen as Block};
use lut_gen::solid::solve::{Base as Support, SolveError};
use rand::{Rng, SeedableRng};
use rand_distr::{Distribution, Normal};
use rand_pcg::Pcg64;

use crate::experiment::motion::Motion;
use crate::experiment::{Base, BaseLaw, Experiment, Indenter, Length, Recording, Run, Sensor, Specimen, Test};
use crate::identify::data::{self, Height, LoadingCurve, Selection};
use crate::identify::{materials, motions};
use crate::report::number;

use super::StudyError;

/// A foam that exists only as numbers, and how it is pressed.
#[derive(Debug, Clone, PartialEq)]
pub struct Foam {
    /// What it is called.
    pub name: String,
    /// Shear modulus, MPa.
    pub mu_mpa: f64,
    /// Exponent.
    pub alpha: f64,
    /// Height of the block, mm.
    pub height_mm: f64,
    /// Radii of the balls, mm; each is pressed in once.
    pub balls_mm: Vec<f64>,
    /// Depth past contact, mm.
    pub depth_mm: f64,
    /// Standard deviation of a sample's noise, as a share of the run's largest force.
    pub noise: f64,
    /// Seed of noise and contact points.
    pub seed: u64,
    /// The recordings' mesh; a finer one than the fit's keeps the mesh from being part of the answer.
    pub resolution: Resolution,
}

/// Radius of every simulated block, mm.
const BLOCK_RADIUS_MM: f64 = 25.0;
/// The recordings' mesh is this much finer than the fit's.
const FINER: f64 = 1.5;
/// The tester of thesis section 2.6: 50 Hz at 1 mm/s.
pub const STEP_MM: f64 = 0.02;
/// Where a run may touch, mm of its depth reading.
const CONTACT_MM: (f64, f64) = (0.2, 0.6);

impl Foam {
    /// EVA as the thesis identified it with both balls (Table 1): 12.7 mm thick, balls of 4 and 6 mm.
    #[must_use]
    pub fn eva() -> Self {
        Self {
            name: "EVA".to_owned(),
            mu_mpa: 0.245,
            alpha: 12.424,
            height_mm: 12.7,
            balls_mm: vec![4.0, 6.0],
            depth_mm: 3.9,
            noise: 0.01,
            seed: 1,
            resolution: Resolution::Refined(FINER),
        }
    }

    /// B1 as the thesis identified it with both balls (Table 1): 19.05 mm thick.
    #[must_use]
    pub fn b1() -> Self {
        Self { name: "B1".to_owned(), mu_mpa: 0.188, alpha: 11.156, height_mm: 19.05, ..Self::eva() }
    }

    /// In a sentence.
    #[must_use]
    pub fn sentence(&self) -> String {
        let balls: Vec<String> = self.balls_mm.iter().map(|mm| number(*mm)).collect();
        format!(
            "simulated {}: mu {} MPa, alpha {}, {} mm thick, balls of {} mm to {} mm; noise {} % of the largest force, unknown contact points, seed {}",
            self.name,
            number(self.mu_mpa),
            number(self.alpha),
            number(self.height_mm),
            balls.join(" and "),
            number(self.depth_mm),
            number(100.0 * self.noise),
            self.seed
        )
    }

    /// Presses each ball in once.
    ///
    /// # Errors
    /// A parameter out of range, or a failing solve.
    pub fn experiment(&self) -> Result<Experiment, SolveError> {
        let ball = |mm: &f64| Indenter { name: format!("r{}", number(*mm)), radius_mm: Length::Known(*mm) };
        let mut experiment = Experiment {
            name: format!("simulated {}", self.name),
            folder: PathBuf::new(),
            specimens: vec![Specimen {
                name: self.name.clone(),
                material: self.name.clone(),
                base_law: BaseLaw::Hyperfoam,
                terms: 1,
                height_mm: Length::Known(self.height_mm),
                radius_mm: Length::Known(BLOCK_RADIUS_MM),
                base: Base::Bonded,
            }],
            indenters: self.balls_mm.iter().map(ball).collect(),
            sensor: Sensor::default(),
            runs: Vec::new(),
        };
        let mut chance = Pcg64::seed_from_u64(self.seed);
        let count = (self.depth_mm / STEP_MM + 1e-9).floor() as usize;
        let depths: Vec<f64> = (1..=count).map(|i| STEP_MM * i as f64).collect();
        for (indenter, &radius_mm) in self.balls_mm.iter().enumerate() {
            let problem = Indentation {
                law: Hyperfoam::one_term(self.mu_mpa, self.alpha)?,
                specimen: Block { height_mm: self.height_mm, radius_mm: BLOCK_RADIUS_MM, base: Support::Bonded },
                ball: Ball { radius_mm },
                depth_mm: self.depth_mm,
                resolution: self.resolution,
            };
            let forces = problem.solve_at(&depths)?.force_n;
            let recording = pressed(&forces, self.noise, &mut chance);
            experiment.runs.push(Run::indentation(format!("ball of {} mm", number(radius_mm)), 0, indenter, recording));
        }
        Ok(experiment)
    }
}

/// A recording of a press at 1 mm/s through `forces_n` at multiples of [`STEP_MM`] past the contact point, which is chance as the noise is:
/// its standard deviation is the share `noise` of the last force.
#[must_use]
pub fn pressed(forces_n: &[f64], noise: f64, chance: &mut Pcg64) -> Recording {
    let contact_mm = chance.random_range(CONTACT_MM.0..CONTACT_MM.1);
    let before = (contact_mm / STEP_MM) as usize;
    let peak = forces_n.last().copied().unwrap_or(0.0);
    let normal = Normal::new(0.0, noise * peak).ok();
    let count = before + forces_n.len();
    let time = (0..count).map(|i| i as f64 * STEP_MM).collect();
    // The first of the forces lies one step past contact.
    let depth = (0..count).map(|i| (i as f64 + 1.0 - before as f64) * STEP_MM + contact_mm).collect();
    let noisy = |i: usize| {
        let clean = i.checked_sub(before).map_or(0.0, |at| forces_n[at]);
        clean + normal.map_or(0.0, |normal| normal.sample(chance))
    };
    Recording::from_samples(time, depth, (0..count).map(noisy).collect())
}

/// Recordings of one material.
#[derive(Debug, Clone)]
pub struct Subject {
    /// The recordings.
    pub experiment: Experiment,
    /// Motion of every run.
    pub motions: Vec<Option<Motion>>,
    /// The material that is studied.
    pub material: String,
    /// The foam behind simulated recordings.
    pub foam: Option<Foam>,
}

impl Subject {
    /// A simulated foam.
    ///
    /// # Errors
    /// As [`Foam::experiment`].
    pub fn simulated(foam: Foam) -> Result<Self, StudyError> {
        let experiment = foam.experiment()?;
        let motions = motions(&experiment);
        Ok(Self { experiment, motions, material: foam.name.clone(), foam: Some(foam) })
    }

    /// One material of an experiment; the first without a name.
    ///
    /// # Errors
    /// When there is no such material, or none at all.
    pub fn measured(mut experiment: Experiment, material: Option<&str>) -> Result<Self, StudyError> {
        // The thesis' studies are of indentation.
        experiment.runs.retain(|run| run.test == Test::Indentation);
        let names = materials(&experiment);
        let material = match material {
            Some(wanted) if !names.iter().any(|name| name == wanted) => {
                return Err(StudyError::UnknownMaterial { wanted: wanted.to_owned(), known: names.join(", ") });
            }
            Some(wanted) => wanted.to_owned(),
            None => names.into_iter().next().ok_or(StudyError::NoMaterial)?,
        };
        let motions = motions(&experiment);
        Ok(Self { experiment, motions, material, foam: None })
    }

    /// Whose recordings these are, in a sentence.
    #[must_use]
    pub fn sentence(&self) -> String {
        match &self.foam {
            Some(foam) => foam.sentence(),
            None => format!("{}: {}", self.experiment.name, self.material),
        }
    }

    /// The loading curves that can be used.
    ///
    /// # Errors
    /// When there is none.
    pub fn selection(&self) -> Result<Selection, StudyError> {
        let selection = data::select(&self.experiment, &self.motions, &self.material, false);
        if selection.curves.iter().any(|curve| !curve.hold_out) {
            return Ok(selection);
        }
        let reason = match selection.left_out.first() {
            Some((_, data::LeftOut::NoContact)) => "force never rises above its noise",
            Some((_, data::LeftOut::TooDeep)) => "all samples lie deeper than the model reaches",
            _ => "too few samples on the way down",
        };
        Err(StudyError::NothingToFit { material: self.material.clone(), reason })
    }

    /// The same, for studies of mu and alpha; with `free_heights` a height may be unknown as well.
    ///
    /// # Errors
    /// When the specimens declare something else, or there is no curve.
    pub fn foam_selection(&self, study: &'static str, free_heights: bool) -> Result<Selection, StudyError> {
        let selection = self.selection()?;
        let law = |base| if base == BaseLaw::Ogden { "ogden" } else { "hyperfoam" };
        for pairing in &selection.pairings {
            let specimen = &self.experiment.specimens[pairing.specimen];
            let known = free_heights || matches!(pairing.height, Height::Known(_));
            if specimen.base_law != BaseLaw::Hyperfoam || specimen.terms != 1 || !known {
                let height = if known { "" } else { ", height unknown" };
                return Err(StudyError::NotOneTermFoam {
                    study,
                    material: self.material.clone(),
                    declared: format!("{}, {} term(s){height}", law(specimen.base_law), specimen.terms),
                });
            }
        }
        Ok(selection)
    }

    /// Balls of a selection: indices of the experiment's indenters, smallest ball first.
    #[must_use]
    pub fn balls(&self, selection: &Selection) -> Vec<usize> {
        let fitted = selection.curves.iter().filter(|curve| !curve.hold_out);
        let mut balls: Vec<(usize, f64)> = fitted
            .filter_map(|curve| {
                let grip = selection.pairings[curve.pairing].grip;
                grip.indenter().map(|indenter| (indenter, grip.ball_mm()))
            })
            .collect();
        balls.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
        balls.dedup_by_key(|(at, _)| *at);
        balls.into_iter().map(|(at, _)| at).collect()
    }

    /// "ball of 4 mm"; the name as well where two balls have one radius.
    #[must_use]
    pub fn ball_name(&self, indenter: usize) -> String {
        let all = &self.experiment.indenters;
        let Some(own) = all.get(indenter) else { return format!("ball {}", indenter + 1) };
        let Some(mm) = own.radius_mm.known() else { return own.name.clone() };
        let twins = all.iter().filter(|other| other.radius_mm.known() == Some(mm)).count();
        let name = if twins > 1 { format!(" ({})", own.name) } else { String::new() };
        format!("ball of {} mm{name}", number(mm))
    }
}

/// A selection with the curves of some balls only; pairings stay, so that one model serves all.
#[must_use]
pub fn of_balls(selection: &Selection, balls: &[usize]) -> Selection {
    let ball = |curve: &LoadingCurve| selection.pairings[curve.pairing].grip.indenter();
    let wanted = |curve: &&LoadingCurve| ball(curve).is_some_and(|ball| balls.contains(&ball));
    let curves = selection.curves.iter().filter(wanted).cloned().collect();
    Selection { curves, ..selection.clone() }
}
