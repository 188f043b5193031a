//! Experiments with a display that never happened: commands to the simulated surroundings of a board ([`crate::plant`]), whose flaws the
//! experiment does not declare.
//!
//! Shaft, sensor, winding and core are those of the plant; nothing here uses the laws that a diagnosis works with.
//!
//! ```
//! use palpate::simulate::display::{DisplayEffect, DisplayRun, DisplaySpec, Subject};
//!
//! let mut spec = DisplaySpec::new("steps", 1);
//! spec.runs.push(DisplayRun::new(Subject::Position, vec![2.0, 8.0, 2.0], 1.0));
//! spec.effects.push(DisplayEffect::RateLimit { mm_per_s: 10.0 });
//! let experiment = spec.experiment();
//! assert_eq!(experiment.runs[0].recording.column("position_mm").map(<[f64]>::len), Some(151));
//! ```

mod description;
mod effect;
mod run;

use std::path::{Path, PathBuf};

use crate::experiment::{Experiment, Run, Sensor, Test};

pub use description::{EXAMPLE, is_display, parse};
pub use effect::DisplayEffect;

/// Period of the board's control and of the samples, s.
pub const TICK_S: f64 = 0.02;

/// What a run moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Subject {
    /// The linear actuator: commands in mm.
    Position,
    /// The force sensor on the cap: known loads in N.
    Force,
    /// Coil and magnet: commands in A.
    Coil,
}

/// A command: values that are held, with ramps between them, and how often it is given.
#[derive(Debug, Clone, PartialEq)]
pub struct DisplayRun {
    /// What is moved.
    pub subject: Subject,
    /// Values (mm, N or A), one after the other.
    pub values: Vec<f64>,
    /// Time at each value, s.
    pub hold_s: f64,
    /// Time from one value to the next, s; 0: a step.
    pub ramp_s: f64,
    /// How often the command is given.
    pub replicates: usize,
    /// Gap of the magnet as recorded, mm; a coil's run only.
    pub gap_mm: f64,
    /// Never to be fitted.
    pub hold_out: bool,
}

impl DisplayRun {
    /// Steps, given once.
    #[must_use]
    pub fn new(subject: Subject, values: Vec<f64>, hold_s: f64) -> Self {
        Self { subject, values, hold_s, ramp_s: 0.0, replicates: 1, gap_mm: 1.0, hold_out: false }
    }

    /// The same with ramps between the values.
    #[must_use]
    pub fn ramped(mut self, ramp_s: f64) -> Self {
        self.ramp_s = ramp_s;
        self
    }

    /// The same given several times.
    #[must_use]
    pub fn times(mut self, replicates: usize) -> Self {
        self.replicates = replicates;
        self
    }

    /// Length, s.
    #[must_use]
    pub fn length_s(&self) -> f64 {
        self.values.len() as f64 * self.hold_s + self.values.len().saturating_sub(1) as f64 * self.ramp_s
    }

    /// The command at a time, s.
    #[must_use]
    pub fn at(&self, time_s: f64) -> f64 {
        let period_s = self.hold_s + self.ramp_s;
        let last = self.values.len().saturating_sub(1);
        // a nanosecond puts a step that falls on a tick into it whatever the rounding
        let place = ((time_s + 1e-9) / period_s.max(1e-9)).max(0.0);
        let index = (place as usize).min(last);
        let (Some(own), next_s) = (self.values.get(index), (time_s + 1e-9) - index as f64 * period_s - self.hold_s)
        else {
            return 0.0;
        };
        match self.values.get(index + 1) {
            Some(next) if next_s > 0.0 && self.ramp_s > 0.0 => own + (next - own) * (next_s / self.ramp_s).min(1.0),
            _ => *own,
        }
    }
}

/// What chance adds beyond the converter's own noise, as standard deviations; the part that is told is correlated over `correlation_s`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DisplayNoise {
    /// Of the measured position, mm.
    pub position_mm: f64,
    /// Of the force, fraction of the force.
    pub force_share: f64,
    /// Of the current, A.
    pub current_a: f64,
    /// Of the flux density, T.
    pub flux_t: f64,
    /// Correlation time, s.
    pub correlation_s: f64,
    /// Of the gain from run to run: force; position, current and flux scatter by a tenth of it.
    pub gain_jitter: f64,
    /// Student's t with three degrees of freedom instead of a normal distribution.
    pub heavy_tails: bool,
}

