//! Displacement tables as a picture (thesis Figs. 70 and 71).

use super::figure::{Axis, Figure, Series, Stroke};
use crate::displacement::Tables;

/// Force over the shaft, down and up.
pub fn branches(one: &Tables) -> Figure {
    let points = |rows: &[(f64, f64)]| rows.iter().map(|(force_n, shaft_mm)| (*shaft_mm, *force_n)).collect();
    let mut figure = Figure::new(&one.loading.material, Axis::new("shaft (mm)"), Axis::new("force of the finger (N)"))
        .with(Series::new("loading", points(&one.loading.rows), Stroke::Solid, 0));
    if let Some(unloading) = &one.unloading {
        figure = figure.with(Series::new("unloading", points(&unloading.rows), Stroke::Dashed, 1));
    }
    figure
}
