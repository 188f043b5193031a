//! Figures of the demo.

use protocol::lut::{Table, axis_name};
use protocol::message::Estimate;

use super::{Palpated, Summary};
use crate::plant::Foam;
use crate::report::figure::{Axis, Figure, Series, Stroke};

/// The last palpation of each foam, in the order of the foams.
fn one_of_each<'a>(summary: &'a Summary, foams: &[Foam]) -> Vec<(usize, &'a Palpated)> {
    foams
        .iter()
        .enumerate()
        .filter_map(|(i, foam)| Some((i, summary.palpated.iter().rev().find(|p| p.truth == foam.name)?)))
        .collect()
}

/// Force over depth of one palpation of each foam: true curve, readings, and the library curve the board chose.
pub(super) fn force_over_depth(summary: &Summary, foams: &[Foam], table: &Table<'_>) -> Figure {
    let mut figure = Figure::new(
        "One palpation of each foam, and what the board made of it",
        Axis::new("depth below the surface (mm)").over(0.0, summary.options.depth_mm),
        Axis::new("force (N)"),
    );
    for (i, p) in one_of_each(summary, foams) {
        let readings = p.trace.iter().filter(|t| t.pressing);
        let points = readings.map(|t| (t.true_depth_mm, t.sensor_force_n)).collect();
        figure.series.push(Series::new("", points, Stroke::Circles, i));
        let material = table.material(usize::from(p.verdict.material.index));
        let chosen = (1..=200).filter_map(|k| {
            let depth_mm = table.depth_max_mm() * k as f32 / 200.0;
            let force_n = material?.force_n(table.locate(depth_mm)?);
            Some((f64::from(depth_mm), f64::from(force_n)))
        });
        let name = if p.identified.is_empty() { "none" } else { &p.identified };
        let label = format!("{} taken for {name}", p.truth);
        figure.series.push(Series::new(&label, chosen.collect(), Stroke::LINES[i % 4], i));
    }
    figure
}

/// Parameters of every palpation with their standard errors, in the plane of the parameters.
pub(super) fn parameter_plane(summary: &Summary, foams: &[Foam], table: &Table<'_>) -> Figure {
    let low = table.axis(axis_name::MU).map_or(1e-3, |a| f64::from(a.value(0)));
    let mut figure = Figure::new(
        "Parameters as the board states them, and the true ones",
        Axis::new("alpha").over(0.0, 25.0),
        Axis::new("mu (MPa)").over(low.max(2e-3), 0.4).logarithmic(),
    );
    for (i, foam) in foams.iter().enumerate() {
        let of_foam = summary.palpated.iter().filter(|p| p.truth == foam.name);
        let found: Vec<&Estimate> = of_foam.filter_map(|p| p.estimate.as_ref()).collect();
        let points = found.iter().map(|e| (f64::from(e.alpha), f64::from(e.mu_mpa))).collect();
        figure.series.push(Series::new("", points, Stroke::Circles, i));
        let bars = found.iter().flat_map(|e| bars(e)).collect();
        figure.series.push(Series::new("", bars, Stroke::Faint, i));
        figure.series.push(Series::new(&foam.name, cross(foam), Stroke::Solid, i));
    }
    figure
}

/// One standard error to either side of an estimate; a point that is not finite lifts the pen.
fn bars(e: &Estimate) -> [(f64, f64); 6] {
    let [a, m, by_a, by_m] = [e.alpha, e.mu_mpa, e.alpha_error, e.mu_error_mpa].map(f64::from);
    let lift = (f64::NAN, f64::NAN);
    // The axis of mu is logarithmic.
    [(a - by_a, m), (a + by_a, m), lift, (a, (m - by_m).max(0.1 * m)), (a, m + by_m), lift]
}

/// A cross at the true parameters; a point that is not finite lifts the pen.
fn cross(foam: &Foam) -> Vec<(f64, f64)> {
    let (a, m) = (foam.alpha, foam.mu_mpa);
    vec![(a, m / 1.25), (a, m * 1.25), (f64::NAN, f64::NAN), (a - 0.7, m), (a + 0.7, m)]
}

/// The search as it goes: error of the best column over depth.
pub(super) fn search_over_depth(summary: &Summary, foams: &[Foam]) -> Figure {
    let mut figure = Figure::new(
        "The search while the ball goes in: error of the best column so far",
        Axis::new("depth after contact (mm)").over(0.0, summary.options.depth_mm),
        Axis::new("mean difference (N)").logarithmic(),
    );
    for (i, p) in one_of_each(summary, foams) {
        let points = p.trace.iter().filter(|t| t.pressing && t.search_error_n > 0.0);
        let points = points.map(|t| (t.belief_depth_mm, t.search_error_n)).collect();
        figure.series.push(Series::new(&p.truth, points, Stroke::LINES[i % 4], i));
    }
    figure
}

