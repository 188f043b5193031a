//! The demo's table: three heights, 30 x 30 parameters, 200 depths, four foams and four dummy curves.

use lut_gen::solid::contact::Ball;
use lut_gen::solid::model::Specimen;
use lut_gen::table::{Foam, ForceGrid, Form, GridSpec, foams, library, write};

use crate::control::Curves;

use super::{DemoError, Stage, Watcher};

/// Radius of the palpation ball, mm (thesis chapter 3 as DESIGN reads it).
pub const BALL_RADIUS_MM: f64 = 4.0;

/// Computes the table of the four foams' heights, with the control curves that come with the program.
///
/// # Errors
/// [`DemoError`] when a solve fails.
pub fn demo_table(watch: Watcher<'_>) -> Result<Vec<u8>, DemoError> {
    demo_table_with(&Curves::default(), watch)
}

/// The same, where these control curves take the place of the program's.
///
/// # Errors
/// [`DemoError`] when a solve fails, or a curve is of no foam.
pub fn demo_table_with(control: &Curves, watch: Watcher<'_>) -> Result<Vec<u8>, DemoError> {
    let materials = foams();
    let ball = Ball { radius_mm: BALL_RADIUS_MM };
    let mut grids = Vec::new();
    for height_mm in heights(&materials) {
        let spec = GridSpec::thesis(Specimen::of_height(height_mm), ball);
        let what = format!("table, height {height_mm} mm");
        let grid = ForceGrid::build(&spec, &|done, total| watch(Stage::Solving { what: &what, done, total }))
            .map_err(|source| DemoError::Solve { what: what.clone(), source })?;
        grids.push(grid);
    }
    let Some(first) = grids.first() else {
        return Err(DemoError::NoLibrary);
    };
    let mut named = library(&materials, &first.spec)?;
    control.give_built_in(&mut named).iter().for_each(|sentence| watch(Stage::Note(sentence)));
    control.give(&mut named)?;
    Ok(write(&grids, Form::Factored, named)?)
}

/// Heights of all foams, rising, each once.
fn heights(materials: &[Foam]) -> Vec<f64> {
    let mut heights: Vec<f64> = materials.iter().map(|f| f.height_mm).collect();
    heights.sort_by(f64::total_cmp);
    heights.dedup();
    heights
}
