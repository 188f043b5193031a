//! The extended model of a magnet: its file with the parameters that a diagnosis found to differ.
//!
//! The diagnosis finds a part to first order; the model holds the parameter itself, so that a prediction solves the
//! changed magnet anew. [`MagnetModel::gain`] does so at the currents of other recordings.

mod readings;

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use nalgebra::{DMatrix, DVector};
use serde_json::{Value, json};

use super::file::needed;
use super::writing::{text, twins};
use crate::diagnose::table::effect::CATALOGUE;
use crate::diagnose::table::{Diagnosis, Estimate};
use crate::experiment::section::{Document, Section};
use crate::experiment::{Experiment, ExperimentError, Test};
use crate::infer::covariance::Z95;
use crate::magnet::uncertain::PARTS;
use crate::magnet::{Magnet, located, parse};
pub use readings::GainError;
use readings::{Readings, least_squares};

/// A parameter that differs from the magnet's file.
#[derive(Debug, Clone, PartialEq)]
pub struct Changed {
    /// Its name in the file.
    pub parameter: String,
    /// Code of the effect that it stands for.
    pub code: String,
    /// Its value, and its 95 % interval.
    pub value: f64,
    /// The interval.
    pub interval: (f64, f64),
    /// Codes of other effects that the diagnosis could not tell from it.
    pub ambiguous_with: Vec<String>,
}

/// A magnet with parameters that differ, and a sensor whose zero does.
#[derive(Debug, Clone, PartialEq)]
pub struct MagnetModel {
    /// Name or file of the magnet, as the experiment has it.
    pub magnet: String,
    /// What the sensor reads without a field, T.
    pub zero_t: f64,
    /// What differs.
    pub changed: Vec<Changed>,
}

/// Readings of one table, predicted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gain {
    /// Root mean square error of the magnet as drawn, with a zero fitted to these very readings, T.
    pub fitted_base_t: f64,
    /// Of the model as it is, T.
    pub model_t: f64,
    /// Readings that were compared.
    pub readings: usize,
}

const KEYS: [&str; 3] = ["magnet", "zero_T", "changed"];

impl MagnetModel {
    /// Of a diagnosis that named parts of a magnet and nothing else; none otherwise, for what is no part of the magnet has no
    /// place in its file.
    #[must_use]
    pub fn of(experiment: &Experiment, found: &Diagnosis) -> Option<Self> {
        let run = experiment.runs.iter().find(|run| run.test == Test::Table)?;
        let (name, unit) = run.magnet.clone()?;
        let (file, own) = located(&experiment.folder.join(&name), &name).ok()??;
        let magnet = parse(&file, &own, &BTreeMap::new()).ok()?;
        let best = found.evidence.as_ref()?.held.first()?;
        if found.findings.is_empty() {
            return None;
        }
        let changed = best.fit.effects.iter().enumerate().map(|(at, effect)| {
            let finding = found.findings.iter().find(|finding| finding.effect.code == effect.code);
            let twins = finding.map_or(&[][..], |finding| &finding.ambiguous_with);
            let part = PARTS.iter().position(|part| *part == effect.code && effect.form == "magnet")?;
            changed(&magnet, part, best.told(Some(at)).first()?, twins)
        });
        let zero = best.told(None).first().map_or(0.0, |(_, zero, _)| zero / unit);
        Some(Self { magnet: name, zero_t: zero, changed: changed.collect::<Option<_>>()? })
    }

    /// True for the text of a model of a magnet.
    #[must_use]
    pub fn is_one(text: &str) -> bool {
        text.parse::<toml::Table>().is_ok_and(|table| table.contains_key("magnet") && table.contains_key("changed"))
    }

    /// The text of the file.
    #[must_use]
    pub fn to_toml(&self) -> String {
        let mut out = String::from(
            "# A magnet, and what a diagnosis found to differ from its file. `palpate magnet` computes it with the same --set.\n",
        );
        let _ = writeln!(out, "magnet = {}\nzero_T = {:?}", text(&self.magnet), self.zero_t);
        for one in &self.changed {
            let _ = writeln!(out, "\n[[changed]]\nparameter = {}\ncode = {}", text(&one.parameter), text(&one.code));
            let (low, high) = one.interval;
            let _ = writeln!(out, "value = {:?}\ninterval95 = [{low:?}, {high:?}]", one.value);
            out.push_str(&twins(&one.ambiguous_with));
        }
        out
    }

    /// Reads a model file that is already in memory; `file` is where it would be.
    ///
    /// # Errors
    /// The first mistake, with file, line and column.
    pub fn parse(file: &Path, text: &str) -> Result<Self, ExperimentError> {
        let document = Document { file, text };
        let root = document.table()?;
        let root = Section::new(document, "the file".to_owned(), 0..0, root.get_ref());
        root.only(&KEYS)?;
        let expected = "a magnet.toml, or the name of a magnet that comes with the program";
        let magnet = needed(&root, "magnet", expected, root.text("magnet", expected)?)?.to_owned();
        let expected = "what the sensor reads without a field, T";
        let zero_t = root.number("zero_T", -10.0..=10.0, expected)?.unwrap_or(0.0);
        let changed = root.array("changed")?.iter().map(read).collect::<Result<_, _>>()?;
        Ok(Self { magnet, zero_t, changed })
    }

