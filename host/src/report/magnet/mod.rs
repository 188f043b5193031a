//! A magnet's field as pictures: the map of Fig. 52, the lines of Fig. 50, the curve over current.

mod map;

use lut_gen::magnet::study::{Flux, State};

use super::figure::{Axis, Figure, Series, Stroke};
use crate::magnet::Magnet;

pub use map::map;

/// |B| along every line, at the largest current.
pub fn along(magnet: &Magnet, state: &State) -> Figure {
    let title = format!("Flux density along lines at {} A, computed", super::number(state.ampere));
    let mut figure = Figure::new(&title, Axis::new("distance along the line (mm)"), Axis::new("|B| (T)"));
    for (i, line) in magnet.lines.iter().enumerate() {
        let first = magnet.first_of_line(i);
        let points = (0..line.value.points).map(|k| (line.value.along_mm(k), state.points[first + k].size_t()));
        let stroke = Stroke::LINES[i % Stroke::LINES.len()];
        figure = figure.with(Series::new(&line.name, points.collect(), stroke, i));
    }
    figure
}

/// What is read over current: points and probes.
pub fn over_current(magnet: &Magnet, states: &[State]) -> Figure {
    let title = "Flux density over current, computed";
    let mut figure = Figure::new(title, Axis::new("current (A)"), Axis::new("|B| (T)"));
    for (i, (name, flux)) in names(magnet).into_iter().enumerate() {
        let points = states.iter().map(|state| (state.ampere, flux(state).size_t()));
        let stroke = Stroke::LINES[i % Stroke::LINES.len()];
        figure = figure.with(Series::new(name, points.collect(), stroke, i));
    }
    figure
}

/// Where a reading is found in a state.
type Look<'a> = Box<dyn Fn(&State) -> Flux + 'a>;

/// Names of points and probes, and where their flux density is found in a state.
pub fn names(magnet: &Magnet) -> Vec<(&str, Look<'_>)> {
    let points = magnet.points.iter().enumerate().map(|(i, point)| {
        let look: Look<'_> = Box::new(move |state: &State| state.points[i]);
        (point.name.as_str(), look)
    });
    let probes = magnet.probes.iter().enumerate().map(|(i, probe)| {
        let look: Look<'_> = Box::new(move |state: &State| state.probes[i]);
        (probe.name.as_str(), look)
    });
    points.chain(probes).collect()
}
