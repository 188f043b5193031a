//! From grids to the bytes the board reads (format: `protocol::lut`).

use protocol::lut::{AxisSpec, DisplaySpec, MaterialSpec, Role, Scale, TableSpec, WriteError, axis_name};
use rayon::prelude::*;

use super::grid::{forces_n, problem};
use super::{Foam, ForceGrid, GridSpec, display_displacement_mm};
use crate::solid::model::Specimen;
use crate::solid::solve::SolveError;

/// How the shear modulus is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// One column an exponent; the modulus multiplies ("30-row form").
    Factored,
    /// One column a pair of modulus and exponent ("900-column form" of the thesis).
    Expanded,
}

/// Why grids do not make a table.
#[derive(Debug, thiserror::Error)]
pub enum LutError {
    /// No grid was given.
    #[error("a table needs at least one grid")]
    Empty,
    /// Grids of one table must agree in all but the height.
    #[error("grid of height {height_mm} mm has another {axis} axis or ball than the first grid")]
    Mismatch {
        /// Height of the grid that differs.
        height_mm: f64,
        /// What differs.
        axis: &'static str,
    },
    /// The rates do not rise, or not every rate has the same heights.
    #[error(
        "grids must be sorted by rate, each rate with the same heights, but the one of {rate_mm_s} mm/s and {height_mm} mm is out of place"
    )]
    Rates {
        /// Rate of the offending grid.
        rate_mm_s: f64,
        /// Its height.
        height_mm: f64,
    },
    /// The heights do not rise.
    #[error("grids must be sorted by height, but {height_mm} mm follows {before_mm} mm")]
    Order {
        /// Height of the grid before.
        before_mm: f64,
        /// Height of the offending grid.
        height_mm: f64,
    },
    /// The writer refused.
    #[error("{0}")]
    Write(WriteError),
    /// A library material could not be solved.
    #[error("material {name}: {source}")]
    Material {
        /// Its name.
        name: String,
        /// Why.
        source: SolveError,
    },
}

/// Points of a display curve.
const DISPLAY_POINTS: usize = 64;
/// Force between them (N): the curve ends at 6.4 N, above the load of a pressing finger.
const DISPLAY_STEP_N: f64 = 0.1;

/// Mean absolute difference, as part of the peak force, up to which a palpation
/// counts as a material: 1 % gain and 0.02 mm of contact depth change a curve by
/// about 0.5 and 0.4 % of its peak on average; four times their sum is allowed.
const ACCEPTANCE: f64 = 0.036;

/// Library section for the tables of a grid: every foam's force at the grid's depths, by a solve of its
/// own at its own height, on the grid's base and under its ball, friction and rate; and its display curve.
///
/// # Errors
/// [`LutError::Material`] names the foam whose solve failed.
pub fn library(foams: &[Foam], spec: &GridSpec) -> Result<Vec<MaterialSpec>, LutError> {
    foams
        .par_iter()
        .map(|f| material(f, spec).map_err(|source| LutError::Material { name: f.name.to_owned(), source }))
        .collect::<Vec<_>>()
        .into_iter()
        .collect()
}

fn material(foam: &Foam, spec: &GridSpec) -> Result<MaterialSpec, SolveError> {
    let specimen = Specimen { height_mm: foam.height_mm, ..spec.specimen };
    let curve = problem(&GridSpec { specimen, ..spec.clone() }, foam.mu_mpa, foam.alpha, spec.resolution)?
        .curve(&spec.depth_mm)?;
    let force_n = forces_n(spec, &curve.profile);
    let displacement: Result<Vec<f64>, _> = (1..=DISPLAY_POINTS)
        .map(|i| display_displacement_mm(foam.mu_mpa, foam.alpha, foam.height_mm, DISPLAY_STEP_N * i as f64))
        .collect();
    Ok(MaterialSpec {
        name: foam.name.to_owned(),
        mu_mpa: foam.mu_mpa,
        alpha: foam.alpha,
        height_mm: foam.height_mm,
        acceptance: ACCEPTANCE,
        rate_mm_s: if spec.relaxation.is_empty() { 0.0 } else { spec.rate_mm_s },
        force_n,
        display: DisplaySpec::even(DISPLAY_STEP_N, &displacement?),
    })
}

/// The table of one or more grids (one a rate and height, sorted by rate, then by height) and a library.
/// The rate is an axis if the foams relax; a table of elastic foams serves every rate.
///
/// # Errors
/// [`LutError`] when the grids do not fit together.
pub fn lut(grids: &[ForceGrid], form: Form, library: Vec<MaterialSpec>) -> Result<TableSpec, LutError> {
    let first = grids.first().ok_or(LutError::Empty)?;
    let heights = heights(grids)?;
    for rate in grids.chunks(heights.len()) {
        for (before, grid) in rate.iter().zip(&rate[1..]) {
            fits(first, before, grid)?;
        }
        fits_rate(first, &heights, rate)?;
    }
    let axis = |name: &str, unit: &str, role, values: &[f64]| AxisSpec::new(name, unit, role, spacing(values), values);
    let spec = &first.spec;
    // A single height is an axis as well: the board must know which specimens the table is for.
    let mut axes = vec![
        axis(axis_name::DEPTH, "mm", Role::Row, &spec.depth_mm),
        axis(axis_name::HEIGHT, "mm", Role::Column, &heights),
        axis(axis_name::ALPHA, "", Role::Column, &spec.alpha),
    ];
    if !spec.relaxation.is_empty() {
        let rates: Vec<f64> = grids.iter().step_by(heights.len()).map(|g| g.spec.rate_mm_s).collect();
        axes.insert(1, axis(axis_name::RATE, "mm/s", Role::Column, &rates));
    }
    let role = if form == Form::Factored { Role::Factor } else { Role::Column };
    axes.push(axis(axis_name::MU, "MPa", role, &spec.mu_mpa));
    let stored = grids.iter().flat_map(|g| &g.force_per_mpa);
    let columns = match form {
        Form::Factored => stored.cloned().collect(),
        Form::Expanded => {
            stored.flat_map(|c| spec.mu_mpa.iter().map(move |mu| c.iter().map(|f| mu * f).collect())).collect()
        }
    };
    let worst = |part: fn(&ForceGrid) -> f64| grids.iter().map(part).fold(0.0, f64::max);
    Ok(TableSpec {
        axes,
        columns,
        library,
        discretisation: worst(|g| g.error.discretisation),
        interpolation: worst(|g| g.error.interpolation),
        provenance: grids.iter().map(|g| g.provenance.as_str()).collect::<Vec<_>>().join("\n"),
    })
}

