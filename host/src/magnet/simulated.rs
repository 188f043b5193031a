//! The flux density of a magnet's file over current, and what its uncertain parts do to it.

use std::collections::BTreeMap;
use std::path::Path;

use lut_gen::magnet::study::{StudyError, Wanted};
use rayon::prelude::*;

use super::uncertain::{PARTS, Uncertain};
use super::{Magnet, parse};
use crate::experiment::ExperimentError;

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

/// How much larger the triangles are where only differences are wanted: both sides err alike.
const COARSE: f64 = 2.0;

/// Solves a magnet's file at these currents (A, rising), and again with every part moved to either side.
///
/// # Errors
/// [`Unsimulated`].
pub fn simulate(file: &Path, text: &str, currents: &[f64]) -> Result<Simulated, Unsimulated> {
    let magnet = parse(file, text, &BTreeMap::new())?;
    let drawn = flux(file, &magnet, currents, 1.0)?;
    let flux_t = built(&magnet, &drawn);
    let changed = |own: &Uncertain| -> Result<Vec<f64>, Unsimulated> {
        let nominal = magnet.parameters.0.get(&own.parameter).copied().unwrap_or(0.0);
        let moved = |by: f64| -> Result<Vec<f64>, Unsimulated> {
            let there = parse(file, text, &[(own.parameter.clone(), nominal + by)].into())?;
            // What does not change the drawing needs no field of its own.
            let same = there.design == magnet.design
                && there.points == magnet.points
                && there.built.ampere_turns == magnet.built.ampere_turns;
            Ok(built(&there, &if same { drawn.clone() } else { flux(file, &there, currents, COARSE)? }))
        };
        // A half to either side: what is drawn is seldom the end of what can be built.
        let (more, less) = (moved(0.5 * own.by)?, moved(-0.5 * own.by)?);
        Ok(more.iter().zip(&less).map(|(a, b)| a - b).collect())
    };
    let all: Vec<Vec<f64>> = magnet.uncertain.par_iter().map(changed).collect::<Result<_, _>>()?;
    let mut changes_t: [Option<Vec<f64>>; PARTS.len()] = Default::default();
    for (own, change) in magnet.uncertain.iter().zip(all) {
        changes_t[own.part] = Some(change);
    }
    Ok(Simulated { flux_t, changes_t })
}

/// Flux density that a built magnet has at its control point or probe at every current (A, rising), T.
///
/// # Errors
/// [`Unsimulated`].
pub fn flux_at(file: &Path, magnet: &Magnet, currents: &[f64]) -> Result<Vec<f64>, Unsimulated> {
    Ok(built(magnet, &flux(file, magnet, currents, 1.0)?))
}

/// What the built magnet has where its drawing has this.
fn built(magnet: &Magnet, drawn: &[f64]) -> Vec<f64> {
    drawn.iter().map(|b| magnet.built.flux * b + magnet.built.remanence_t).collect()
}

/// |B| of the control point or probe of the drawing with the built ampere turns at every current, T.
fn flux(file: &Path, magnet: &Magnet, currents: &[f64], coarser: f64) -> Result<Vec<f64>, Unsimulated> {
    let no_control = || Unsimulated::NoControl(file.display().to_string());
    // What lies along lines is not asked for here.
    let wanted = Wanted { coarser, is_single: true, ..Magnet { lines: Vec::new(), ..magnet.clone() }.wanted() };
    let driven: Vec<f64> = currents.iter().map(|ampere| magnet.built.ampere_turns * ampere).collect();
    let study = magnet.design.study(&wanted, &driven, &mut |_| {})?;
    study.states.iter().map(|state| magnet.controlled(state).map(|flux| flux.size_t()).ok_or_else(no_control)).collect()
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
        let coarse = ring.text.replace("size_mm = 0.5", "size_mm = 1.5").replace("size_mm = 1\n", "size_mm = 1.5\n");
        let found = simulate(Path::new("ring.toml"), &coarse, &[0.5, 1.0]).unwrap();
        let change = |part: &str| {
            let at = PARTS.iter().position(|own| *own == part).unwrap();
            found.changes_t[at].as_ref().unwrap()[0] / found.flux_t[0]
        };
        // Half a millimetre more of ten: 5 % less, were there no fringing; a turn in a hundred more: 1 %
        // more, were the steel not bending.
        assert!((-0.06..-0.02).contains(&change("gap")), "{}", change("gap"));
        assert!((change("turns") / (10.0 / 770.0) - 1.0).abs() < 0.15, "{}", change("turns"));
        assert!((change("leakage") - 0.05).abs() < 1e-9, "{}", change("leakage"));
        // More iron in the fluid carries more, and so does better steel, a little.
        assert!(change("fluid") > 0.005, "{}", change("fluid"));
        assert!((0.0..0.05).contains(&change("saturation")), "{}", change("saturation"));
    }
}
