//! Control curves that a table's own materials get: `palpate lut --make-control`.

use std::path::Path;

use miette::miette;
use protocol::lut::MaterialSpec;

use crate::cli::control_curve::recipe::Recipe;
use crate::cli::progress::Progress;
use crate::control::{ControlCurve, Curves};
use crate::extended::ExtendedModel;
use crate::extended::gain::library_name;
use crate::finger::opposite::Opposite;
use crate::report::number;

/// Makes a curve for every height of every own material that no file gives one.
///
/// # Errors
/// Nothing to make, a file with a mistake, a press without equilibrium, two magnets in one table.
pub(super) fn make(
    (recipe, files, beside_foams): (&Recipe, &[&Path], bool),
    given: &Curves,
    library: &mut [MaterialSpec],
) -> miette::Result<()> {
    if files.is_empty() {
        return Err(miette!("--make-control has no own material; expected --material FILE or --model FILE with it"));
    }
    let progress = Progress::new();
    progress.set("the magnet", 0, 0);
    let recipe = recipe.opened()?;
    let (magnet, fluid) = (&recipe.links.magnet, &recipe.links.fluid);
    // The thesis' foams stand beside a model with curves of their own.
    let built_in = ControlCurve::all_built_in().next().filter(|_| beside_foams);
    let others = built_in.as_ref().map(|curve| (curve.magnet.as_str(), curve.fluid.as_str()));
    if let Some(other) = given.display().or(others).filter(|other| *other != (magnet.as_str(), fluid.as_str())) {
        return Err(miette!(
            "--make-control would be for magnet {magnet} with fluid {fluid}, and other curves of the table are for magnet {} \
             with fluid {}; expected the same, for a display has one of each",
            other.0,
            other.1
        ));
    }
    for file in files {
        let name = library_name(&ExtendedModel::read(file)?.material);
        let mut own: Vec<f64> = library.iter().filter(|one| one.name == name).map(|one| one.height_mm).collect();
        if given.names(&name) {
            continue;
        }
        own.sort_by(f64::total_cmp);
        own.dedup();
        for height_mm in own {
            let Opposite::Block(block) = Opposite::located(&file.display().to_string(), Some(height_mm))? else {
                continue;
            };
            let told = |what: &str, done: usize| {
                progress.set(&format!("{name}, {} mm: {what}", number(height_mm)), done, 0);
            };
            let (_, curve) = recipe.make(&block, &told)?;
            for one in library.iter_mut().filter(|one| one.name == name && one.height_mm == height_mm) {
                one.display = curve.display();
            }
        }
    }
    progress.end();
    Ok(())
}
