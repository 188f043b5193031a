//! The tables of the board, one for each rate (thesis section 3.2.6).

use lut_gen::solid::model::{Resolution, Specimen};
use lut_gen::table::{ForceGrid, Form, GridSpec, LutError, foams, library, write};

use super::BALL;
use super::foam::{relaxes, relaxing_n};

/// Rates of the thesis' palpations, mm/s.
pub const RATES_MM_S: [f64; 3] = [1.0, 2.0, 4.0];

/// One table for each of [`RATES_MM_S`]: the thesis' 30 x 30 grid at the foams' three heights, elastic and thus the same at
/// every rate, and a library of the four foams and four dummies with B1's curve of that rate. `solved(done, total)` tells how
/// far the solves of the grids are.
///
/// # Errors
/// The first solve that fails, or what the writer refuses.
pub fn tables(resolution: Resolution, solved: &(dyn Fn(usize, usize) + Send + Sync)) -> Result<Vec<Vec<u8>>, LutError> {
    let all = foams();
    let failed = |name: &str| {
        let name = name.to_owned();
        |source| LutError::Material { name, source }
    };
    let mut heights: Vec<f64> = all.iter().map(|f| f.height_mm).collect();
    heights.sort_by(f64::total_cmp);
    heights.dedup();
    let mut grids = Vec::new();
    for (i, height_mm) in heights.iter().enumerate() {
        let spec = GridSpec { resolution, ..GridSpec::thesis(Specimen::of_height(*height_mm), BALL) };
        let progress = |done: usize, total: usize| solved(i * total + done, heights.len() * total);
        grids.push(ForceGrid::build(&spec, &progress).map_err(failed("grid"))?);
    }
    let spec = grids.first().ok_or(LutError::Empty)?.spec.clone();
    let elastic = library(&all, &spec)?;
    let mut named = vec![elastic; RATES_MM_S.len()];
    for (place, foam) in all.iter().enumerate().filter(|(_, foam)| relaxes(foam)) {
        let forces = relaxing_n(foam, &spec.depth_mm, resolution).map_err(failed(foam.name))?;
        for (library, force_n) in named.iter_mut().zip(forces) {
            library[place].force_n = force_n;
        }
    }
    named.into_iter().map(|library| write(&grids, Form::Factored, library)).collect()
}
