//! What a simulation gives: an experiment in memory, and the folder of it.

use std::path::{Path, PathBuf};

use crate::experiment::{self, BaseLaw, Experiment, Indenter, Length, Recording, Run, Sensor, Specimen, Test};

use super::effect::Effect;
use super::spec::{Spec, TrueLaw};
use crate::ownership::OwnFolder;

/// Name of the description in a simulated folder.
pub(super) const DESCRIPTION: &str = "experiment.toml";

/// The folder has no description that `simulate` did not write; makes the folder.
///
/// # Errors
/// One that is somebody's is in the way, with its path and the option that helps.
pub fn check_folder(folder: &Path) -> std::io::Result<()> {
    OwnFolder::open(folder, "--out", None)?.check(DESCRIPTION)
}

/// One simulated run.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulatedRun {
    /// Name of its data file.
    pub file: String,
    /// What was done.
    pub test: Test,
    /// Index of the specimen.
    pub specimen: Option<usize>,
    /// Index of the ball.
    pub indenter: Option<usize>,
    /// Spot on the specimen, from 1.
    pub spot: Option<i64>,
    /// Where that is, mm from the middle of the specimen.
    pub place_mm: Option<[f64; 2]>,
    /// n-th time on this spot, from 1.
    pub cycle: Option<i64>,
    /// Place in the session, from 1.
    pub order: i64,
    /// Start on the session clock, s.
    pub start_s: f64,
    /// Never to be fitted.
    pub hold_out: bool,
    /// Load of a mass, N.
    pub load_n: Option<f64>,
    /// Time, s.
    pub time_s: Vec<f64>,
    /// Recorded depth, mm; empty for air and mass.
    pub depth_mm: Vec<f64>,
    /// Reading of the force, N.
    pub force_n: Vec<f64>,
    /// The same before noise, drift of chance and quantisation, N: never written.
    pub exact_n: Vec<f64>,
}

/// A simulated experiment, and what is true in it.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulatedExperiment {
    /// Title.
    pub name: String,
    /// Declared specimens, in the order of their names.
    pub specimens: Vec<Specimen>,
    /// Declared balls, in the order of their names.
    pub indenters: Vec<Indenter>,
    /// Declared sensor.
    pub sensor: Sensor,
    /// Runs in the order of the session.
    pub runs: Vec<SimulatedRun>,
    /// What it was made from.
    pub truth: Spec,
    /// Finite-element solves that this simulation had to make.
    pub solves: usize,
}

/// The declared specimens and balls, in the order of their names as a reader of the folder finds them.
pub(super) fn declared(spec: &Spec) -> (Vec<Specimen>, Vec<Indenter>) {
    let mut specimens: Vec<Specimen> = spec
        .specimens
        .iter()
        .map(|one| Specimen {
            name: one.name.clone(),
            material: "specimen".to_owned(),
            base_law: match one.law {
                TrueLaw::Hyperfoam => BaseLaw::Hyperfoam,
                TrueLaw::Ogden => BaseLaw::Ogden,
                TrueLaw::Rigid { .. } => BaseLaw::Rigid,
            },
            terms: if one.second.is_some() { 2 } else { 1 },
            height_mm: Length::Known(one.height_mm),
            radius_mm: Length::Known(one.radius_mm),
            base: one.base,
        })
        .collect();
    let ball =
        |one: &super::spec::TrueIndenter| Indenter { name: one.name.clone(), radius_mm: Length::Known(one.radius_mm) };
    let mut indenters: Vec<Indenter> = spec.indenters.iter().map(ball).collect();
    specimens.sort_by(|a, b| a.name.cmp(&b.name));
    indenters.sort_by(|a, b| a.name.cmp(&b.name));
    (specimens, indenters)
}

impl SimulatedExperiment {
    /// The experiment as [`experiment::read`] would give it from the written folder `folder`, without files.
    #[must_use]
    pub fn experiment_in(&self, folder: &Path) -> Experiment {
        let run = |one: &SimulatedRun| {
            let mut recording = Recording::default();
            recording.line = (2..one.time_s.len() + 2).collect();
            recording.time_s.clone_from(&one.time_s);
            recording.depth_mm.clone_from(&one.depth_mm);
            recording.force_n.clone_from(&one.force_n);
            Run {
                file: one.file.clone(),
                path: folder.join(&one.file),
                specimen: one.specimen,
                indenter: one.indenter,
                test: one.test,
                spot: one.spot,
                place_mm: one.place_mm,
                cycle: one.cycle,
                order: Some(one.order),
                start_s: Some(one.start_s),
                hold_out: one.hold_out,
                magnet: None,
                load_n: one.load_n,
                troubles: Vec::new(),
                repeats: None,
                recording,
            }
        };
        Experiment {
            name: self.name.clone(),
            folder: folder.to_owned(),
            specimens: self.specimens.clone(),
            indenters: self.indenters.clone(),
            sensor: self.sensor,
            runs: self.runs.iter().map(run).collect(),
        }
    }

    /// The experiment, in no folder.
    #[must_use]
    pub fn experiment(&self) -> Experiment {
        self.experiment_in(&PathBuf::new())
    }

