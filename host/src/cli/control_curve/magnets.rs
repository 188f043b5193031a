//! A magnet's flux density over current, from its drawing or from readings.

use std::collections::BTreeMap;
use std::path::Path;

use lut_gen::magnet::curve::FluxCurve;
use lut_gen::magnet::fluid::Fluid;
use miette::{IntoDiagnostic, WrapErr, miette};

use crate::control::compose::Links;
use crate::experiment::text_of;
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
    let model = displayed(Path::new(asked))?;
    let flux = match (measured::located(asked).into_diagnostic()?, &model) {
        (Some(flux), _) => flux,
        (None, Some(model)) => flux_of(model, asked, most_a)?
            .ok_or_else(|| miette!("{asked} has no [channel.flux]: nothing was found of its magnet"))?,
        (None, None) => drawn(asked, most_a)?,
    };
    let law = model.map(|model| fluid_of(&model, asked, &fluid.fluid)).transpose()?.flatten();
    // readings may end before the driver does
    let most_a = most_a.min(flux.most_a());
    let law = law.unwrap_or_else(|| fluid.fluid.clone());
    Ok(Links { magnet: asked.to_owned(), flux, fluid: fluid.title.clone(), law, most_a })
}

/// Magnet and fluid as a display's extended model has them; what it has nothing of stays.
///
/// # Errors
/// A file that is no such model, or has neither.
pub(in crate::cli) fn modelled(file: &Path, links: &Links) -> miette::Result<Links> {
    let name = file.display().to_string();
    let text = text_of(file)?;
    if text.parse::<toml::Table>().is_ok() && !DisplayModel::is_one(&text) {
        return Err(miette!(
            "{name} is no extended model of a display; expected the --model of a `palpate diagnose` of one"
        ));
    }
    let model = DisplayModel::parse(file, &text)?;
    let (flux, law) = (flux_of(&model, &name, links.most_a)?, fluid_of(&model, &name, &links.law)?);
    if flux.is_none() && law.is_none() {
        return Err(miette!(
            "{name} has no [channel.flux] and no [channel.fluid]: nothing was found of magnet and fluid"
        ));
    }
    let flux = flux.unwrap_or_else(|| links.flux.clone());
    let most_a = links.most_a.min(flux.most_a());
    Ok(Links { magnet: name, flux, law: law.unwrap_or_else(|| links.law.clone()), most_a, ..links.clone() })
}

/// The extended model of a display, if the file is one.
fn displayed(file: &Path) -> miette::Result<Option<DisplayModel>> {
    let text = if file.is_file() { std::fs::read_to_string(file).unwrap_or_default() } else { String::new() };
    Ok(if DisplayModel::is_one(&text) { Some(DisplayModel::parse(file, &text)?) } else { None })
}

fn flux_of(model: &DisplayModel, name: &str, most_a: f64) -> miette::Result<Option<FluxCurve>> {
    model.flux_curve(most_a).transpose().into_diagnostic().wrap_err_with(|| format!("the flux of {name}"))
}

fn fluid_of(model: &DisplayModel, name: &str, law: &Fluid) -> miette::Result<Option<Fluid>> {
    model.fluid(law).transpose().into_diagnostic().wrap_err_with(|| format!("the fluid of {name}"))
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
