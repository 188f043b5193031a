//! The picture of a look-up table.

use lut_gen::table::ForceGrid;

use super::figure::{Axis, Figure, Series, Stroke};
use super::number;

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
