//! The extended model as a file, `model.toml`: the base of a material with the effects that were named.

use std::fmt::Write as _;

use lut_gen::chain::{Model, Setting};
use lut_gen::effect::{self, Owner};

use crate::experiment::Experiment;

/// What is wrong with a model file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ModelFileError {
    /// It is not TOML.
    #[error("not TOML: {0}")]
    Syntax(String),
    /// A key is missing.
    #[error("`{key}` is missing in {place}: expected {expected}")]
    Missing {
        /// The key.
        key: String,
        /// Where.
        place: String,
        /// What belongs there.
        expected: String,
    },
    /// A key is not known.
    #[error("unknown key `{key}` in {place}: expected one of {expected}")]
    Unknown {
        /// The key.
        key: String,
        /// Where.
        place: String,
        /// What may be there.
        expected: String,
    },
    /// A value is out of range or of another kind.
    #[error("`{key}` in {place} is {found}: expected {expected}")]
    Bad {
        /// The key.
        key: String,
        /// Where.
        place: String,
        /// The value.
        found: String,
        /// What was expected.
        expected: String,
    },
}

/// The text of a model file. Balls and specimens are named as the experiment names them.
#[must_use]
pub fn text(experiment: &Experiment, material: &str, model: &Model) -> String {
    let mut out =
        String::from("# The base of a material and the effects that a diagnosis found. Units: mm, N, MPa, s.\n");
    let _ = writeln!(out, "material = {}", toml::Value::from(material));
    let _ = writeln!(out, "law = \"hyperfoam\"\nmu_MPa = {:?}\nalpha = {:?}", model.mu_mpa, model.alpha);
    for setting in &model.settings {
        let effect = setting.effect;
        let _ = writeln!(out, "\n[[effect]]\ncode = \"{}\"\nform = \"{}\"", effect.code, effect.form);
        let owner = match effect.owner {
            Owner::All => None,
            Owner::Indenter => experiment.indenters.get(setting.owner).map(|i| ("indenter", &i.name)),
            Owner::Specimen => experiment.specimens.get(setting.owner).map(|s| ("specimen", &s.name)),
        };
        if let Some((key, name)) = owner {
            let _ = writeln!(out, "{key} = {}", toml::Value::from(name.as_str()));
        }
        for (quantity, value) in effect.quantities.iter().zip(&setting.values) {
            let _ = writeln!(out, "{} = {value:?}", quantity.name);
        }
    }
    out
}

/// Reads a model file for an experiment whose balls and specimens it names.
///
/// # Errors
/// The first mistake, with the key, the place, and what was expected.
pub fn parse(experiment: &Experiment, text: &str) -> Result<Model, ModelFileError> {
    let table: toml::Table =
        text.parse().map_err(|e: toml::de::Error| ModelFileError::Syntax(e.message().to_owned()))?;
    let top = "the file";
    only(&table, top, &["material", "law", "mu_MPa", "alpha", "effect"])?;
    let law = word(&table, "law", top, "\"hyperfoam\"")?;
    if law != "hyperfoam" {
        return Err(bad("law", top, &law, "\"hyperfoam\""));
    }
    let mut model = Model::base(
        number(&table, "mu_MPa", top, (f64::MIN_POSITIVE, 1e4))?,
        number(&table, "alpha", top, (1.0, 30.0))?,
    );
    let none = Vec::new();
    let effects = match table.get("effect") {
        None => &none,
        Some(toml::Value::Array(list)) => list,
        Some(other) => return Err(bad("effect", top, &other.to_string(), "[[effect]] tables")),
    };
    for (at, value) in effects.iter().enumerate() {
        let place = format!("[[effect]] {}", at + 1);
        let toml::Value::Table(own) = value else {
            return Err(bad("effect", &place, &value.to_string(), "a table"));
        };
        model.settings.push(setting(experiment, own, &place)?);
    }
    Ok(model)
}

fn setting(experiment: &Experiment, table: &toml::Table, place: &str) -> Result<Setting, ModelFileError> {
    let codes = || effect::CATALOGUE.iter().map(|e| format!("{} ({})", e.code, e.form)).collect::<Vec<_>>().join(", ");
    let code = word(table, "code", place, "the code of an effect")?;
    let form = if table.contains_key("form") { Some(word(table, "form", place, "a form")?) } else { None };
    let effect = effect::find(&code, form.as_deref()).ok_or_else(|| {
        let found = form.as_ref().map_or_else(|| code.clone(), |form| format!("{code} ({form})"));
        bad("code", place, &found, &codes())
    })?;
    let mut known = vec!["code", "form"];
    known.extend(effect.quantities.iter().map(|q| q.name));
    let owner = match effect.owner {
        Owner::All => 0,
        Owner::Indenter => {
            known.push("indenter");
            owner(table, "indenter", place, experiment.indenters.iter().map(|i| i.name.as_str()))?
        }
        Owner::Specimen => {
            known.push("specimen");
            owner(table, "specimen", place, experiment.specimens.iter().map(|s| s.name.as_str()))?
        }
    };
    only(table, place, &known)?;
    let values =
        effect.quantities.iter().map(|q| number(table, q.name, place, (q.low, q.high))).collect::<Result<_, _>>()?;
    Ok(Setting { effect, owner, values })
}

