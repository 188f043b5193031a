//! What a finger is pressed on.

use std::path::Path;

use lut_gen::pad::error::PadError;
use lut_gen::pad::hertz::{Elastic, RIGID};
use lut_gen::pad::law::foam::{Foam, FoamTerm};
use lut_gen::pad::law::material::Material;
use lut_gen::pad::law::relaxing::{Elastic as Law, Relaxing};
use lut_gen::table::foams;

use crate::experiment::{ExperimentError, Problem};
use crate::extended::ExtendedModel;

/// A block of foam.
#[derive(Debug, Clone, PartialEq)]
pub struct Block {
    /// Its name.
    pub name: String,
    /// Its height, mm.
    pub height_mm: f64,
    /// Terms of its energy.
    pub terms: Vec<FoamTerm>,
    /// Weight and time (s) of what relaxes.
    pub prony: Vec<(f64, f64)>,
    /// What of its model file is not in it, and why.
    pub left_out: Vec<String>,
}

/// What a finger is pressed on.
#[derive(Debug, Clone, PartialEq)]
pub enum Opposite {
    /// A rigid plate.
    Plate,
    /// A foam.
    Block(Block),
}

/// Range of a block's height, mm.
const HEIGHTS: std::ops::RangeInclusive<f64> = 1.0..=200.0;

impl Opposite {
    /// `plate`, the name of a foam of the thesis, or a model file; `height_mm` takes the place of the height that belongs to it.
    ///
    /// # Errors
    /// A file with a mistake, a foam of no known height, or neither name nor file.
    pub fn located(asked: &str, height_mm: Option<f64>) -> Result<Self, ExperimentError> {
        let file = Path::new(asked);
        let wrong = |text: String| ExperimentError::of_file(file, Problem::Contradiction(text));
        if let Some(height) = height_mm.filter(|height| !HEIGHTS.contains(height)) {
            return Err(wrong(format!("a height of {height} mm; expected 1 to 200 mm")));
        }
        if asked == "plate" {
            return match height_mm {
                None => Ok(Opposite::Plate),
                Some(height) => Err(wrong(format!("a plate is rigid, and {height} mm of height are asked for"))),
            };
        }
        let known = foams();
        if let Some(foam) = known.iter().find(|foam| !foam.dummy && foam.name.eq_ignore_ascii_case(asked)) {
            return Ok(Opposite::Block(Block {
                name: foam.name.to_owned(),
                height_mm: height_mm.unwrap_or(foam.height_mm),
                terms: vec![FoamTerm { mu_mpa: foam.mu_mpa, alpha: foam.alpha, nu: 0.0 }],
                prony: Vec::new(),
                left_out: Vec::new(),
            }));
        }
        if !file.is_file() {
            let names: Vec<&str> = known.iter().filter(|foam| !foam.dummy).map(|foam| foam.name).collect();
            let text = format!(
                "no such file, and no foam of this name; expected plate, {}, or a model file",
                names.join(", ")
            );
            return Err(wrong(text));
        }
        let model = ExtendedModel::read(file)?;
        let mut heights: Vec<f64> = model.specimens.iter().map(|specimen| specimen.height_mm).collect();
        heights.sort_by(f64::total_cmp);
        heights.dedup();
        let height = match (height_mm, heights.as_slice()) {
            (Some(height), _) => height,
            (None, [one]) => *one,
            (None, several) => {
                let text =
                    format!("its specimens have {} heights; --height-mm says how high the block is", several.len());
                return Err(wrong(text));
            }
        };
        Ok(Opposite::Block(Block::of(&model, height)))
    }

    /// What it is called.
    pub fn name(&self) -> String {
        match self {
            Opposite::Plate => "a rigid plate".to_owned(),
            Opposite::Block(block) => format!("{}, {} mm high", block.name, block.height_mm),
        }
    }

    /// What it is at small strains, for Hertz' contact.
    pub fn elastic(&self) -> Elastic {
        match self {
            Opposite::Plate => RIGID,
            Opposite::Block(block) => block.elastic(),
        }
    }
}

