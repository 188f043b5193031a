//! A finger's press as pictures: force and area (Figs. 38, 42, 44, 45, 48), pressure along the contact (46, 47), Mises stress
//! (55, 56) and its averages (57).

mod map;

use lut_gen::pad::body::section::Section;
use lut_gen::pad::ellipse::Print;
use lut_gen::pad::state::State;

use super::figure::{Axis, Figure, Series, Stroke};
use super::number;
use crate::finger::press::Pressed;
use crate::finger::prints;
use crate::finger::reading::{BIN_MPA, Reading, profile};

pub use map::map;

/// Curves of a figure over the contact or the stress: more are hard to tell apart.
const CURVES: usize = 4;

/// A quantity of a reading.
type Of = fn(&Reading) -> f64;

fn curve(name: &str, readings: &[Reading], of: [Of; 2], style: usize) -> Series {
    let points = readings.iter().map(|r| (of[0](r), of[1](r)));
    let from_rest = std::iter::once((0.0, 0.0)).chain(points.filter(|p| p.0 > 0.0));
    Series::new(name, from_rest.collect(), Stroke::LINES[style % Stroke::LINES.len()], style)
}

fn area_unit(section: Section) -> (&'static str, &'static str) {
    match section {
        Section::Ring => ("area (mm^2)", "force (N)"),
        Section::Plane => ("width (mm)", "force (N per mm of length)"),
    }
}

/// Force over the travel of the bone, and beside it that of the thesis' sphere where there is one (N).
pub fn force(section: Section, readings: &[Reading], sphere_n: Option<&[f64]>) -> Figure {
    let title = "Force over the bone's travel, simulated";
    let mut figure = Figure::new(title, Axis::new("travel of the bone (mm)"), Axis::new(area_unit(section).1))
        .with(curve("finger", readings, [|r| r.travel_mm, |r| r.force_n], 0));
    if let Some(sphere) = sphere_n {
        let points = readings.iter().zip(sphere).map(|(r, n)| (r.travel_mm, *n));
        let from_rest = std::iter::once((0.0, 0.0)).chain(points).collect();
        figure = figure.with(Series::new("Hertz' sphere", from_rest, Stroke::Dashed, 1));
    }
    figure
}

/// Contact areas over the travel: flat print, curved contact, and of two radii where they are asked for.
pub fn area(section: Section, readings: &[Reading], two: Option<&[Print]>) -> Figure {
    let title = "Contact over the bone's travel, simulated";
    let mut figure = Figure::new(title, Axis::new("travel of the bone (mm)"), Axis::new(area_unit(section).0))
        .with(curve("flat print", readings, [|r| r.travel_mm, |r| r.print_mm2], 0))
        .with(curve("curved", readings, [|r| r.travel_mm, |r| r.area_mm2], 1));
    if let Some(prints) = two {
        let points = readings.iter().zip(prints).map(|(r, print)| (r.travel_mm, print.area_mm2));
        let from_rest = std::iter::once((0.0, 0.0)).chain(points).collect();
        figure = figure.with(Series::new("two radii", from_rest, Stroke::DashDotted, 2));
    }
    figure
}

/// Contact area over force (Figs. 38 and 48).
pub fn area_over_force(section: Section, readings: &[Reading], two: Option<&[Print]>) -> Figure {
    let (area, force) = area_unit(section);
    let mut figure = Figure::new("Contact over force, simulated", Axis::new(force), Axis::new(area)).with(curve(
        "curved",
        readings,
        [|r| r.force_n, |r| r.area_mm2],
        0,
    ));
    if let Some(prints) = two {
        let points = readings.iter().zip(prints).map(|(r, print)| (r.force_n, print.area_mm2));
        let from_rest = std::iter::once((0.0, 0.0)).chain(points).collect();
        figure = figure.with(Series::new("two radii", from_rest, Stroke::DashDotted, 2));
    }
    figure
}

/// Areas of prints over force: measured, of the finger as it was and of the one that fits.
pub fn prints(prints: &[prints::Print], fit: &prints::Fit) -> Figure {
    let curve = |areas: &[f64]| {
        let mut points: Vec<(f64, f64)> =
            prints.iter().zip(areas).map(|(print, area)| (print.force_n, *area)).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        points
    };
    let measured = prints.iter().map(|print| (print.force_n, print.area_mm2)).collect();
    Figure::new("Prints over force", Axis::new("force (N)"), Axis::new("area of the print (mm^2)"))
        .with(Series::new("as it was", curve(&fit.area_before_mm2), Stroke::Dashed, 1))
        .with(Series::new("fitted", curve(&fit.area_mm2), Stroke::Solid, 0))
        .with(Series::new("measured", measured, Stroke::Circles, 5))
}

/// Depth of the cap and of the block's surface over the travel (Fig. 42).
pub fn depth(readings: &[Reading]) -> Figure {
    Figure::new("Depth of the cap, simulated", Axis::new("travel of the bone (mm)"), Axis::new("depth (mm)"))
        .with(curve("block pressed in", readings, [|r| r.travel_mm, |r| r.depression_mm], 1))
        .with(curve("cap", readings, [|r| r.travel_mm, |r| r.cap_mm], 0))
}

