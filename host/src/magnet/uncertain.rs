//! What a built magnet may differ by from its drawing, and what that does to the flux density that is read.

use std::collections::BTreeMap;
use std::path::Path;

use lut_gen::magnet::study::StudyError;

use super::expression::Parameters;
use super::{Control, Magnet, parse};
use crate::experiment::section::Section;
use crate::experiment::{ExperimentError, Problem};

/// Parts in which a built magnet may differ, by their codes.
pub const PARTS: [&str; 6] = ["gap", "leakage", "turns", "probe-position", "saturation", "fluid"];

/// One of them: a parameter, and by how much it may plausibly differ (one standard deviation).
#[derive(Debug, Clone, PartialEq)]
pub struct Uncertain {
    /// Place of its part in [`PARTS`].
    pub part: usize,
    /// The parameter.
    pub parameter: String,
    /// One standard deviation, in the parameter's unit.
    pub by: f64,
}

/// Flux density at currents, and how it changes with each part, T.
#[derive(Debug, Clone, PartialEq)]
pub struct Simulated {
    /// The drawing's, T.
    pub flux_t: Vec<f64>,
    /// The change for a plausible difference of every part, T; `None` for a part of which the file says nothing.
    pub changes_t: [Option<Vec<f64>>; PARTS.len()],
}

/// Why a magnet cannot stand beside readings.
#[derive(Debug, thiserror::Error)]
pub enum Unsimulated {
    /// Its file.
    #[error(transparent)]
    File(#[from] ExperimentError),
    /// Its field.
    #[error("the magnet's field: {0}")]
    Field(#[from] StudyError),
    /// It does not say what is read.
    #[error("{0} has no key `control`: name the point or probe whose flux density was read")]
    NoControl(String),
}

pub(super) fn read(root: &Section<'_>, parameters: &Parameters) -> Result<Vec<Uncertain>, ExperimentError> {
    let mut list: Vec<Uncertain> = Vec::new();
    for section in root.array("uncertain")? {
        section.only(&["part", "parameter", "by"])?;
        let parts: Vec<(&str, usize)> = PARTS.into_iter().enumerate().map(|(i, name)| (name, i)).collect();
        let expected = PARTS.map(|name| format!("\"{name}\"")).join(", ");
        let part = section.word("part", &parts)?.ok_or_else(|| section.missing("part", &expected))?;
        let known: Vec<&str> = parameters.0.keys().map(String::as_str).collect();
        let expected = format!("the name of a parameter: {}", known.join(", "));
        let parameter = section.text("parameter", &expected)?.ok_or_else(|| section.missing("parameter", &expected))?;
        if let Some(value) = section.value("parameter").filter(|_| !parameters.0.contains_key(parameter)) {
            return Err(section.bad("parameter", value, &expected));
        }
        let expected = "what a built one may differ by, in the parameter's unit, more than 0";
        let by = section.number("by", f64::MIN_POSITIVE..=1e6, expected)?;
        let by = by.ok_or_else(|| section.missing("by", expected))?;
        if list.iter().any(|own| own.part == part) {
            let text = format!("the part \"{}\" is told twice", PARTS[part]);
            return Err(section.document.error(section.span.clone(), Problem::Contradiction(text)));
        }
        list.push(Uncertain { part, parameter: parameter.to_owned(), by });
    }
    Ok(list)
}

/// Solves a magnet's file at these currents (A, rising), and again with every part moved to either side.
///
/// # Errors
/// [`Unsimulated`].
pub fn simulate(file: &Path, text: &str, currents: &[f64]) -> Result<Simulated, Unsimulated> {
    let magnet = parse(file, text, &BTreeMap::new())?;
    let flux_t = flux(file, &magnet, currents)?;
    let mut changes_t: [Option<Vec<f64>>; PARTS.len()] = Default::default();
    for own in &magnet.uncertain {
        let drawn = magnet.parameters.0.get(&own.parameter).copied().unwrap_or(0.0);
        let moved = |by: f64| -> Result<Vec<f64>, Unsimulated> {
            let set = [(own.parameter.clone(), drawn + by)].into();
            flux(file, &parse(file, text, &set)?, currents)
        };
        // A half to either side: what is drawn is seldom the end of what can be built.
        let (more, less) = (moved(0.5 * own.by)?, moved(-0.5 * own.by)?);
        changes_t[own.part] = Some(more.iter().zip(&less).map(|(a, b)| a - b).collect());
    }
    Ok(Simulated { flux_t, changes_t })
}

/// What is read at every current, T: |B| of the control point or probe, times and plus what the built magnet has.
fn flux(file: &Path, magnet: &Magnet, currents: &[f64]) -> Result<Vec<f64>, Unsimulated> {
    let control = magnet.control.ok_or_else(|| Unsimulated::NoControl(file.display().to_string()))?;
    let study = magnet.design.study(&magnet.wanted(), currents, &mut |_| {})?;
    let read = study.states.iter().map(|state| {
        let flux = match control {
            Control::Point(i) => state.points[i],
            Control::Probe(i) => state.probes[i],
        };
        magnet.built.flux * flux.size_t() + magnet.built.remanence_t
    });
    Ok(read.collect())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::magnet::BUILT_IN;

    /// The ring with coarse triangles: what changes must have the sign and the size that a reluctance says.
    #[test]
    fn parts_change_the_flux_as_a_reluctance_says() {
        let ring = BUILT_IN.iter().find(|m| m.name == "ring-probe").unwrap();
        let coarse = ring.text.replace("size_mm = 0.5", "size_mm = 1.5").replace("size_mm = 1\n", "size_mm = 2\n");
        let found = simulate(Path::new("ring.toml"), &coarse, &[0.5, 1.0]).unwrap();
        let change = |part: &str| {
            let at = PARTS.iter().position(|own| *own == part).unwrap();
            found.changes_t[at].as_ref().unwrap()[0] / found.flux_t[0]
        };
        // Half a millimetre more of ten: 5 % less, were there no fringing; a turn in a hundred more: 1 % more.
        assert!((-0.06..-0.02).contains(&change("gap")), "{}", change("gap"));
        assert!((change("turns") / (10.0 / 770.0) - 1.0).abs() < 0.05, "{}", change("turns"));
        assert!((change("leakage") - 0.05).abs() < 1e-9, "{}", change("leakage"));
        // More iron in the fluid carries more; the steel is far from saturation at 0.5 A.
        assert!(change("fluid") > 0.005 && change("saturation").abs() < 0.01, "{}", change("fluid"));
    }
}
