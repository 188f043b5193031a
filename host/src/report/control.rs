//! Control curves as pictures: Figs. 57, 58 and 61, the loop, and the way back up.

use lut_gen::pad::control::curve::Curve;
use lut_gen::pad::control::felt::Felt;

use super::figure::{Axis, Figure, Series, Stroke};
use crate::control::ControlCurve;
use crate::control::study::Study;

/// Current over force of every material (Fig. 61).
pub fn currents(curves: &[&ControlCurve]) -> Figure {
    let mut figure = Figure::new("Current of the coil, computed", Axis::new("force (N)"), Axis::new("current (A)"));
    for (i, curve) in curves.iter().enumerate() {
        let (from, to) = curve.reachable_n;
        let rows = |within: bool| {
            let place = |row: &crate::control::Row| (row.force_n, row.current_a);
            curve.rows.iter().filter(|row| (row.force_n >= from && row.force_n <= to) == within).map(place).collect()
        };
        let stroke = Stroke::LINES[i % Stroke::LINES.len()];
        figure = figure.with(Series::new(&curve.material, rows(true), stroke, i));
        let beyond: Vec<(f64, f64)> = rows(false);
        if !beyond.is_empty() {
            figure = figure.with(Series::new("unreachable", beyond, Stroke::Faint, i));
        }
    }
    figure
}

/// Yield stress that materials want over force, and the most that magnets make: a name and kPa each.
pub fn reach(curves: &[ControlCurve], magnets: &[(&str, f64)]) -> Figure {
    let mut figure = Figure::new(
        "Yield stress that is wanted, computed",
        Axis::new("force (N)"),
        Axis::new("shear yield stress (kPa)").logarithmic(),
    );
    let most_n = curves.iter().map(ControlCurve::most_n).fold(0.0, f64::max);
    for (i, curve) in curves.iter().enumerate() {
        let points = curve.rows.iter().filter(|row| row.yield_kpa > 0.0).map(|row| (row.force_n, row.yield_kpa));
        figure = figure.with(Series::new(&curve.material, points.collect(), Stroke::LINES[i % Stroke::LINES.len()], i));
    }
    for (i, (name, most_kpa)) in magnets.iter().enumerate() {
        let label = format!("most of {name}");
        let across = vec![(0.0, *most_kpa), (most_n, *most_kpa)];
        figure = figure.with(Series::new(&label, across, Stroke::Faint, curves.len() + i));
    }
    figure
}

/// All figures of a material, each with its caption.
pub fn figures(study: &Study, curve: &ControlCurve) -> Vec<(Figure, &'static str)> {
    let mut figures = vec![
        (
            stresses(study),
            "Yield stress over travel: the averages of the foam's stress and what was searched (Fig. 57).",
        ),
        (felt(study, "force (N)", |felt| &felt.force_n), "Force of foam and fluid (Fig. 58)."),
        (felt(study, "area (mm2)", |felt| &felt.area_mm2), "Contact area of foam and fluid (Fig. 58)."),
        (currents(&[curve]), "Current over force; the light part is beyond the magnet (Fig. 61)."),
        (gains(curve), "Loop gain over force: at 1 the display latches."),
    ];
    if let Some(both) = &study.cycle {
        let caption = "The finger down and up again while the yield stress follows its force.";
        figures.push((cycle(study, both), caption));
    }
    figures
}

/// What was tried and found, with its stroke: the searched ones unbroken.
fn all(study: &Study) -> Vec<(&str, &Curve, Option<&Felt>)> {
    let tried = study.tried.iter().map(|own| (own.name, &own.curve, own.felt.as_ref().map(|felt| &felt.0)));
    let best = study.best.as_ref().map(|best| ("twelve knots", &best.curve, Some(&best.felt)));
    tried.chain(best).chain([("cubic", &study.cubic.curve, Some(&study.cubic.felt))]).collect()
}

fn stresses(study: &Study) -> Figure {
    let title = "Yield stress of the fluid, computed";
    let mut figure = Figure::new(title, Axis::new("travel (mm)"), Axis::new("yield stress (kPa)"));
    for (i, (name, curve, _)) in all(study).into_iter().enumerate() {
        let points = study.wanted.travel_mm.iter().map(|u| (*u, 1e3 * curve.at(*u))).collect();
        figure = figure.with(Series::new(name, points, stroke(name, i), i));
    }
    figure
}

fn felt(study: &Study, axis: &str, of: fn(&Felt) -> &Vec<f64>) -> Figure {
    let mut figure = Figure::new("What the finger feels, computed", Axis::new("travel (mm)"), Axis::new(axis));
    let points = |felt: &Felt| felt.travel_mm.iter().copied().zip(of(felt).iter().copied()).collect();
    for (i, (name, _, felt)) in all(study).into_iter().enumerate() {
        if let Some(felt) = felt {
            figure = figure.with(Series::new(name, points(felt), stroke(name, i), i));
        }
    }
    figure.with(Series::new("foam", points(&study.wanted), Stroke::Circles, 5))
}

fn stroke(name: &str, i: usize) -> Stroke {
    if name == "cubic" { Stroke::Solid } else { Stroke::LINES[1 + i % (Stroke::LINES.len() - 1)] }
}

fn gains(curve: &ControlCurve) -> Figure {
    let points = curve.rows.iter().map(|row| (row.force_n, row.loop_gain)).collect();
    Figure::new("Loop gain, computed", Axis::new("force (N)"), Axis::new("loop gain").over(0.0, 1.0)).with(Series::new(
        "",
        points,
        Stroke::Solid,
        0,
    ))
}

fn cycle(study: &Study, [down, up]: &[Felt; 2]) -> Figure {
    let points = |felt: &Felt| felt.travel_mm.iter().copied().zip(felt.force_n.iter().copied()).collect();
    Figure::new("Down and up, computed", Axis::new("travel of the finger (mm)"), Axis::new("force down and up (N)"))
        .with(Series::new("down", points(down), Stroke::Solid, 0))
        .with(Series::new("up", points(up), Stroke::Dashed, 1))
        .with(Series::new("foam", points(&study.wanted), Stroke::Circles, 5))
}
