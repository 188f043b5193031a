//! A magnet's flux density over current, from its drawing or from readings.

use std::collections::BTreeMap;
use std::path::Path;

use lut_gen::magnet::curve::FluxCurve;
use miette::{IntoDiagnostic, WrapErr, miette};

use crate::control::compose::Links;
use crate::extended::display::DisplayModel;
use crate::magnet::fluid::NamedFluid;
use crate::magnet::measured;

/// What no bound of a curve holds.
pub(in crate::cli) const ABOUT_FLUIDS: &str = "Models fitted to the same data of such fluids differ by 13 to 24 % in yield stress \
    (Xie, Liu and Cai 2020). The bound of a current does not hold that.";

/// Currents that the magnet is computed at, up to the driver's largest.
const CURRENTS: usize = 16;

/// What a magnet makes of a fluid up to a current, A: `asked` is its file, its readings or its name.
///
/// # Errors
/// A file with a mistake, a drawing that cannot be solved, one that does not say where the fluid is.
pub(in crate::cli) fn links(asked: &str, fluid: &NamedFluid, most_a: f64) -> miette::Result<Links> {
    let flux = match (measured::located(asked).into_diagnostic()?, diagnosed(asked, most_a)?) {
        (Some(flux), _) | (None, Some(flux)) => flux,
        (None, None) => drawn(asked, most_a)?,
    };
    // readings may end before the driver does
    let most_a = most_a.min(flux.most_a());
    Ok(Links { magnet: asked.to_owned(), flux, fluid: fluid.title.clone(), law: fluid.fluid.clone(), most_a })
}

/// The magnet of a display's extended model, if the file is one.
fn diagnosed(asked: &str, most_a: f64) -> miette::Result<Option<FluxCurve>> {
    let file = Path::new(asked);
    let text = if file.is_file() { std::fs::read_to_string(file).unwrap_or_default() } else { String::new() };
    if !DisplayModel::is_one(&text) {
        return Ok(None);
    }
    let flux = DisplayModel::parse(file, &text)?.flux_curve(most_a);
    let flux = flux.ok_or_else(|| miette!("{asked} has no [channel.flux]: nothing was found of its magnet"))?;
    flux.map(Some).into_diagnostic().wrap_err_with(|| format!("the flux of {asked}"))
}

fn drawn(asked: &str, most_a: f64) -> miette::Result<FluxCurve> {
    let (magnet, _) = crate::cli::magnet::magnet(asked, &BTreeMap::new())?;
    let currents: Vec<f64> = (1..=CURRENTS).map(|i| most_a * i as f64 / CURRENTS as f64).collect();
    let study = magnet.design.study(&magnet.wanted(), &currents, &mut |_| {});
    let study = study.into_diagnostic().wrap_err_with(|| format!("the field of \"{}\"", magnet.title))?;
    magnet.flux_curve(&study.states).ok_or_else(|| {
        miette!("{asked} has no flux density over current; expected a coil, and `control` naming a point or probe")
    })
}

/// Letters and digits of a name, small, with dashes for all else.
pub(in crate::cli) fn file_name(name: &str) -> String {
    let words = name.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
    words.collect::<Vec<_>>().join("-").to_ascii_lowercase()
}
