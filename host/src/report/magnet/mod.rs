//! A magnet's field as pictures: the map of Fig. 52, the lines of Fig. 50, the curve over current.

mod map;

use lut_gen::magnet::study::{Flux, State};

use super::Page;
use super::figure::{Axis, Figure, Series, Stroke};
use crate::extended::magnet::Gain;
use crate::magnet::Magnet;
use crate::magnet::search::Candidate;

pub use map::map;

/// What a changed magnet gains on a table of readings.
#[must_use]
pub fn gain(name: &str, gain: &Gain) -> Page {
    let mut page = Page::new(
        &format!("Gain of a changed magnet: {name}"),
        &format!("Errors of both on {} readings. Units: T.", gain.readings),
    );
    page.section("Before and after");
    let row = |law: &str, rms_t: f64| vec![law.to_owned(), super::number(rms_t)];
    let drawn = row("as drawn, its zero fitted to these readings", gain.fitted_base_t);
    page.table(&["magnet", "rms error, T"], &[drawn, row("as the model has it", gain.model_t)]);
    page
}

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

/// Flux density over volume of the magnets of a front, a mark a file, with what is wanted.
pub fn front(names: &[&str], front: &[Candidate], wanted: Option<f64>) -> Figure {
    let title = "The strongest magnets for their size, computed";
    let mut figure = Figure::new(title, Axis::new("box around the magnet (cm^3)"), Axis::new("|B| in the gap (T)"));
    let place = |candidate: &Candidate| (candidate.volume_cm3, candidate.flux.size_t());
    figure = figure.with(Series::new("", front.iter().map(place).collect(), Stroke::Faint, 5));
    for (i, name) in names.iter().enumerate() {
        let own: Vec<(f64, f64)> = front.iter().filter(|candidate| candidate.file == i).map(place).collect();
        if !own.is_empty() {
            figure = figure.with(Series::new(name, own, if i == 0 { Stroke::Dots } else { Stroke::Marks }, i));
        }
    }
    if let (Some(wanted), Some(first), Some(last)) = (wanted, front.first(), front.last()) {
        let line = vec![(first.volume_cm3, wanted), (last.volume_cm3, wanted)];
        figure = figure.with(Series::new("wanted", line, Stroke::Dashed, 1));
    }
    figure
}

/// Flux density and yield stress of a fluid over field strength (Fig. 53), from rows of all three.
pub fn fluid(title: &str, rows: &[[f64; 3]]) -> [Figure; 2] {
    let figure =
        |what: &str, axis: &str, column: usize| {
            let points = rows.iter().map(|row| (row[0], row[column])).collect();
            Figure::new(&format!("{title}: {what}"), Axis::new("field strength (kA/m)"), Axis::new(axis))
                .with(Series::new("", points, Stroke::Solid, 0))
        };
    [figure("flux density", "flux density (T)", 1), figure("yield stress", "yield stress (kPa)", 2)]
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