/// One palpation over time: what is true, what is read, what is believed.
pub(super) fn palpation_over_time(palpated: &Palpated) -> [Figure; 2] {
    let start_s = palpated.trace.first().map_or(0.0, |t| t.time_s);
    let series = |value: fn(&super::TracePoint) -> f64| -> Vec<(f64, f64)> {
        palpated.trace.iter().map(|t| (t.time_s - start_s, value(t))).collect()
    };
    let title = |what: &str| format!("Palpation {} ({}): {what}", palpated.number, palpated.truth);
    let force = Figure::new(&title("force"), Axis::new("time (s)"), Axis::new("force (N)"))
        .with(Series::new("read", series(|t| t.sensor_force_n), Stroke::Circles, 1))
        .with(Series::new("true", series(|t| t.true_force_n), Stroke::Solid, 0));
    let depth = Figure::new(&title("depth"), Axis::new("time (s)"), Axis::new("depth (mm)"))
        .with(Series::new("believed", series(|t| t.belief_depth_mm), Stroke::Dashed, 1))
        .with(Series::new("true", series(|t| t.true_depth_mm), Stroke::Solid, 0));
    [force, depth]
}

/// The display over time: force, shaft and current, each as true, read and wanted.
pub(super) fn display_over_time(summary: &Summary) -> [Figure; 3] {
    let trace = &summary.displayed.trace;
    let series = |value: fn(&super::DisplayTrace) -> f64| -> Vec<(f64, f64)> {
        trace.iter().map(|t| (t.time_s, value(t))).collect()
    };
    let title = |what: &str| format!("{} displayed to a finger: {what}", summary.displayed.material);
    let time = || Axis::new("time (s)");
    [
        Figure::new(&title("force"), time(), Axis::new("force (N)"))
            .with(Series::new("true", series(|t| t.true_force_n), Stroke::Solid, 0))
            .with(Series::new("FSR", series(|t| t.sensor_force_n), Stroke::Dashed, 1)),
        Figure::new(&title("shaft"), time(), Axis::new("position (mm)"))
            .with(Series::new("material", series(|t| t.material_mm), Stroke::Faint, 5))
            .with(Series::new("target", series(|t| t.target_mm), Stroke::Dotted, 2))
            .with(Series::new("read", series(|t| t.sensor_shaft_mm), Stroke::Dashed, 1))
            .with(Series::new("true", series(|t| t.true_shaft_mm), Stroke::Solid, 0)),
        Figure::new(&title("coil current"), time(), Axis::new("current (A)"))
            .with(Series::new("target", series(|t| t.target_a), Stroke::Dotted, 2))
            .with(Series::new("read", series(|t| t.sensor_a), Stroke::Dashed, 1))
            .with(Series::new("true", series(|t| t.true_a), Stroke::Solid, 0)),
    ]
}

/// Palpation and display in the same ticks: the probe's force, and the shaft under the finger.
pub(super) fn both_over_time(summary: &Summary) -> [Figure; 2] {
    let ticks = &summary.together.ticks;
    let series = |value: fn(&super::Tick) -> f64| -> Vec<(f64, f64)> {
        ticks.iter().map(|tick| (tick.time_s, value(tick))).collect()
    };
    let foams: Vec<&str> = summary.together.foams.iter().map(|foam| foam.truth.as_str()).collect();
    let pressed = format!("Under the probe: {}", foams.join(", "));
    let verdicts = summary.together.foams.iter().map(|foam| (foam.verdict_s, 0.0)).collect();
    [
        Figure::new(&pressed, Axis::new("time (s)"), Axis::new("force (N)"))
            .with(Series::new("probe", series(|t| t.probe_n), Stroke::Solid, 0))
            .with(Series::new("verdicts", verdicts, Stroke::Circles, 1)),
        Figure::new("Under the finger", Axis::new("time (s)"), Axis::new("shaft (mm), force (N)"))
            .with(Series::new("shaft", series(|t| t.shaft_mm), Stroke::Solid, 0))
            .with(Series::new("finger", series(|t| t.finger_n), Stroke::Dotted, 1)),
    ]
}

/// Force over shaft position: what the finger feels against what the material would do.
pub(super) fn felt_softness(summary: &Summary) -> Figure {
    let trace = &summary.displayed.trace;
    let mut material: Vec<(f64, f64)> = trace.iter().map(|t| (t.material_mm, t.true_force_n)).collect();
    material.sort_by(|a, b| a.1.total_cmp(&b.1));
    Figure::new(
        &format!("{} as the finger feels it", summary.displayed.material),
        Axis::new("position of the cap (mm)"),
        Axis::new("force of the finger (N)"),
    )
    .with(Series::new("display", trace.iter().map(|t| (t.true_shaft_mm, t.true_force_n)).collect(), Stroke::Circles, 1))
    .with(Series::new("material", material, Stroke::Solid, 0))
}
