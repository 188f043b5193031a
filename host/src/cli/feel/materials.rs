//! The materials that are asked for, with their curves.

use std::path::Path;

use miette::{IntoDiagnostic, miette};

use crate::control::ControlCurve;
use crate::control::compose::Links;

/// Curves for a magnet.
pub(super) fn made_for(curves: &[ControlCurve], links: &Links) -> miette::Result<Vec<ControlCurve>> {
    let made = |curve: &ControlCurve| {
        let made = curve.for_magnet(links);
        made.map_err(|error| miette!("{} with the magnet {}: {error}", curve.material, links.magnet))
    };
    curves.iter().map(made).collect()
}

/// Curves by name or file; without any all that come with the program.
///
/// # Errors
/// A name that nobody knows, a file with a mistake, a material twice.
pub(super) fn found(asked: &[String]) -> miette::Result<Vec<ControlCurve>> {
    if asked.is_empty() {
        return Ok(ControlCurve::all_built_in().collect());
    }
    let mut curves = Vec::<ControlCurve>::new();
    for asked in asked {
        let curve = match ControlCurve::built_in(asked).filter(|_| !Path::new(asked).is_file()) {
            Some(curve) => curve,
            None if Path::new(asked).is_file() => ControlCurve::read(Path::new(asked)).into_diagnostic()?,
            None => {
                let known: Vec<String> = ControlCurve::all_built_in().map(|curve| curve.material).collect();
                return Err(miette!(
                    "no file {asked}, and no curve of this name comes with the program; known are {}; `palpate control-curve` \
                     makes others",
                    known.join(", ")
                ));
            }
        };
        if curves.iter().any(|other| other.material == curve.material) {
            return Err(miette!("{} is asked for twice; expected each material once", curve.material));
        }
        curves.push(curve);
    }
    Ok(curves)
}
