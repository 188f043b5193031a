//! Reading the model file, every mistake with its place.

use std::path::Path;

use lut_gen::effect::{CATALOGUE, Effect, Owner};
use toml::Spanned;
use toml::de::DeValue;

use crate::experiment::section::{Document, Section};
use crate::experiment::{Base, ExperimentError, Problem};

use super::{Added, DeclaredBall, DeclaredSpecimen, ExtendedModel};

const MU: &str = "a shear modulus of 0.000001 to 10000 MPa";
const ALPHA: &str = "an exponent of 1 to 30";
const LENGTH: &str = "a length of 0.05 to 1000 mm";
const PAIR: &str = "two numbers, the lower first";

impl ExtendedModel {
    /// Reads a model file that is already in memory; `file` is where it would be.
    ///
    /// # Errors
    /// The first mistake, with file, line and column, the key, its value and what was expected.
    pub fn parse(file: &Path, text: &str) -> Result<Self, ExperimentError> {
        let document = Document { file, text };
        let root = document.table()?;
        let root = Section::new(document, "the file".to_owned(), 0..0, root.get_ref());
        root.only(&["material", "law", "mu_MPa", "alpha", "interval95", "indenter", "specimen", "effect"])?;
        let name = "a name in quotes";
        let material = needed(&root, "material", name, root.text("material", name)?)?;
        root.word("law", &[("hyperfoam", ())])?.ok_or_else(|| root.missing("law", "\"hyperfoam\""))?;
        let mu_mpa = needed(&root, "mu_MPa", MU, root.number("mu_MPa", 1e-6..=1e4, MU)?)?;
        let alpha = needed(&root, "alpha", ALPHA, root.number("alpha", 1.0..=30.0, ALPHA)?)?;
        let mut model = Self::base(material, mu_mpa, alpha);
        let found = intervals(&root, &["mu_MPa", "alpha"])?;
        model.intervals = [found[0], found[1]];
        for (name, section) in root.named("indenter")? {
            section.only(&["radius_mm"])?;
            let radius = section.number("radius_mm", 0.05..=1000.0, LENGTH)?;
            model.indenters.push(DeclaredBall { name, radius_mm: needed(&section, "radius_mm", LENGTH, radius)? });
        }
        for (name, section) in root.named("specimen")? {
            model.specimens.push(specimen(name, &section)?);
        }
        for section in root.array("effect")? {
            let added = added(&section, &model)?;
            let same = |other: &Added| other.effect.code == added.effect.code && other.owner == added.owner;
            // two forms of one effect on one owner are two answers to one question; a base and a height are not
            let twice = model
                .effects
                .iter()
                .any(|other| same(other) && (other.effect == added.effect || added.effect.code != "thickness"));
            if twice {
                let text = format!("[[effect]] {} is there twice; expected each effect once", added.effect.code);
                return Err(document.error(section.span.clone(), Problem::Contradiction(text)));
            }
            model.effects.push(added);
        }
        Ok(model)
    }
}

pub(super) fn needed<T>(
    section: &Section<'_>,
    key: &str,
    expected: &str,
    found: Option<T>,
) -> Result<T, ExperimentError> {
    found.ok_or_else(|| section.missing(key, expected))
}

fn specimen(name: String, section: &Section<'_>) -> Result<DeclaredSpecimen, ExperimentError> {
    section.only(&["height_mm", "radius_mm", "base"])?;
    let height = section.number("height_mm", 0.05..=1000.0, LENGTH)?;
    let bases = [("bonded", Base::Bonded), ("sliding", Base::Sliding)];
    Ok(DeclaredSpecimen {
        name,
        height_mm: needed(section, "height_mm", LENGTH, height)?,
        radius_mm: section.number("radius_mm", 0.05..=1000.0, LENGTH)?,
        base: section.word("base", &bases)?.unwrap_or(Base::Bonded),
    })
}

