//! An identified material as a model file.

use lut_gen::effect::{Effect, friction, poisson, relaxation, second_term};
use lut_gen::solid::law::{Elastic, Material, PronyTerm};

use crate::experiment::{Experiment, Length};
use crate::identify::Identification;
use crate::identify::fit::Parameter;
use crate::report::number;

use super::{Added, DeclaredSpecimen, ExtendedError, ExtendedModel};

/// A model of an identified material, and what the reader should know of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Saved {
    /// The model.
    pub model: ExtendedModel,
    /// What the file says otherwise than the fit, in sentences.
    pub notes: Vec<String>,
}

/// Everything that a material's file is made of.
struct Source<'a> {
    experiment: &'a Experiment,
    found: &'a Identification,
    /// End of the names of parameters that a specimen has for itself.
    of: String,
}

impl Source<'_> {
    fn parameter(&self, name: &str) -> Option<&Parameter> {
        let own = format!("{name}{}", self.of);
        let all = &self.found.fit.as_ref()?.parameters;
        all.iter().find(|p| p.name == own).or_else(|| all.iter().find(|p| p.name == name))
    }

    fn interval(&self, name: &str) -> Option<(f64, f64)> {
        let interval = self.parameter(name)?.interval95;
        (interval.low.is_finite() && interval.high.is_finite()).then_some((interval.low, interval.high))
    }

    /// An effect with these values; intervals are those of the parameters of these names.
    fn added(&self, effect: &'static Effect, values: Vec<f64>, names: &[&str]) -> Added {
        let intervals = names.iter().map(|name| self.interval(name)).collect();
        Added { effect, owner: None, values, intervals, ambiguous_with: Vec::new() }
    }
}

impl ExtendedModel {
    /// What was identified of a material: one model, or one a specimen where specimens have their own parameters.
    /// `rubs` is the coefficient of friction under the ball that the fit assumed.
    ///
    /// # Errors
    /// [`ExtendedError::Contradiction`] where nothing was fitted, or a model file has no words for the law.
    pub fn identified(experiment: &Experiment, found: &Identification, rubs: f64) -> Result<Vec<Saved>, ExtendedError> {
        let fit = found.fit.as_ref().filter(|fit| !fit.materials.is_empty());
        let fit = fit.ok_or_else(|| refused(found, "nothing was fitted, so there is nothing to save"))?;
        let several = fit.materials.len() > 1;
        let one = |(specimen, material): &(usize, Material)| {
            let specimen = several.then_some(*specimen);
            let of = specimen.map_or_else(String::new, |at| format!(" of {}", experiment.specimens[at].name));
            saved(&Source { experiment, found, of }, specimen, material, rubs)
        };
        fit.materials.iter().map(one).collect()
    }
}

fn refused(found: &Identification, why: &str) -> ExtendedError {
    ExtendedError::Contradiction(format!("{}: {why}", found.material))
}

fn saved(source: &Source<'_>, specimen: Option<usize>, material: &Material, rubs: f64) -> Result<Saved, ExtendedError> {
    let Elastic::Hyperfoam(law) = &material.elastic else {
        return Err(refused(source.found, "a model file holds hyperfoam only; --law hyperfoam fits one"));
    };
    let first = law.terms()[0];
    let name = match specimen {
        Some(at) => source.experiment.specimens[at].name.as_str(),
        None => crate::results::material_name(source.experiment, &source.found.material),
    };
    let mut model = ExtendedModel::base(name, first.mu_mpa, first.alpha);
    let two = law.terms().len() > 1;
    model.intervals = match two {
        true => [source.interval("mu_1_MPa"), source.interval("alpha_1")],
        false => [source.interval("mu_MPa"), source.interval("alpha")],
    };
    declare(&mut model, source, specimen);
    let mut notes = Vec::new();
    if first.nu != 0.0 {
        model.effects.push(source.added(&poisson::EFFECT, vec![first.nu], &["nu"]));
    }
    if let Some(second) = law.terms().get(1) {
        let ratio = second.mu_mpa / first.mu_mpa;
        model.effects.push(source.added(&second_term::EFFECT, vec![ratio, second.alpha], &["", "alpha_2"]));
    }
    if !material.prony.is_empty() {
        let (added, note) = relaxing(source, &material.prony)?;
        model.effects.push(added);
        notes.extend(note);
    }
    let friction = source.parameter("friction").map_or(rubs, |p| p.value);
    if friction > 0.0 {
        model.effects.push(source.added(&friction::EFFECT, vec![friction], &["friction"]));
    }
    for added in &model.effects {
        within(source.found, added)?;
    }
    if !(1.0..=30.0).contains(&model.alpha) {
        return Err(refused(source.found, &format!("alpha is {}; a model file holds 1 to 30", number(model.alpha))));
    }
    Ok(Saved { model, notes })
}

/// Values that a model file may hold.
fn within(found: &Identification, added: &Added) -> Result<(), ExtendedError> {
    for (quantity, value) in added.effect.quantities.iter().zip(&added.values) {
        if !(quantity.low..=quantity.high).contains(value) {
            let (name, low, high) = (quantity.name, number(quantity.low), number(quantity.high));
            let why = format!("{name} is {}; a model file holds {low} to {high}", number(*value));
            return Err(refused(found, &why));
        }
    }
    Ok(())
}

/// Balls and specimens; a height that was fitted stands in the place of one that was not known.
fn declare(model: &mut ExtendedModel, source: &Source<'_>, only: Option<usize>) {
    let name = std::mem::replace(&mut model.material, source.found.material.clone());
    model.declare(source.experiment);
    model.material = name;
    for (at, specimen) in source.experiment.specimens.iter().enumerate() {
        let fitted =
            source.parameter(&format!("height_mm of {}", specimen.name)).or_else(|| source.parameter("height_mm"));
        let here = specimen.material == source.found.material && specimen.height_mm == Length::Unknown;
        if let Some(height) = fitted.filter(|_| here && only.is_none_or(|only| only == at)) {
            model.specimens.push(DeclaredSpecimen {
                name: specimen.name.clone(),
                height_mm: height.value,
                radius_mm: specimen.radius_mm.known(),
                base: specimen.base,
            });
        }
    }
    if let Some(only) = only {
        model.specimens.retain(|declared| declared.name == source.experiment.specimens[only].name);
    }
}

/// A model file knows one part of a term that relaxes, in shear and bulk alike: that of the shear, where the bulk's interval holds it.
fn relaxing(source: &Source<'_>, prony: &[PronyTerm]) -> Result<(Added, Option<String>), ExtendedError> {
    let one = prony.len() == 1;
    for (at, term) in prony.iter().enumerate() {
        let name = if one { "k".to_owned() } else { format!("k_{}", at + 1) };
        let holds = source.interval(&name).is_some_and(|(low, high)| (low..=high).contains(&term.g));
        if !holds && term.g != term.k {
            let why = format!(
                "{name} is {} and g {}; a model file holds materials that relax alike in shear and bulk",
                number(term.k),
                number(term.g)
            );
            return Err(refused(source.found, &why));
        }
    }
    let values = prony.iter().flat_map(|term| [term.g, term.tau_s]).collect();
    let added = match one {
        true => source.added(&relaxation::ONE, values, &["g", "tau_s"]),
        false => source.added(&relaxation::TWO, values, &["g_1", "tau_1_s", "g_2", "tau_2_s"]),
    };
    let apart = prony.iter().any(|term| term.g != term.k);
    let note = "the file lets shear and bulk relax alike, by g; the fit's k is not in it, and its interval holds g";
    Ok((added, apart.then(|| format!("{}: {note}", source.found.material))))
}