/// Radius of the sphere whose cap the contact would be, `A / (2 pi c)` (Eq. 31, Fig. 44).
pub fn sphere(readings: &[Reading]) -> Figure {
    let of = |r: &Reading| (r.travel_mm, r.area_mm2 / (std::f64::consts::TAU * r.cap_mm));
    let points = readings.iter().filter(|r| r.cap_mm > 0.0).map(of).collect();
    let title = "Radius of the sphere that the contact is taken for";
    Figure::new(title, Axis::new("travel of the bone (mm)"), Axis::new("radius (mm)")).with(Series::new(
        "",
        points,
        Stroke::Solid,
        0,
    ))
}

/// Some of the states, the last among them, evenly over their list.
fn some(count: usize) -> Vec<usize> {
    let wanted = count.min(CURVES);
    (1..=wanted).map(|i| i * count / wanted - 1).collect()
}

/// Pressures are drawn from 0 up to a little more than the highest.
const ROOM: f64 = 1.05;

/// Pressure along the contact, and the vertical force that a millimetre of it bears (Figs. 46 and 47).
pub fn along(pressed: &Pressed) -> [Figure; 2] {
    let from = Axis::new("distance from the axis (mm)");
    let bears = match pressed.section {
        Section::Ring => "force (N per mm of radius)",
        Section::Plane => "force (N per mm of width and length)",
    };
    let most = pressed.states.iter().flat_map(|state| profile(pressed, state)).map(|part| part[1]).fold(0.0, f64::max);
    let up = Axis::new("pressure (kPa)").over(0.0, ROOM * 1e3 * most.max(f64::MIN_POSITIVE));
    let mut pressure = Figure::new("Contact pressure, simulated", from.clone(), up);
    let mut force = Figure::new("Vertical contact force, simulated", from, Axis::new(bears));
    for (style, i) in some(pressed.states.len()).into_iter().enumerate() {
        let state = &pressed.states[i];
        let name = format!("{} mm", number(state.travel_mm));
        let stroke = Stroke::LINES[style % Stroke::LINES.len()];
        let profile = profile(pressed, state);
        let points = profile.iter().map(|[x, mpa]| (*x, 1e3 * mpa)).collect();
        pressure = pressure.with(Series::new(&name, points, stroke, style));
        // of the pressure on the slope its vertical part over the horizontal width: the slope cancels
        let points = profile.iter().map(|[x, mpa]| (*x, mpa * pressed.section.depth_mm(*x))).collect();
        force = force.with(Series::new(&name, points, stroke, style));
    }
    [pressure, force]
}

/// Mises stress of the block's nodes in bins of 1 kPa (Fig. 56).
pub fn histogram(readings: &[Reading]) -> Figure {
    let title = "Mises stress of the block's nodes, in bins of 1 kPa, simulated";
    let mut figure = Figure::new(title, Axis::new("Mises stress (kPa)"), Axis::new("nodes (%)"));
    for (style, i) in some(readings.len()).into_iter().enumerate() {
        let Some(mises) = &readings[i].mises else { continue };
        let all: usize = mises.bins.iter().sum();
        let bin = |(at, count): (usize, &usize)| {
            let (from, part) = (1e3 * BIN_MPA * at as f64, 100.0 * *count as f64 / all as f64);
            [(from, part), (from + 1e3 * BIN_MPA, part)]
        };
        let points = mises.bins.iter().enumerate().flat_map(bin).collect();
        let name = format!("{} mm", number(readings[i].travel_mm));
        figure = figure.with(Series::new(&name, points, Stroke::LINES[style % Stroke::LINES.len()], style));
    }
    figure
}

/// Averages of the block's Mises stress over the travel (Fig. 57).
pub fn averages(readings: &[Reading]) -> Figure {
    let title = "Averages of the block's Mises stress, simulated";
    let figure = Figure::new(title, Axis::new("travel of the bone (mm)"), Axis::new("Mises stress (kPa)"));
    let kinds: [(&str, Of); 4] = [
        ("mean of nodes", |r| r.mises.as_ref().map_or(f64::NAN, |m| 1e3 * m.nodes.mean)),
        ("median of nodes", |r| r.mises.as_ref().map_or(f64::NAN, |m| 1e3 * m.nodes.median)),
        ("geometric mean", |r| r.mises.as_ref().map_or(f64::NAN, |m| 1e3 * m.nodes.geometric)),
        ("mean of volume", |r| r.mises.as_ref().map_or(f64::NAN, |m| 1e3 * m.volume_mean_mpa)),
    ];
    kinds
        .into_iter()
        .enumerate()
        .fold(figure, |figure, (style, (name, of))| figure.with(curve(name, readings, [|r| r.travel_mm, of], style)))
}

/// What the map shows, with its numbers.
pub fn caption(state: &State, on_block: bool) -> String {
    let what = if on_block { "Bands: Mises stress of the block" } else { "Bands: Mises stress of the finger" };
    format!(
        "Simulated. {what}; thin lines: elements, mirrored at the axis; thick: skin, bone and the bodies' outlines. {} mm of travel, {} N.",
        number(state.travel_mm),
        number(state.force_n)
    )
}