fn owner<'a>(
    table: &toml::Table,
    key: &str,
    place: &str,
    names: impl Iterator<Item = &'a str>,
) -> Result<usize, ModelFileError> {
    let names: Vec<&str> = names.collect();
    let wanted = word(table, key, place, &names.join(", "))?;
    names.iter().position(|name| *name == wanted).ok_or_else(|| bad(key, place, &wanted, &names.join(", ")))
}

fn only(table: &toml::Table, place: &str, known: &[&str]) -> Result<(), ModelFileError> {
    match table.keys().find(|key| !known.contains(&key.as_str())) {
        Some(key) => {
            Err(ModelFileError::Unknown { key: key.clone(), place: place.to_owned(), expected: known.join(", ") })
        }
        None => Ok(()),
    }
}

fn missing(key: &str, place: &str, expected: &str) -> ModelFileError {
    ModelFileError::Missing { key: key.to_owned(), place: place.to_owned(), expected: expected.to_owned() }
}

fn bad(key: &str, place: &str, found: &str, expected: &str) -> ModelFileError {
    let (key, place) = (key.to_owned(), place.to_owned());
    ModelFileError::Bad { key, place, found: found.to_owned(), expected: expected.to_owned() }
}

fn word(table: &toml::Table, key: &str, place: &str, expected: &str) -> Result<String, ModelFileError> {
    match table.get(key) {
        Some(toml::Value::String(word)) => Ok(word.clone()),
        Some(other) => Err(bad(key, place, &other.to_string(), expected)),
        None => Err(missing(key, place, expected)),
    }
}

fn number(table: &toml::Table, key: &str, place: &str, (low, high): (f64, f64)) -> Result<f64, ModelFileError> {
    let expected = format!("a number from {low} to {high}");
    let value = match table.get(key) {
        Some(toml::Value::Float(value)) => *value,
        Some(toml::Value::Integer(value)) => *value as f64,
        Some(other) => return Err(bad(key, place, &other.to_string(), &expected)),
        None => return Err(missing(key, place, &expected)),
    };
    if (low..=high).contains(&value) { Ok(value) } else { Err(bad(key, place, &value.to_string(), &expected)) }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;
    use crate::experiment::{BaseLaw, Indenter, Length, Sensor, Specimen};

    fn experiment() -> Experiment {
        Experiment {
            name: String::new(),
            folder: std::path::PathBuf::new(),
            specimens: vec![Specimen {
                name: "thin".to_owned(),
                material: "foam".to_owned(),
                base_law: BaseLaw::Hyperfoam,
                terms: 1,
                height_mm: Length::Known(12.7),
                radius_mm: Length::Known(25.0),
                base: crate::experiment::Base::Bonded,
            }],
            indenters: vec![Indenter { name: "r4".to_owned(), radius_mm: Length::Known(4.0) }],
            sensor: Sensor::default(),
            runs: Vec::new(),
        }
    }

    /// Every effect of the catalogue at once is written and read back to the bit.
    #[test]
    fn what_is_written_is_read_back() {
        let mut model = Model::base(0.123_456_789_012_345, 9.87);
        for effect in effect::CATALOGUE {
            let values = effect.quantities.iter().map(|q| q.plausible / 3.0 + 2.0 * q.null / 3.0).collect();
            model.settings.push(Setting { effect, owner: 0, values });
        }
        let text = text(&experiment(), "foam", &model);
        assert_eq!(parse(&experiment(), &text).unwrap(), model, "{text}");
    }

    #[test]
    fn mistakes_are_named() {
        let said = |text: &str| parse(&experiment(), text).unwrap_err().to_string();
        let head = "law = \"hyperfoam\"\nmu_MPa = 0.1\nalpha = 8\n";
        assert_eq!(
            said("law = \"hyperfoam\"\nalpha = 8"),
            "`mu_MPa` is missing in the file: expected a number from 2.2250738585072014e-308 to 10000"
                .replace("2.2250738585072014e-308", &f64::MIN_POSITIVE.to_string())
        );
        assert_eq!(
            said(&format!("{head}[[effect]]\ncode = \"relaxation\"\ng1 = 2.0\ntau1_s = 1.0")),
            "`g1` in [[effect]] 1 is 2: expected a number from 0 to 0.9"
        );
        assert_eq!(
            said(&format!("{head}[[effect]]\ncode = \"radius\"\nindenter = \"r5\"\nerror_mm = 0.1")),
            "`indenter` in [[effect]] 1 is r5: expected r4"
        );
        assert_eq!(
            said(&format!("{head}[[effect]]\ncode = \"drift\"\nN_per_h = 0.1\nper_day = 3")),
            "unknown key `per_day` in [[effect]] 1: expected one of code, form, N_per_h"
        );
        assert!(
            said(&format!("{head}[[effect]]\ncode = \"magic\""))
                .starts_with("`code` in [[effect]] 1 is magic: expected thickness (height)")
        );
        assert!(said("law = ").starts_with("not TOML"));
    }
}
