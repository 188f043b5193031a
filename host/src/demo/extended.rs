//! The demo with an extended model: its material lies on the bench beside the four foams, and table and bench have its effects.

use lut_gen::solid::contact::Ball;
use lut_gen::solid::model::{Resolution, Specimen};
use lut_gen::table::{self, ForceGrid, Form, GridSpec, foams, write};
use protocol::lut::MaterialSpec;

use super::foams::{BEYOND_MM, STEP_MM};
use super::{BALL_RADIUS_MM, DemoError, Stage, Watcher};
use crate::control::Curves;
use crate::extended::{ExtendedModel, board};
use crate::plant::{Curve, Foam};

/// Height of the model's specimen where the file declares none, mm.
const HEIGHT_MM: f64 = 12.7;

/// A material on the bench and in the library.
struct Known {
    name: String,
    mu_mpa: f64,
    alpha: f64,
    /// As declared, mm.
    height_mm: f64,
    /// Real ones lie on the bench, the others only make the choice harder.
    real: bool,
}

/// Foams of the demo, and the model's own material. A foam of the same name gives way to it.
fn known(model: &ExtendedModel) -> Vec<Known> {
    let name = crate::extended::gain::library_name(&model.material);
    let thesis = foams().into_iter().filter(|f| f.name != name).map(|f| Known {
        name: f.name.to_owned(),
        mu_mpa: f.mu_mpa,
        alpha: f.alpha,
        height_mm: f.height_mm,
        real: !f.dummy,
    });
    let mut all: Vec<Known> = thesis.collect();
    let height_mm = model.specimens.first().map_or(HEIGHT_MM, |s| s.height_mm);
    all.insert(0, Known { name, mu_mpa: model.mu_mpa, alpha: model.alpha, height_mm, real: true });
    all
}

/// The grid of a declared height with the model's effects.
fn grid(model: &ExtendedModel, height_mm: f64, rate_mm_s: f64) -> Result<GridSpec, DemoError> {
    let ball = Ball { radius_mm: BALL_RADIUS_MM };
    let declared = GridSpec { rate_mm_s, ..GridSpec::thesis(Specimen::of_height(height_mm), ball) };
    Ok(model.on_board(&declared, 1)?.spec)
}

fn entry(one: &Known, spec: &GridSpec) -> Result<MaterialSpec, DemoError> {
    let (mu_mpa, alpha, height_mm) = (one.mu_mpa, one.alpha, spec.specimen.height_mm);
    let foam = table::Foam { name: "foam", mu_mpa, alpha, height_mm, dummy: !one.real };
    let solved = table::library(&[foam], spec)?;
    let solved = solved.into_iter().next().ok_or(DemoError::NoLibrary)?;
    Ok(MaterialSpec { name: one.name.clone(), ..solved })
}

/// The table at one rate, with a library of the thesis' foams and the model's material, all of them with the model's effects.
///
/// # Errors
/// [`DemoError`].
pub(super) fn table(
    model: &ExtendedModel,
    rate_mm_s: f64,
    control: &Curves,
    watch: Watcher<'_>,
) -> Result<Vec<u8>, DemoError> {
    for sentence in told(model, rate_mm_s)? {
        watch(Stage::Note(&sentence));
    }
    let known = known(model);
    let mut specs: Vec<GridSpec> = Vec::new();
    for one in &known {
        let spec = grid(model, one.height_mm, rate_mm_s)?;
        if !specs.contains(&spec) {
            specs.push(spec);
        }
    }
    specs.sort_by(|a, b| a.specimen.height_mm.total_cmp(&b.specimen.height_mm));
    let mut grids = Vec::new();
    for spec in &specs {
        let what = format!("table, height {} mm", spec.specimen.height_mm);
        let grid = ForceGrid::build(spec, &|done, total| watch(Stage::Solving { what: &what, done, total }));
        grids.push(grid.map_err(|source| DemoError::Solve { what: what.clone(), source })?);
    }
    let entries = known.iter().map(|one| entry(one, &grid(model, one.height_mm, rate_mm_s)?));
    let mut library = entries.collect::<Result<Vec<_>, DemoError>>()?;
    // The program's own curves are of the foams without the model's effects.
    control.give(&mut library)?;
    Ok(write(&grids, Form::Factored, library)?)
}

/// What of the model is in the demo and what is not.
fn told(model: &ExtendedModel, rate_mm_s: f64) -> Result<Vec<String>, DemoError> {
    let height_mm = model.specimens.first().map_or(HEIGHT_MM, |s| s.height_mm);
    let ball = Ball { radius_mm: BALL_RADIUS_MM };
    let declared = GridSpec { rate_mm_s, ..GridSpec::thesis(Specimen::of_height(height_mm), ball) };
    let board::OnBoard { kept, left_out, .. } = model.on_board(&declared, 1)?;
    let kept = kept.into_iter().map(|words| format!("in the table      {words}"));
    Ok(kept.chain(left_out.into_iter().map(|words| format!("not in the table  {words}"))).collect())
}

/// The foams of the bench on a finer mesh than the table's, deeper than `depth_mm`.
///
/// # Errors
/// [`DemoError`].
pub(super) fn bench(
    model: &ExtendedModel,
    rate_mm_s: f64,
    depth_mm: f64,
    watch: Watcher<'_>,
) -> Result<Vec<Foam>, DemoError> {
    let known: Vec<Known> = known(model).into_iter().filter(|one| one.real).collect();
    let steps = ((depth_mm + BEYOND_MM) / STEP_MM).round() as usize;
    let mut out = Vec::new();
    for (done, one) in known.iter().enumerate() {
        let spec = GridSpec {
            depth_mm: (1..=steps).map(|i| STEP_MM * i as f64).collect(),
            resolution: Resolution::Fine,
            ..grid(model, one.height_mm, rate_mm_s)?
        };
        let solved = entry(one, &spec)?;
        let curve = Curve::new(STEP_MM, &solved.force_n).ok_or_else(|| DemoError::Curve { name: one.name.clone() })?;
        watch(Stage::Solving { what: "foams of the bench", done: done + 1, total: known.len() });
        let (name, height_mm) = (one.name.clone(), spec.specimen.height_mm);
        out.push(Foam { name, mu_mpa: one.mu_mpa, alpha: one.alpha, height_mm, curve });
    }
    Ok(out)
}