/// The bytes of [`lut`]; the writer adds the quantisation error to the bound.
///
/// # Errors
/// As [`lut`], and [`LutError::Write`].
pub fn write(grids: &[ForceGrid], form: Form, library: Vec<MaterialSpec>) -> Result<Vec<u8>, LutError> {
    lut(grids, form, library)?.to_bytes().map_err(LutError::Write)
}

/// Heights of the grids of the first rate. Every other rate must have as many.
fn heights(grids: &[ForceGrid]) -> Result<Vec<f64>, LutError> {
    let rate = |grid: &ForceGrid| grid.spec.rate_mm_s;
    let relaxing = grids.first().is_some_and(|first| !first.spec.relaxation.is_empty());
    let count = if relaxing { grids.iter().take_while(|g| rate(g) == rate(&grids[0])).count() } else { grids.len() };
    let mut before = f64::NEG_INFINITY;
    for group in grids.chunks(count.max(1)) {
        let rate_mm_s = rate(&group[0]);
        let odd = group.iter().find(|g| relaxing && rate(g) != rate_mm_s);
        if odd.is_some() || group.len() != count || (relaxing && rate_mm_s <= before) {
            let spec = &odd.unwrap_or(&group[0]).spec;
            return Err(LutError::Rates { rate_mm_s: spec.rate_mm_s, height_mm: spec.specimen.height_mm });
        }
        before = rate_mm_s;
    }
    Ok(grids[..count].iter().map(|g| g.spec.specimen.height_mm).collect())
}

/// The grids of one rate have the heights of the first rate, and all relax alike.
fn fits_rate(first: &ForceGrid, heights: &[f64], rate: &[ForceGrid]) -> Result<(), LutError> {
    for (height_mm, grid) in heights.iter().zip(rate) {
        let spec = &grid.spec;
        if spec.specimen.height_mm != *height_mm {
            return Err(LutError::Rates { rate_mm_s: spec.rate_mm_s, height_mm: spec.specimen.height_mm });
        }
        let differs = [
            (spec.relaxation != first.spec.relaxation, "relaxation"),
            (!same_law(&first.spec, spec), "law"),
            (spec.mu_mpa != first.spec.mu_mpa, "mu"),
            (spec.alpha != first.spec.alpha, "alpha"),
            (spec.depth_mm != first.spec.depth_mm || spec.ball != first.spec.ball, "depth"),
        ];
        if let Some((_, axis)) = differs.into_iter().find(|d| d.0) {
            return Err(LutError::Mismatch { height_mm: *height_mm, axis });
        }
    }
    Ok(())
}

/// The columns of two grids are those of one law.
fn same_law(a: &GridSpec, b: &GridSpec) -> bool {
    a.nu == b.nu && a.second == b.second && a.used == b.used
}

fn fits(first: &ForceGrid, before: &ForceGrid, grid: &ForceGrid) -> Result<(), LutError> {
    let (a, b) = (&first.spec, &grid.spec);
    let height_mm = b.specimen.height_mm;
    let differs = [
        (!same_law(a, b), "law"),
        (a.mu_mpa != b.mu_mpa, "mu"),
        (a.alpha != b.alpha, "alpha"),
        (a.depth_mm != b.depth_mm || a.ball != b.ball, "depth"),
    ];
    if let Some((_, axis)) = differs.into_iter().find(|d| d.0) {
        return Err(LutError::Mismatch { height_mm, axis });
    }
    let before_mm = before.spec.specimen.height_mm;
    if height_mm <= before_mm {
        return Err(LutError::Order { before_mm, height_mm });
    }
    Ok(())
}

/// Evenly spaced in the value, in its logarithm, or neither, to 1e-6 of a step.
fn spacing(values: &[f64]) -> Scale {
    let even = |t: &dyn Fn(f64) -> f64| {
        let n = values.len();
        n < 3 || {
            let step = (t(values[n - 1]) - t(values[0])) / (n - 1) as f64;
            values.windows(2).all(|w| ((t(w[1]) - t(w[0])) / step - 1.0).abs() < 1e-6)
        }
    };
    if even(&|v| v) {
        Scale::Linear
    } else if even(&f64::ln) {
        Scale::Logarithmic
    } else {
        Scale::Listed
    }
}