    /// `experiment.toml`.
    #[must_use]
    pub fn description(&self) -> String {
        let mut text = format!("name = {}\n", quoted(&self.name));
        for one in &self.specimens {
            let law = match one.base_law {
                BaseLaw::Hyperfoam => "hyperfoam",
                BaseLaw::Ogden => "ogden",
                BaseLaw::Rigid => "rigid",
            };
            let base = if one.base == experiment::Base::Bonded { "bonded" } else { "sliding" };
            text.push_str(&format!(
                "\n[specimen.{}]\nbase_law = \"{law}\"\nterms = {}\nheight_mm = {:?}\nradius_mm = {:?}\nbase = \"{base}\"\n",
                quoted(&one.name),
                one.terms,
                one.height_mm.known().unwrap_or(0.0),
                one.radius_mm.known().unwrap_or(0.0),
            ));
        }
        for one in &self.indenters {
            let radius = one.radius_mm.known().unwrap_or(0.0);
            text.push_str(&format!("\n[indenter.{}]\nradius_mm = {radius:?}\n", quoted(&one.name)));
        }
        if let Some(noise) = self.sensor.noise_n {
            text.push_str(&format!("\n[sensor]\nnoise_N = {noise:?}\n"));
        }
        for run in &self.runs {
            text.push_str(&self.run_section(run));
        }
        text
    }

    fn run_section(&self, run: &SimulatedRun) -> String {
        let mut text = format!("\n[[run]]\nfile = {}\n", quoted(&run.file));
        if let Some(one) = run.specimen.and_then(|at| self.specimens.get(at)) {
            text.push_str(&format!("specimen = {}\n", quoted(&one.name)));
        }
        if let Some(one) = run.indenter.and_then(|at| self.indenters.get(at)) {
            text.push_str(&format!("indenter = {}\n", quoted(&one.name)));
        }
        match run.test {
            Test::Air => text.push_str("test = \"air\"\n"),
            Test::Mass => text.push_str("test = \"mass\"\n"),
            Test::Uniaxial => text.push_str("test = \"uniaxial\"\n"),
            Test::Confined => text.push_str("test = \"confined\"\n"),
            _ => {}
        }
        if let Some(spot) = run.spot {
            text.push_str(&format!("spot = {spot}\n"));
        }
        if let Some([x, y]) = run.place_mm {
            text.push_str(&format!("place_mm = [{x:?}, {y:?}]\n"));
        }
        for (key, value) in [("cycle", run.cycle), ("order", Some(run.order))] {
            if let Some(value) = value {
                text.push_str(&format!("{key} = {value}\n"));
            }
        }
        text.push_str(&format!("start_s = {:?}\n", run.start_s));
        if run.hold_out {
            text.push_str("hold_out = true\n");
        }
        if let Some(load_n) = run.load_n {
            text.push_str(&format!("load_N = {load_n:?}\n"));
        }
        text
    }

    /// Writes `experiment.toml`, one CSV a run and a list of them; the folder is made if need be. Nothing in it tells the
    /// truth.
    ///
    /// # Errors
    /// The operating system's, with the path, and a file in the way that `simulate` did not write: then nothing is written.
    pub fn write(&self, folder: &Path) -> std::io::Result<()> {
        let mut folder = OwnFolder::open(folder, "--out", None)?;
        folder.check(DESCRIPTION)?;
        self.runs.iter().try_for_each(|run| folder.check(&run.file))?;
        for run in &self.runs {
            folder.write(&run.file, run.csv().as_bytes())?;
        }
        folder.write(DESCRIPTION, self.description().as_bytes()).map(|_| ())
    }

    /// What is true and what chance added, as TOML: the effects as a specification writes them, and each specimen's law.
    #[must_use]
    pub fn truth_toml(&self) -> String {
        let spec = &self.truth;
        let mut text = format!("name = {}\nseed = {}\n", quoted(&spec.name), spec.seed);
        for one in &spec.specimens {
            text.push_str(&format!("\n[specimen.{}]\n", quoted(&one.name)));
            if let TrueLaw::Rigid { reduced_modulus_mpa } = one.law {
                text.push_str(&format!("reduced_modulus_MPa = {reduced_modulus_mpa:?}\n"));
            } else {
                text.push_str(&format!("mu_MPa = {:?}\nalpha = {:?}\nnu = {:?}\n", one.mu_mpa, one.alpha, one.nu));
            }
            if one.thermal_strain != 0.0 {
                text.push_str(&format!("thermal_strain = {:?}\n", one.thermal_strain));
            }
        }
        let n = &spec.noise;
        text.push_str(&format!(
            "\n[noise]\nsensor_N = {:?}\ncorrelation_s = {:?}\ncontact_jitter_mm = {:?}\ngain_jitter = {:?}\nmemory_jitter = {:?}\n\
             quantum_N = {:?}\ndrift_N_per_h = {:?}\nheavy_tails = {}\nproportional = {:?}\n",
            n.sensor_n, n.correlation_s, n.contact_jitter_mm, n.gain_jitter, n.memory_jitter, n.quantum_n, n.drift_n_per_h,
            n.heavy_tails, n.proportional,
        ));
        for effect in spec.effects.iter().map(Effect::to_toml) {
            text.push_str(&format!("\n{effect}"));
        }
        text
    }
}

impl SimulatedRun {
    /// The data file.
    #[must_use]
    pub fn csv(&self) -> String {
        let mut text = String::with_capacity(24 * self.time_s.len());
        if self.depth_mm.is_empty() {
            text.push_str("time_s,force_N\n");
            for (t, f) in self.time_s.iter().zip(&self.force_n) {
                text.push_str(&format!("{t},{f}\n"));
            }
            return text;
        }
        text.push_str("time_s,depth_mm,force_N\n");
        for ((t, d), f) in self.time_s.iter().zip(&self.depth_mm).zip(&self.force_n) {
            text.push_str(&format!("{t},{d},{f}\n"));
        }
        text
    }
}

/// A basic string of TOML, good for keys as well.
fn quoted(text: &str) -> String {
    let mut out = String::from("\"");
    for letter in text.chars() {
        match letter {
            '"' | '\\' => out.extend(['\\', letter]),
            control if control.is_control() => out.push_str(&format!("\\u{:04X}", u32::from(control))),
            plain => out.push(plain),
        }
    }
    out.push('"');
    out
}
