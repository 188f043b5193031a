//! `[skin]` and `[tissue]`: a shear modulus or Ogden's terms, a bulk modulus or Poisson's ratio, and relaxation.

use lut_gen::pad::error::PadError;
use lut_gen::pad::law::material::Material;
use lut_gen::pad::law::ogden::Ogden;
use lut_gen::pad::law::relaxing::{Elastic, Relaxing};

use crate::experiment::section::Section;
use crate::experiment::{ExperimentError, Problem};

const KEYS: [&str; 5] = ["mu_MPa", "ogden", "nu", "bulk_MPa", "prony"];

/// Reads a layer.
pub(super) fn read(section: &Section<'_>) -> Result<Material, ExperimentError> {
    section.only(&KEYS)?;
    let terms = match one_of(section, ["mu_MPa", "ogden"])? {
        "mu_MPa" => vec![(positive(section, "mu_MPa", "a shear modulus of 1e-6 to 1e4 MPa")?, 2.0)],
        _ => section.array("ogden")?.iter().map(|term| ogden(term, section)).collect::<Result<_, _>>()?,
    };
    let shear: f64 = terms.iter().map(|term| term.0).sum();
    let bulk = match one_of(section, ["nu", "bulk_MPa"])? {
        "nu" => {
            let expected = "Poisson's ratio at rest, 0 to 0.4999";
            let nu = section.number("nu", 0.0..=0.4999, expected)?.unwrap_or_default();
            2.0 * shear * (1.0 + nu) / (3.0 * (1.0 - 2.0 * nu))
        }
        _ => positive(section, "bulk_MPa", "a bulk modulus of 1e-6 to 1e4 MPa")?,
    };
    let bad = |key: &str| {
        let span = section.value(key).map_or(section.span.clone(), toml::Spanned::span);
        move |error: PadError| section.document.error(span, Problem::Contradiction(error.to_string()))
    };
    let law = Ogden::new(&terms, bulk).map_err(bad("ogden"))?;
    if section.value("prony").is_none() {
        return Ok(Material::Ogden(law));
    }
    let series = section.array("prony")?.iter().map(|term| prony(term, section)).collect::<Result<Vec<_>, _>>()?;
    Relaxing::new(Elastic::Ogden(law), &series).map(Material::Relaxing).map_err(bad("prony"))
}

/// The one key of two that is there.
fn one_of<'k>(section: &Section<'_>, keys: [&'k str; 2]) -> Result<&'k str, ExperimentError> {
    let told: Vec<&str> = keys.into_iter().filter(|key| section.value(key).is_some()).collect();
    if let [one] = told.as_slice() {
        return Ok(one);
    }
    let found = if told.is_empty() { "none".to_owned() } else { told.join(", ") };
    let text = format!("a layer is given by one of {}; found {found}", keys.join(", "));
    Err(section.document.error(section.span.clone(), Problem::Contradiction(text)))
}

fn positive(section: &Section<'_>, key: &str, expected: &str) -> Result<f64, ExperimentError> {
    section.number(key, 1e-6..=1e4, expected)?.ok_or_else(|| section.missing(key, expected))
}

/// A term as it is called in messages.
fn named<'a>(term: &Section<'a>, layer: &Section<'_>, key: &str) -> Section<'a> {
    let layer = layer.name.trim_matches(['[', ']']);
    let mut own = term.clone();
    own.name = format!("[[{layer}.{key}]]");
    own
}

/// mu (MPa) and alpha.
fn ogden(term: &Section<'_>, layer: &Section<'_>) -> Result<(f64, f64), ExperimentError> {
    let term = named(term, layer, "ogden");
    term.only(&["mu_MPa", "alpha"])?;
    let need = |key: &str, range, expected: &str| {
        term.number(key, range, expected)?.ok_or_else(|| term.missing(key, expected))
    };
    Ok((
        need("mu_MPa", -1e4..=1e4, "a modulus of -1e4 to 1e4 MPa; all of a layer sum to its shear modulus")?,
        need("alpha", -100.0..=100.0, "an exponent of -100 to 100, not 0")?,
    ))
}

/// Weight and time (s).
fn prony(term: &Section<'_>, layer: &Section<'_>) -> Result<(f64, f64), ExperimentError> {
    let term = named(term, layer, "prony");
    term.only(&["g", "tau_s"])?;
    let need = |key: &str, range, expected: &str| {
        term.number(key, range, expected)?.ok_or_else(|| term.missing(key, expected))
    };
    Ok((
        need("g", 0.0..=1.0, "the part of the shear modulus that relaxes, 0 to 1")?,
        need("tau_s", 1e-6..=1e6, "the time in which it relaxes, 1e-6 to 1e6 s")?,
    ))
}