impl Block {
    /// Of a model file. Thickness, machine, sensor and clock belong to what was measured, not to the material.
    fn of(model: &ExtendedModel, height_mm: f64) -> Self {
        let base = FoamTerm { mu_mpa: model.mu_mpa, alpha: model.alpha, nu: 0.0 };
        let name = model.material.clone();
        let mut own = Block { name, height_mm, terms: vec![base], prony: Vec::new(), left_out: Vec::new() };
        let mut nu = 0.0;
        for added in &model.effects {
            match (added.effect.code, added.values.as_slice()) {
                ("poisson", [ratio]) => nu = *ratio,
                ("second-term", [ratio, alpha]) => {
                    own.terms.push(FoamTerm { mu_mpa: ratio * model.mu_mpa, alpha: *alpha, nu: 0.0 });
                }
                ("relaxation", values) => own.prony.extend(values.chunks_exact(2).map(|term| (term[0], term[1]))),
                _ => own.left_out.push(added.words()),
            }
        }
        own.terms.iter_mut().for_each(|term| term.nu = nu);
        own
    }

    /// Its material.
    ///
    /// # Errors
    /// A term out of its range.
    pub fn material(&self) -> Result<Material, PadError> {
        let foam = Foam::new(self.terms.clone())?;
        if self.prony.is_empty() {
            return Ok(Material::Foam(foam));
        }
        Relaxing::new(Law::Foam(foam), &self.prony).map(Material::Relaxing)
    }

    /// Young's modulus and Poisson's ratio at rest, of the moduli at once.
    fn elastic(&self) -> Elastic {
        let shear: f64 = self.terms.iter().map(|term| term.mu_mpa).sum();
        let nu = self.terms.first().map_or(0.0, |term| term.nu);
        Elastic { young_mpa: 2.0 * shear * (1.0 + nu), nu }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::panic)]
    use super::*;

    fn block(asked: &str, height_mm: Option<f64>) -> Block {
        match Opposite::located(asked, height_mm).unwrap() {
            Opposite::Block(block) => block,
            Opposite::Plate => panic!("{asked} is a plate"),
        }
    }

    fn told(asked: &str, height_mm: Option<f64>) -> String {
        Opposite::located(asked, height_mm).unwrap_err().to_string()
    }

    #[test]
    fn foams_have_their_own_height_or_the_one_asked_for() {
        assert_eq!(block("icf", None).height_mm, 25.4);
        assert_eq!(block("EVA", Some(20.0)).height_mm, 20.0);
        assert_eq!(Opposite::located("plate", None).unwrap(), Opposite::Plate);
        let text = told("cheese", None);
        assert!(
            text.contains("cheese") && text.contains("expected plate, EVA, B1, ICF, A2, or a model file"),
            "{text}"
        );
        assert!(told("EVA", Some(0.0)).contains("a height of 0 mm; expected 1 to 200 mm"));
        assert!(told("plate", Some(3.0)).contains("a plate is rigid, and 3 mm of height are asked for"));
    }

    #[test]
    fn a_model_file_gives_its_terms_and_says_what_is_left_out() {
        let mut model = ExtendedModel::base("own foam", 0.05, 8.0);
        let setting = |code: &str, values: &[f64]| crate::extended::Added {
            effect: lut_gen::effect::find(code, None).unwrap(),
            owner: None,
            values: values.to_vec(),
            intervals: vec![None; values.len()],
            ambiguous_with: Vec::new(),
        };
        model.effects = vec![
            setting("second-term", &[0.2, 20.0]),
            setting("poisson", &[0.1]),
            setting("relaxation", &[0.3, 1.5]),
            setting("compliance", &[0.05]),
        ];
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("model.toml");
        std::fs::write(&file, model.to_toml()).unwrap();
        let asked = file.to_string_lossy().into_owned();
        let own = block(&asked, Some(12.0));
        let second = FoamTerm { mu_mpa: 0.2 * 0.05, alpha: 20.0, nu: 0.1 };
        assert_eq!(own.terms, [FoamTerm { mu_mpa: 0.05, alpha: 8.0, nu: 0.1 }, second]);
        assert_eq!(own.prony, [(0.3, 1.5)]);
        assert!(own.left_out.len() == 1 && own.left_out[0].starts_with("compliance"), "{:?}", own.left_out);
        assert!(matches!(own.material().unwrap(), Material::Relaxing(_)));
        assert!((own.elastic().young_mpa - 2.2 * 0.06).abs() < 1e-12);
        let text = told(&asked, None);
        assert!(text.contains("its specimens have 0 heights; --height-mm says how high"), "{text}");
    }
}
