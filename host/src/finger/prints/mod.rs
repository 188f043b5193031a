//! Prints of a finger that were measured: contact area over force on a rigid plate, and what they say of the pad
//! (thesis section 4.1.2, where prints of ink are ellipses).

mod curve;
mod fit;
mod scaled;

use crate::experiment::{Experiment, Run, Test};

pub use fit::{EDGE_MM, Fit, Fitted, Free, Unfitted, fit};
pub use scaled::{Scale, scaled};

/// Columns of a print: its force, and either its area or the radii of its ellipse.
pub const COLUMNS: [&str; 4] = ["force_N", "area_mm2", "a_mm", "b_mm"];

/// One print.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Print {
    /// Force, N, more than 0.
    pub force_n: f64,
    /// Area of the print, mm2, more than 0.
    pub area_mm2: f64,
    /// Radii of its ellipse, mm; `None` where only the area was measured.
    pub radii_mm: Option<[f64; 2]>,
    /// Number of its file.
    pub file: usize,
}

/// Why prints cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Unusable {
    /// No run is one.
    #[error(
        "{0} has no run with test = \"print\"; expected at least one, with columns force_N and area_mm2, or force_N, a_mm and b_mm"
    )]
    None(String),
    /// A column is missing.
    #[error(
        "{file}: no columns area_mm2, or a_mm and b_mm; name them in [columns], such as area_mm2 = \"area\" (found {found})"
    )]
    Missing {
        /// The file.
        file: String,
        /// Columns that are there.
        found: String,
    },
    /// Area and radii at once.
    #[error("{file}: columns area_mm2 and a_mm, b_mm; expected the area or the radii of a print, not both")]
    Both {
        /// The file.
        file: String,
    },
    /// A cell that is no measure of a print.
    #[error("{file}, line {line}, column {column}: {value}; expected a number above 0")]
    Cell {
        /// The file.
        file: String,
        /// The line, from 1.
        line: usize,
        /// The column.
        column: &'static str,
        /// What was read; NaN where no number stands.
        value: f64,
    },
}

/// The prints of an experiment, in the order of its runs.
///
/// # Errors
/// [`Unusable`]: the first mistake.
pub fn of(experiment: &Experiment) -> Result<Vec<Print>, Unusable> {
    let runs = experiment.runs.iter().filter(|run| run.test == Test::Print);
    let mut prints = Vec::new();
    for (file, run) in runs.enumerate() {
        let radii = [run.recording.column(COLUMNS[2]), run.recording.column(COLUMNS[3])];
        let force_n = run.recording.column(COLUMNS[0]).unwrap_or_default();
        let area = run.recording.column(COLUMNS[1]);
        let each = |at: usize| -> Result<Print, Unusable> {
            let positive = |column: &'static str, values: &[f64]| positive(run, column, values, at);
            let (area_mm2, radii_mm) = match (area, radii) {
                (Some(area), [None, None]) => (positive(COLUMNS[1], area)?, None),
                (None, [Some(a), Some(b)]) => {
                    let radii = [positive(COLUMNS[2], a)?, positive(COLUMNS[3], b)?];
                    (std::f64::consts::PI * radii[0] * radii[1], Some(radii))
                }
                (Some(_), _) => return Err(Unusable::Both { file: run.file.clone() }),
                _ => {
                    let found = run.recording.others.keys().cloned().collect::<Vec<_>>().join(", ");
                    return Err(Unusable::Missing { file: run.file.clone(), found });
                }
            };
            Ok(Print { force_n: positive(COLUMNS[0], force_n)?, area_mm2, radii_mm, file })
        };
        for at in 0..run.recording.len() {
            prints.push(each(at)?);
        }
    }
    if prints.is_empty() {
        return Err(Unusable::None(experiment.folder.display().to_string()));
    }
    Ok(prints)
}

fn positive(run: &Run, column: &'static str, values: &[f64], at: usize) -> Result<f64, Unusable> {
    let value = values.get(at).copied().unwrap_or(f64::NAN);
    if value > 0.0 && value.is_finite() {
        return Ok(value);
    }
    let line = run.recording.line.get(at).copied().unwrap_or(0);
    Err(Unusable::Cell { file: run.file.clone(), line, column, value })
}

/// Ratio of the second radius to the first, the mean over all prints with radii; `None` without any.
#[must_use]
pub fn ratio(prints: &[Print]) -> Option<f64> {
    let ratios: Vec<f64> = prints.iter().filter_map(|print| print.radii_mm.map(|[a, b]| (b / a).ln())).collect();
    (!ratios.is_empty()).then(|| (ratios.iter().sum::<f64>() / ratios.len() as f64).exp())
}
