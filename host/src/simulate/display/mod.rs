//! Experiments with a display that never happened: commands to the simulated surroundings of a board ([`crate::plant`]), whose flaws the
//! experiment does not declare.
//!
//! Shaft, sensor, winding, core, pulp and fluid are those of the plant; nothing here uses the laws that a diagnosis works with.
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

mod command;
mod description;
mod effect;
mod finger;
mod run;
mod spec;

use std::path::Path;

use super::folder::DESCRIPTION;
use crate::experiment::{Experiment, Run, Sensor, Test};
use crate::ownership::OwnFolder;

pub use command::{DisplayRun, Subject, TICK_S};
pub use description::{EXAMPLE, is_display, parse};
pub use effect::DisplayEffect;
pub use spec::{DisplayNoise, DisplaySpec};

impl DisplaySpec {
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
                let file = format!("{}-{}-{}.csv", one.subject.word(), command + 1, replicate + 1);
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
                    magnet: None,
                    load_n: None,
                    repeats: None,
                    place_mm: None,
                    troubles: Vec::new(),
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
    /// The operating system's, with the path, and a file in the way that `simulate` did not write: then nothing is written.
    pub fn write(&self, folder: &Path) -> std::io::Result<()> {
        let mut own = OwnFolder::open(folder, "--out", None)?;
        own.check(DESCRIPTION)?;
        let experiment = self.experiment_in(folder);
        let title = toml::Value::String(self.name.clone());
        let mut text = format!("name = {title}\n");
        experiment.runs.iter().try_for_each(|run| own.check(&run.file))?;
        for run in &experiment.runs {
            own.write(&run.file, csv(run).as_bytes())?;
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
        own.write(DESCRIPTION, text.as_bytes()).map(|_| ())
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
