//! Presses on the display as pictures: force over shaft or travel (Figs. 82-86), forces and shaft over time (Figs. 64, 80).

use super::figure::{Axis, Figure, Series, Stroke};
use crate::control::Row;
use crate::feel::{Display, Felt, Sample};

/// Figures of a material on a display: name for a file, figure, caption.
pub fn figures(felt: &Felt) -> Vec<(&'static str, Figure, &'static str)> {
    match felt.display {
        Display::Actuator => vec![
            (
                "force",
                loops(felt, "shaft (mm)", |s| s.shaft_mm, |row| row.shaft_mm),
                "Force over the shaft, down and up, beside the material (Figs. 82 to 86).",
            ),
            ("shaft", shaft(felt), "Shaft in the slow press: where the board wants it, and where it is (Fig. 80)."),
        ],
        Display::Fluid | Display::FluidAtPlace => vec![
            (
                "force",
                loops(felt, "travel of the bone (mm)", |s| s.bone_mm, |row| row.travel_mm),
                "Force over the bone's travel, down and up, beside the material. On the way up a fluid lets go.",
            ),
            (
                "time",
                time(felt),
                "Force of the display in the slow press, and that of the material at the same travel (Fig. 64).",
            ),
        ],
    }
}

fn loops(felt: &Felt, x: &str, of: fn(&Sample) -> f64, material: fn(&Row) -> f64) -> Figure {
    let title = format!("{} on the display, {}", felt.curve.material, if felt.is_read { "read" } else { "simulated" });
    let mut figure = Figure::new(&title, Axis::new(x), Axis::new("force (N)"));
    let points = felt.curve.rows.iter().map(|row| (material(row), row.force_n)).collect();
    figure = figure.with(Series::new("material", points, Stroke::Circles, 5));
    for (i, press) in felt.presses.iter().enumerate() {
        let points = press.samples.iter().filter(|s| s.force_n > 0.0).map(|s| (of(s), s.force_n)).collect();
        figure = figure.with(Series::new(press.pace.name(), points, Stroke::LINES[i % Stroke::LINES.len()], i));
    }
    figure
}

fn slow(felt: &Felt) -> &[Sample] {
    felt.presses.first().map_or(&[], |press| &press.samples)
}

fn over_time(felt: &Felt, of: impl Fn(&Sample) -> Option<f64>) -> Vec<(f64, f64)> {
    slow(felt).iter().filter_map(|s| Some((s.time_s, of(s)?))).collect()
}

fn shaft(felt: &Felt) -> Figure {
    let title = if felt.is_read { "Shaft, read" } else { "Shaft, simulated" };
    Figure::new(title, Axis::new("time (s)"), Axis::new("shaft (mm)"))
        .with(Series::new("wanted", over_time(felt, |s| Some(s.target_mm)), Stroke::Dashed, 1))
        .with(Series::new(
            if felt.is_read { "read" } else { "true" },
            over_time(felt, |s| Some(s.shaft_mm)),
            Stroke::Solid,
            0,
        ))
}

fn time(felt: &Felt) -> Figure {
    let material = over_time(felt, |s| felt.curve.force_at_travel(s.bone_mm).filter(|_| s.bone_mm > 0.0));
    let title = if felt.is_read { "Force, read" } else { "Force, simulated" };
    Figure::new(title, Axis::new("time (s)"), Axis::new("force (N)"))
        .with(Series::new("material", material, Stroke::Dashed, 1))
        .with(Series::new("display", over_time(felt, |s| Some(s.force_n)), Stroke::Solid, 0))
}
