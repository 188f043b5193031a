//! The extended model: the base of a material with the effects that a diagnosis named, usable wherever the base is.
//!
//! It is a file, `model.toml`, that a diagnosis or an identification leaves and any experiment, specification or table may be given. What each use takes from it:
//!
//! | use | takes |
//! |---|---|
//! | simulation ([`truth`]) | material and every effect, by finite elements of the whole path |
//! | identification ([`identify`]) | every effect, by the chain that named it; mu and alpha are fitted again |
//! | table of a board ([`board`]) | what a board meets as well: specimen, material and contact, by finite elements |
//! | table of many materials ([`own`]) | an entry of the library for each |
//! | gain ([`gain`]) | the table, and recordings freed from what only their own rig did to them ([`rig`]) |
//!
//! A display has a file of its own ([`display`]), and so has a magnet ([`magnet`]).

pub mod board;
pub mod display;
mod file;
mod fitting;
pub mod gain;
mod identified;
pub mod identify;
pub mod magnet;
pub mod own;
pub mod rig;
#[cfg(test)]
mod tests;
pub mod truth;
mod writing;

use std::path::Path;

use lut_gen::chain::{Model, Setting};
use lut_gen::effect::{Effect, Owner};

use crate::diagnose::{Diagnosis, Estimate, Verdict};
use crate::experiment::{Base, Experiment, ExperimentError};

pub use identified::Saved;

/// An effect with its values.
#[derive(Debug, Clone, PartialEq)]
pub struct Added {
    /// The effect.
    pub effect: &'static Effect,
    /// Ball or specimen that it belongs to; none for an effect of the whole experiment.
    pub owner: Option<String>,
    /// One value a quantity of the effect.
    pub values: Vec<f64>,
    /// 95 % intervals of these, where they are known.
    pub intervals: Vec<Option<(f64, f64)>>,
    /// Codes of other effects that the diagnosis could not tell from it.
    pub ambiguous_with: Vec<String>,
}

/// A ball as the diagnosed experiment declared it.
#[derive(Debug, Clone, PartialEq)]
pub struct DeclaredBall {
    /// Its name.
    pub name: String,
    /// Its radius, mm.
    pub radius_mm: f64,
}

/// A specimen as the diagnosed experiment declared it.
#[derive(Debug, Clone, PartialEq)]
pub struct DeclaredSpecimen {
    /// Its name.
    pub name: String,
    /// Its height, mm.
    pub height_mm: f64,
    /// Its radius, mm; none where it was not known.
    pub radius_mm: Option<f64>,
    /// How it was thought to rest.
    pub base: Base,
}

/// A base model and what was added to it.
#[derive(Debug, Clone, PartialEq)]
pub struct ExtendedModel {
    /// Name of the material.
    pub material: String,
    /// Shear modulus, MPa.
    pub mu_mpa: f64,
    /// Exponent.
    pub alpha: f64,
    /// 95 % intervals of these two, where they are known.
    pub intervals: [Option<(f64, f64)>; 2],
    /// Balls of the diagnosed experiment.
    pub indenters: Vec<DeclaredBall>,
    /// Its specimens of this material.
    pub specimens: Vec<DeclaredSpecimen>,
    /// What was added, in physical order.
    pub effects: Vec<Added>,
}

/// Why an extended model cannot be used somewhere.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ExtendedError {
    /// A ball or specimen of the model is not there.
    #[error("the model's {effect} belongs to {kind} \"{name}\", which is not described; known: {known}")]
    UnknownOwner {
        /// Code of the effect.
        effect: &'static str,
        /// `indenter` or `specimen`.
        kind: &'static str,
        /// Its name.
        name: String,
        /// The names described.
        known: String,
    },
    /// The model is of another material.
    #[error("the model is of material \"{material}\", of which the experiment has no indentation; known: {known}")]
    UnknownMaterial {
        /// The model's material.
        material: String,
        /// Those of the experiment.
        known: String,
    },
    /// Something asked for twice, or that does not go together.
    #[error("{0}")]
    Contradiction(String),
    /// An effect that a use has no physics for.
    #[error("the model's {effect} ({form}) cannot be simulated: {why}")]
    NoPhysics {
        /// Code of the effect.
        effect: &'static str,
        /// Its form.
        form: &'static str,
        /// Why not.
        why: &'static str,
    },
}

impl ExtendedModel {
    /// The base alone.
    #[must_use]
    pub fn base(material: &str, mu_mpa: f64, alpha: f64) -> Self {
        Self {
            material: material.to_owned(),
            mu_mpa,
            alpha,
            intervals: [None; 2],
            indenters: Vec::new(),
            specimens: Vec::new(),
            effects: Vec::new(),
        }
    }

