//! A board's table of own materials: an entry of the library for each model file, over one grid of plain foams.
//!
//! The grid is what a board searches for mu and alpha, and knows no effects. The entries are what it recognises:
//! force curves with each material's own effects ([`ExtendedModel::on_board`]), and its display curve.

use lut_gen::table::{self, Foam, GridSpec, LutError};
use protocol::lut::MaterialSpec;

use super::{ExtendedError, ExtendedModel};

/// A material at one height: the simulation of its entry.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// Name in the library.
    pub name: String,
    /// Its shear modulus, MPa.
    pub mu_mpa: f64,
    /// Its exponent.
    pub alpha: f64,
    /// What is solved.
    pub spec: GridSpec,
    /// What of the model is in the entry.
    pub kept: Vec<String>,
    /// What is not, and why.
    pub left_out: Vec<String>,
}

/// Entries of one model, one a height; `declared` is the grid at each height that is asked for. Where none is asked
/// for, heights are those of the model's specimens.
///
/// # Errors
/// [`ExtendedError::Contradiction`] where no height is known, or a length is no length.
pub fn entries(
    model: &ExtendedModel,
    asked_mm: Option<&[f64]>,
    declared: &dyn Fn(f64) -> GridSpec,
    cycle: usize,
) -> Result<Vec<Entry>, ExtendedError> {
    let mut heights_mm: Vec<f64> = match asked_mm {
        Some(all) => all.to_vec(),
        None => model.specimens.iter().map(|specimen| specimen.height_mm).collect(),
    };
    heights_mm.sort_by(f64::total_cmp);
    heights_mm.dedup();
    if heights_mm.is_empty() {
        let text = format!("{} has no specimen in its file; --height-mm says how high it is", model.material);
        return Err(ExtendedError::Contradiction(text));
    }
    let one = |height_mm: &f64| {
        let made = model.on_board(&declared(*height_mm), cycle)?;
        Ok(Entry {
            name: super::gain::library_name(&model.material),
            mu_mpa: model.mu_mpa,
            alpha: model.alpha,
            spec: made.spec,
            kept: made.kept,
            left_out: made.left_out,
        })
    };
    heights_mm.iter().map(one).collect()
}

/// The library of these entries. `rate_mm_s` is the rate of their curves; a table whose grid does not relax has no
/// axis of rates, and each entry then serves every rate.
///
/// # Errors
/// [`LutError::Material`] when a solve fails.
pub fn library(entries: &[Entry], rate_mm_s: f64, rates: bool) -> Result<Vec<MaterialSpec>, LutError> {
    let mut out = Vec::new();
    for entry in entries {
        let spec = GridSpec { rate_mm_s, ..entry.spec.clone() };
        let height_mm = spec.specimen.height_mm;
        let foam = Foam { name: "own", mu_mpa: entry.mu_mpa, alpha: entry.alpha, height_mm, dummy: false };
        let made = table::library(&[foam], &spec)?;
        let rate = |own: f64| if rates { own } else { 0.0 };
        out.extend(made.into_iter().map(|m| MaterialSpec {
            name: entry.name.clone(),
            rate_mm_s: rate(m.rate_mm_s),
            ..m
        }));
    }
    Ok(out)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::expect_used)]
mod tests {
    use lut_gen::solid::contact::Ball;
    use lut_gen::solid::model::Specimen;

    use super::*;
    use crate::experiment::Base;
    use crate::extended::DeclaredSpecimen;

    fn declared(height_mm: f64) -> GridSpec {
        GridSpec::thesis(Specimen::of_height(height_mm), Ball { radius_mm: 4.0 })
    }

    #[test]
    fn heights_are_those_of_the_file_or_those_asked_for() {
        let mut model = ExtendedModel::base("Own foam, a long name", 0.05, 8.0);
        let missing = entries(&model, None, &declared, 1).expect_err("no height").to_string();
        assert!(missing.contains("--height-mm"), "{missing}");
        let specimen = |name: &str, height_mm| DeclaredSpecimen {
            name: name.to_owned(),
            height_mm,
            radius_mm: None,
            base: Base::Bonded,
        };
        model.specimens = vec![specimen("b", 20.0), specimen("a", 12.0), specimen("c", 20.0)];
        let found = entries(&model, None, &declared, 1).unwrap();
        assert_eq!(found.iter().map(|e| e.spec.specimen.height_mm).collect::<Vec<_>>(), [12.0, 20.0]);
        assert_eq!(found[0].name, "Own foam, a long");
        assert_eq!(entries(&model, Some(&[15.0]), &declared, 1).unwrap()[0].spec.specimen.height_mm, 15.0);
    }
}
