//! The picture of a look-up table.

use lut_gen::solid::field::FieldError;
use lut_gen::solid::law::Hyperfoam;
use lut_gen::solid::model::Indentation;
use lut_gen::solid::solve::SolveError;
use lut_gen::table::ForceGrid;

use super::figure::{Axis, Figure, Series, Stroke};
use super::{field, number};

/// Exponents drawn, as shares of the axis.
const SHARES: [f64; 4] = [0.0, 0.2, 0.5, 1.0];

/// Force per mu over depth for a few exponents, one line style a height, as an `<svg>` element.
pub fn sample_curves(grids: &[ForceGrid]) -> String {
    let title = "Force per shear modulus: sample curves of the table";
    let mut figure = Figure::new(title, Axis::new("depth past contact (mm)"), Axis::new("force / mu (N/MPa)"));
    figure.size = (720.0, 460.0);
    for (at, grid) in grids.iter().enumerate() {
        let spec = &grid.spec;
        for (colour, share) in SHARES.iter().enumerate() {
            let column = (share * (spec.alpha.len() - 1) as f64).round() as usize;
            let depths = spec.depth_mm.iter().copied();
            let mut points = vec![(0.0, 0.0)];
            points.extend(depths.zip(grid.force_per_mpa[column].iter().copied()));
            let label = format!("alpha {}, h {} mm", number(spec.alpha[column]), number(spec.specimen.height_mm));
            let stroke = Stroke::LINES[at % Stroke::LINES.len()];
            figure = figure.with(Series::new(&label, points, stroke, colour));
        }
    }
    figure.svg()
}

/// The middle material of a table at its largest depth, as an `<svg>` element: what its curves are made from.
///
/// # Errors
/// When the solve fails, or the material is out of the law's range.
pub fn middle_field(grid: &ForceGrid) -> Result<String, FieldError> {
    let spec = &grid.spec;
    let middle = |axis: &[f64]| axis.get(axis.len() / 2).copied().unwrap_or(f64::NAN);
    let (mu_mpa, alpha) = (middle(&spec.mu_mpa), middle(&spec.alpha));
    let depth_mm = spec.depth_mm.last().copied().unwrap_or(f64::NAN);
    let indentation = Indentation {
        law: Hyperfoam::one_term(mu_mpa, alpha).map_err(SolveError::from)?,
        specimen: spec.specimen,
        ball: spec.ball,
        depth_mm,
        resolution: spec.resolution,
    };
    let title = format!("Middle of the table: mu {} MPa, alpha {}", number(mu_mpa), number(alpha));
    let fields = indentation.fields_at(&[depth_mm])?;
    Ok(fields.iter().map(|inside| field::mises(&title, inside)).collect())
}