    /// The same with parameters and zero fitted by the field itself where the diagnosis had them to first order; intervals are
    /// those of readings that scatter by what is left.
    ///
    /// # Errors
    /// [`GainError`].
    pub fn fitted(mut self, experiment: &Experiment) -> Result<Self, GainError> {
        let readings = Readings::of(experiment)?;
        let count = self.changed.len();
        for _ in 0..ROUNDS {
            let values: Vec<f64> = self.changed.iter().map(|one| one.value).collect();
            let left = readings.left(experiment, &self.magnet, &self.set())?;
            let mut jacobian = DMatrix::from_element(left.len(), count + 1, 1.0);
            for (k, one) in self.changed.iter().enumerate() {
                let step = NUDGE * (one.interval.1 - one.interval.0).abs().max(1e-6 * values[k].abs());
                let mut set = self.set();
                set.insert(one.parameter.clone(), values[k] + step);
                let moved = readings.left(experiment, &self.magnet, &set)?;
                jacobian.set_column(
                    k,
                    &DVector::from_iterator(left.len(), left.iter().zip(&moved).map(|(a, b)| (a - b) / step)),
                );
            }
            let Some((change, deviations)) = least_squares(&jacobian, &DVector::from_vec(left)) else { break };
            self.zero_t = change[count];
            let mut settled = true;
            for (k, one) in self.changed.iter_mut().enumerate() {
                // no farther at once than so many intervals: a first order holds near by
                let width = (one.interval.1 - one.interval.0).abs();
                let change = change[k].clamp(-FAR * width, FAR * width);
                settled &= change.abs() < SETTLED * width;
                one.value += change;
                one.interval = (one.value - Z95 * deviations[k], one.value + Z95 * deviations[k]);
            }
            if settled {
                break;
            }
        }
        Ok(self)
    }

    /// Parameters that take the place of the file's.
    fn set(&self) -> BTreeMap<String, f64> {
        self.changed.iter().map(|one| (one.parameter.clone(), one.value)).collect()
    }

    /// What it gains on the tables of an experiment: the magnet as drawn beside the changed one, both by finite elements at
    /// the currents that were read.
    ///
    /// # Errors
    /// [`GainError`].
    pub fn gain(&self, experiment: &Experiment) -> Result<Gain, GainError> {
        let readings = Readings::of(experiment)?;
        let drawn = readings.left(experiment, &self.magnet, &BTreeMap::new())?;
        let changed = readings.left(experiment, &self.magnet, &self.set())?;
        let zero = drawn.iter().sum::<f64>() / drawn.len() as f64;
        let rms =
            |left: &[f64], zero: f64| (left.iter().map(|v| (v - zero).powi(2)).sum::<f64>() / left.len() as f64).sqrt();
        Ok(Gain { fitted_base_t: rms(&drawn, zero), model_t: rms(&changed, self.zero_t), readings: drawn.len() })
    }
}

/// Most rounds of a fit by the field itself.
const ROUNDS: usize = 4;
/// Step of a derivative, as a part of the interval's width.
const NUDGE: f64 = 0.1;
/// Change that ends a fit, and the most of a round, the same.
const SETTLED: f64 = 0.02;
const FAR: f64 = 4.0;

impl Gain {
    /// As JSON.
    #[must_use]
    pub fn json(&self) -> Value {
        json!({ "readings": self.readings, "rmse_T_fitted_base": self.fitted_base_t, "rmse_T_model": self.model_t })
    }
}

/// The parameter of a part that differs by so many times of what is plausible.
fn changed(magnet: &Magnet, part: usize, (_, times, interval): &Estimate, twins: &[&str]) -> Option<Changed> {
    let own = magnet.uncertain.iter().find(|own| own.part == part)?;
    let nominal = magnet.parameters.0.get(&own.parameter)?;
    let at = |times: f64| nominal + times * own.by;
    Some(Changed {
        parameter: own.parameter.clone(),
        code: PARTS[part].to_owned(),
        value: at(*times),
        interval: (at(interval.0), at(interval.1)),
        ambiguous_with: twins.iter().map(|code| (*code).to_owned()).collect(),
    })
}

fn read(section: &Section<'_>) -> Result<Changed, ExperimentError> {
    section.only(&["parameter", "code", "value", "interval95", "ambiguous_with"])?;
    let expected = "the name of a parameter of the magnet's file";
    let parameter = needed(section, "parameter", expected, section.text("parameter", expected)?)?.to_owned();
    let expected = "the code of a part of a magnet";
    let codes: Vec<(&str, &str)> = PARTS.into_iter().map(|part| (part, part)).collect();
    let code = needed(section, "code", expected, section.word("code", &codes)?)?.to_owned();
    let number = |key: &str| section.number(key, -1e9..=1e9, "a number");
    let value = needed(section, "value", "a number", number("value")?)?;
    let bounds = section.numbers("interval95", "[low, high]")?;
    let interval = match bounds.as_deref() {
        Some([low, high]) => (*low, *high),
        _ => return Err(section.missing("interval95", "[low, high]")),
    };
    let known: Vec<&str> = CATALOGUE.iter().map(|effect| effect.code).collect();
    let ambiguous_with = super::file::twins(section, &known)?;
    Ok(Changed { parameter, code, value, interval, ambiguous_with })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn model() -> MagnetModel {
        let changed = Changed {
            parameter: "gap".to_owned(),
            code: "gap".to_owned(),
            value: 11.0,
            interval: (10.6, 11.4),
            ambiguous_with: vec!["sensor-gain".to_owned()],
        };
        MagnetModel { magnet: "ring-probe".to_owned(), zero_t: -1e-3, changed: vec![changed] }
    }

    #[test]
    fn a_model_is_read_as_it_was_written() {
        let text = model().to_toml();
        assert!(MagnetModel::is_one(&text));
        assert_eq!(MagnetModel::parse(Path::new("model.toml"), &text).unwrap(), model());
        let wrong = text.replace("code = \"gap\"", "code = \"gab\"");
        let told = MagnetModel::parse(Path::new("model.toml"), &wrong).unwrap_err().to_string();
        assert!(told.contains("model.toml, line") && told.contains("gab"), "{told}");
    }
}