impl Default for DisplayNoise {
    fn default() -> Self {
        Self {
            position_mm: 0.02,
            force_share: 0.005,
            current_a: 0.004,
            flux_t: 1e-4,
            correlation_s: 0.1,
            gain_jitter: 0.015,
            heavy_tails: false,
        }
    }
}

/// What is done to a display, and by what it differs from what its simulation takes for granted.
#[derive(Debug, Clone, PartialEq)]
pub struct DisplaySpec {
    /// Title.
    pub name: String,
    /// Seed of everything random.
    pub seed: u64,
    /// Commands.
    pub runs: Vec<DisplayRun>,
    /// Chance.
    pub noise: DisplayNoise,
    /// Flaws.
    pub effects: Vec<DisplayEffect>,
}

impl DisplaySpec {
    /// Nothing done yet, no flaw.
    #[must_use]
    pub fn new(name: &str, seed: u64) -> Self {
        Self { name: name.to_owned(), seed, runs: Vec::new(), noise: DisplayNoise::default(), effects: Vec::new() }
    }

    /// The experiment, in no folder.
    #[must_use]
    pub fn experiment(&self) -> Experiment {
        self.experiment_in(Path::new(""))
    }

    /// The experiment as it is read from the written folder. The same specification gives the same numbers.
    #[must_use]
    pub fn experiment_in(&self, folder: &Path) -> Experiment {
        let mut runs = Vec::new();
        let mut start_s = 0.0;
        for (command, one) in self.runs.iter().enumerate() {
            for replicate in 0..one.replicates {
                let number = runs.len() as u64;
                let subject = match one.subject {
                    Subject::Position => "position",
                    Subject::Force => "force",
                    Subject::Coil => "coil",
                };
                let file = format!("{subject}-{}-{}.csv", command + 1, replicate + 1);
                runs.push(Run {
                    path: folder.join(&file),
                    file,
                    specimen: None,
                    indenter: None,
                    test: Test::Display,
                    spot: None,
                    cycle: None,
                    order: i64::try_from(runs.len() + 1).ok(),
                    start_s: Some(start_s),
                    hold_out: one.hold_out,
                    load_n: None,
                    place_mm: None,
                    recording: run::recorded(self, one, number),
                });
                start_s += one.length_s() + 600.0;
            }
        }
        Experiment {
            name: self.name.clone(),
            folder: folder.to_owned(),
            specimens: Vec::new(),
            indenters: Vec::new(),
            sensor: Sensor::default(),
            runs,
        }
    }

    /// Writes `experiment.toml` and one CSV a run; nothing in them tells the flaws.
    ///
    /// # Errors
    /// The operating system's, with the path.
    pub fn write(&self, folder: &Path) -> std::io::Result<()> {
        let named = |path: &Path, cause: std::io::Error| {
            std::io::Error::new(cause.kind(), format!("cannot write {}: {cause}", path.display()))
        };
        std::fs::create_dir_all(folder).map_err(|cause| named(folder, cause))?;
        let experiment = self.experiment_in(folder);
        let title = toml::Value::String(self.name.clone());
        let mut text = format!("name = {title}\n");
        for run in &experiment.runs {
            std::fs::write(&run.path, csv(run)).map_err(|cause| named(&run.path, cause))?;
            text.push_str(&format!("\n[[run]]\nfile = \"{}\"\ntest = \"display\"\n", run.file));
            for (key, value) in
                [("order", run.order.map(|n| n.to_string())), ("start_s", run.start_s.map(|s| format!("{s:?}")))]
            {
                if let Some(value) = value {
                    text.push_str(&format!("{key} = {value}\n"));
                }
            }
            if run.hold_out {
                text.push_str("hold_out = true\n");
            }
        }
        let path = PathBuf::from(folder).join("experiment.toml");
        std::fs::write(&path, text).map_err(|cause| named(&path, cause))
    }
}

/// A run's data file.
fn csv(run: &Run) -> String {
    let recording = &run.recording;
    let mut columns: Vec<(&str, &[f64])> = vec![("time_s", &recording.time_s)];
    if !recording.force_n.is_empty() {
        columns.push(("force_N", &recording.force_n));
    }
    columns.extend(recording.others.iter().map(|(name, values)| (name.as_str(), values.as_slice())));
    let mut text = columns.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(",");
    text.push('\n');
    for k in 0..recording.time_s.len() {
        let row: Vec<String> = columns.iter().map(|(_, values)| values[k].to_string()).collect();
        text.push_str(&row.join(","));
        text.push('\n');
    }
    text
}