/// `interval95 = { g1 = [0.2, 0.4] }`; one entry a name, none where nothing is written.
pub(super) fn intervals(section: &Section<'_>, names: &[&str]) -> Result<Vec<Option<(f64, f64)>>, ExperimentError> {
    let Some(own) = section.section("interval95", format!("interval95 of {}", section.name))? else {
        return Ok(vec![None; names.len()]);
    };
    own.only(names)?;
    let one = |name: &&str| match own.numbers(name, PAIR)?.as_deref() {
        None => Ok(None),
        Some(&[low, high]) if low <= high => Ok(Some((low, high))),
        Some(_) => Err(own.value(name).map_or_else(|| own.missing(name, PAIR), |value| own.bad(name, value, PAIR))),
    };
    names.iter().map(one).collect()
}

/// Code and form of an effect.
fn catalogued(section: &Section<'_>) -> Result<&'static Effect, ExperimentError> {
    let mut codes: Vec<(&str, &str)> = CATALOGUE.iter().map(|e| (e.code, e.code)).collect();
    codes.dedup();
    let code = needed(section, "code", "the code of an effect", section.word("code", &codes)?)?;
    let forms: Vec<(&str, &'static Effect)> =
        CATALOGUE.into_iter().filter(|e| e.code == code).map(|e| (e.form, e)).collect();
    let form = section.word("form", &forms)?;
    let effect = form.or_else(|| forms.first().map(|f| f.1));
    let effect = needed(section, "form", "a form of the effect", effect)?;
    section.word("stage", &[(effect.stage.word(), ())])?;
    Ok(effect)
}

fn added(section: &Section<'_>, model: &ExtendedModel) -> Result<Added, ExperimentError> {
    let effect = catalogued(section)?;
    let mut known = vec!["code", "form", "stage", "interval95", "ambiguous_with"];
    let names: Vec<&str> = effect.quantities.iter().map(|q| q.name).collect();
    known.extend(&names);
    let owner = match effect.owner {
        Owner::All => None,
        Owner::Indenter => {
            known.push("indenter");
            Some(owner(section, "indenter", model.indenters.iter().map(|i| &i.name))?)
        }
        Owner::Specimen => {
            known.push("specimen");
            Some(owner(section, "specimen", model.specimens.iter().map(|s| &s.name))?)
        }
    };
    section.only(&known)?;
    let mut values = Vec::new();
    for q in effect.quantities {
        let expected = format!("a number from {} to {}", q.low, q.high);
        values.push(needed(section, q.name, &expected, section.number(q.name, q.low..=q.high, &expected)?)?);
    }
    // parts that relax: what is left must be positive
    let relaxing: f64 = values.iter().step_by(2).sum();
    if effect.code == "relaxation" && relaxing >= 1.0 {
        let text = format!("g1 and g2 of relaxation sum to {relaxing}; expected less than 1");
        return Err(section.document.error(section.span.clone(), Problem::Contradiction(text)));
    }
    let intervals = intervals(section, &names)?;
    let ambiguous_with = twins(section, &CATALOGUE.map(|effect| effect.code))?;
    Ok(Added { effect, owner, values, intervals, ambiguous_with })
}

fn owner<'a>(
    section: &Section<'_>,
    key: &str,
    names: impl Iterator<Item = &'a String>,
) -> Result<String, ExperimentError> {
    let expected = "a name in quotes";
    let name = needed(section, key, expected, section.text(key, expected)?)?;
    let known: Vec<String> = names.cloned().collect();
    if known.iter().any(|one| one == name) {
        return Ok(name.to_owned());
    }
    let problem = Problem::UnknownName { key: key.to_owned(), name: name.to_owned(), known };
    Err(section.document.error(section.value(key).map_or(0..0, Spanned::span), problem))
}

/// Codes of effects that a diagnosis could not tell from one, all of them `known`.
pub(super) fn twins(section: &Section<'_>, known: &[&str]) -> Result<Vec<String>, ExperimentError> {
    const EXPECTED: &str = "a list of codes of effects";
    let Some(value) = section.value("ambiguous_with") else { return Ok(Vec::new()) };
    let DeValue::Array(items) = value.get_ref() else {
        return Err(section.bad("ambiguous_with", value, EXPECTED));
    };
    let one = |item: &Spanned<DeValue<'_>>| match item.get_ref() {
        DeValue::String(code) if known.contains(&code.as_ref()) => Some(code.to_string()),
        _ => None,
    };
    items.iter().map(|item| one(item).ok_or_else(|| section.bad("ambiguous_with", value, EXPECTED))).collect()
}