    /// What a diagnosis named; none if it named nothing. Of a set of names it holds the likeliest.
    #[must_use]
    pub fn of(experiment: &Experiment, diagnosis: &Diagnosis) -> Option<Self> {
        if !matches!(diagnosis.verdict, Verdict::Named | Verdict::Ambiguous) {
            return None;
        }
        let evidence = diagnosis.evidence.as_ref()?;
        let fit = &evidence.held.first()?.fit;
        let mut model = Self::alone(experiment, diagnosis, evidence.extended()?);
        for (at, candidate) in fit.candidates.iter().enumerate() {
            let quantities = fit.quantities(at);
            let owner = match candidate.effect.owner {
                Owner::All => None,
                Owner::Indenter => experiment.indenters.get(candidate.owner).map(|i| i.name.clone()),
                Owner::Specimen => experiment.specimens.get(candidate.owner).map(|s| s.name.clone()),
            };
            let twins = diagnosis.findings.get(at).map_or(&[][..], |f| &f.ambiguous_with);
            model.effects.push(Added {
                effect: candidate.effect,
                owner,
                values: quantities.iter().map(|q| q.1).collect(),
                intervals: quantities.iter().map(|q| Some(q.2)).collect(),
                ambiguous_with: twins.iter().map(|t| (*t).to_owned()).collect(),
            });
        }
        model.effects.sort_by_key(|added| added.effect.stage);
        Some(model)
    }

    /// What a diagnosis leaves to be used: the base with what it named, or the base alone where nothing is wrong with it.
    #[must_use]
    pub fn kept(experiment: &Experiment, diagnosis: &Diagnosis) -> Option<Self> {
        if diagnosis.verdict != Verdict::Clean {
            return Self::of(experiment, diagnosis);
        }
        Some(Self::alone(experiment, diagnosis, diagnosis.evidence.as_ref()?.before.parameters))
    }

    /// A base without effects: the estimates of `mu` (MPa) and `alpha`.
    fn alone(experiment: &Experiment, diagnosis: &Diagnosis, [mu, alpha]: [Estimate; 2]) -> Self {
        let mut model = Self::base(&diagnosis.material, mu.0, alpha.0);
        model.intervals = [Some(mu.1), Some(alpha.1)];
        model.declare(experiment);
        model
    }

    /// Takes over what an experiment declares of its balls and of the specimens of this material.
    pub fn declare(&mut self, experiment: &Experiment) {
        let ball = |i: &crate::experiment::Indenter| {
            i.radius_mm.known().map(|radius_mm| DeclaredBall { name: i.name.clone(), radius_mm })
        };
        self.indenters = experiment.indenters.iter().filter_map(ball).collect();
        let own = experiment.specimens.iter().filter(|s| s.material == self.material);
        let specimen = |s: &crate::experiment::Specimen| {
            s.height_mm.known().map(|height_mm| DeclaredSpecimen {
                name: s.name.clone(),
                height_mm,
                radius_mm: s.radius_mm.known(),
                base: s.base,
            })
        };
        self.specimens = own.filter_map(specimen).collect();
    }

    /// Reads a model file.
    ///
    /// # Errors
    /// The first mistake, with file, line and column, the key, its value and what was expected.
    pub fn read(file: &Path) -> Result<Self, ExperimentError> {
        Self::parse(file, &crate::experiment::text_of(file)?)
    }

    /// The model as the chain of an experiment takes it, its effects without those of unknown owners refused.
    ///
    /// # Errors
    /// [`ExtendedError::UnknownOwner`].
    pub fn chain_model(&self, experiment: &Experiment) -> Result<Model, ExtendedError> {
        let mut model = Model::base(self.mu_mpa, self.alpha);
        for added in &self.effects {
            let owner = added.owner_in(experiment)?;
            model.settings.push(Setting { effect: added.effect, owner, values: added.values.clone() });
        }
        Ok(model)
    }
}

impl Added {
    /// Number of the ball or specimen that it belongs to.
    ///
    /// # Errors
    /// [`ExtendedError::UnknownOwner`].
    pub fn owner_in(&self, experiment: &Experiment) -> Result<usize, ExtendedError> {
        let (kind, names): (_, Vec<&str>) = match self.effect.owner {
            Owner::All => return Ok(0),
            Owner::Indenter => ("indenter", experiment.indenters.iter().map(|i| i.name.as_str()).collect()),
            Owner::Specimen => ("specimen", experiment.specimens.iter().map(|s| s.name.as_str()).collect()),
        };
        let name = self.owner.as_deref().unwrap_or_default();
        names.iter().position(|n| *n == name).ok_or_else(|| ExtendedError::UnknownOwner {
            effect: self.effect.code,
            kind,
            name: name.to_owned(),
            known: names.join(", "),
        })
    }

    /// Effect, owner and values in words: `relaxation (one-term): g1 0.3, tau1_s 1`.
    #[must_use]
    pub fn words(&self) -> String {
        let values: Vec<String> = self
            .effect
            .quantities
            .iter()
            .zip(&self.values)
            .map(|(q, v)| format!("{} {}", q.name, crate::report::number(*v)))
            .collect();
        let owner = self.owner.as_ref().map_or(String::new(), |name| format!(" of {name}"));
        format!("{} ({}){owner}: {}", self.effect.code, self.effect.form, values.join(", "))
    }
}
