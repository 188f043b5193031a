//! Magnets as files: the drawing of `magnet.toml`, with the points, lines and probes that are read of its field.

mod boundary;
mod builtin;
pub mod circuit;
pub mod expression;
mod file;
pub mod fluid;
mod material;
pub mod measured;
mod part;
pub mod search;
pub mod simulated;
pub mod uncertain;

use lut_gen::magnet::curve::{Built, FluxCurve};
use lut_gen::magnet::design::Design;
use lut_gen::magnet::study::{Flux, State, Wanted};

pub use builtin::{BUILT_IN, BuiltIn, located, names};
pub use file::{parse, read};

/// A magnet, and what is to be read of its field.
#[derive(Debug, Clone, PartialEq)]
pub struct Magnet {
    /// What it is.
    pub title: String,
    /// Where its measures come from, in a sentence; empty if nothing is told.
    pub source: String,
    /// The drawing.
    pub design: Design,
    /// Points, mm.
    pub points: Vec<Named<[f64; 2]>>,
    /// Lines.
    pub lines: Vec<Named<Line>>,
    /// Regions to average over, as a Gauss meter does: their numbers.
    pub probes: Vec<Named<usize>>,
    /// The point or probe whose flux density the control curve is made for.
    pub control: Option<Control>,
    /// What the built magnet has and its drawing has not.
    pub built: Built,
    /// Parameters of the drawing.
    pub parameters: expression::Parameters,
    /// What a built magnet may differ by.
    pub uncertain: Vec<uncertain::Uncertain>,
}

/// A thing with a name.
#[derive(Debug, Clone, PartialEq)]
pub struct Named<T> {
    /// Its name.
    pub name: String,
    /// The thing.
    pub value: T,
}

/// A straight line along which the flux density is read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// Where it begins, mm.
    pub from: [f64; 2],
    /// Where it ends, mm.
    pub to: [f64; 2],
    /// How many points it has, both ends among them.
    pub points: usize,
}

/// Where the flux density of the control curve is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Control {
    /// At a point, by its place in [`Magnet::points`].
    Point(usize),
    /// Over a probe, by its place in [`Magnet::probes`].
    Probe(usize),
}

impl Line {
    /// Its points, mm.
    pub fn positions(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        (0..self.points).map(|i| {
            let place = i as f64 / (self.points - 1) as f64;
            [0, 1].map(|k| self.from[k] + place * (self.to[k] - self.from[k]))
        })
    }

    /// Distance of a point from the beginning, mm.
    pub fn along_mm(&self, i: usize) -> f64 {
        (self.to[0] - self.from[0]).hypot(self.to[1] - self.from[1]) * i as f64 / (self.points - 1) as f64
    }
}

impl Magnet {
    /// The flux density of the control curve at a state, if the magnet says where it is read.
    pub fn controlled(&self, state: &State) -> Option<Flux> {
        Some(match self.control? {
            Control::Point(i) => state.points[i],
            Control::Probe(i) => state.probes[i],
        })
    }

    /// f3: the flux density of the control curve over current; `None` without a coil, where the file
    /// does not say where it is read, and where it does not rise.
    pub fn flux_curve(&self, states: &[State]) -> Option<FluxCurve> {
        let read: Option<Vec<_>> = states.iter().map(|s| Some((s.ampere, self.controlled(s)?))).collect();
        let read = read.filter(|_| !self.design.coils.is_empty())?;
        let error = read.iter().map(|(_, flux)| flux.error_t).fold(0.0, f64::max);
        let mut points: Vec<(f64, f64)> = read.iter().map(|(ampere, flux)| (*ampere, flux.size_t())).collect();
        if points.first().is_some_and(|(ampere, _)| *ampere > 0.0) {
            points.insert(0, (0.0, 0.0));
        }
        FluxCurve::new(&points, error, self.built).ok()
    }

    /// What is wanted of every field: its points, then those of its lines one after the other, and its probes.
    pub fn wanted(&self) -> Wanted {
        let points = self.points.iter().map(|p| p.value);
        Wanted {
            points: points.chain(self.lines.iter().flat_map(|line| line.value.positions())).collect(),
            probes: self.probes.iter().map(|probe| probe.value).collect(),
            coarser: 1.0,
            ..Wanted::default()
        }
    }

    /// Where the points of a line begin among those that are wanted.
    pub fn first_of_line(&self, line: usize) -> usize {
        self.points.len() + self.lines[..line].iter().map(|l| l.value.points).sum::<usize>()
    }
}
