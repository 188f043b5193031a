//! What a channel's law may be wrong by without a name: smooth functions of what a command varies, as a
//! share of the span.
//!
//! | group | over | for |
//! |---|---|---|
//! | level, fine level | what was told, over a quarter of its range, and over a pitch of a twenty-fifth | every run alike |
//! | direction | the level, where it falls | every run alike |
//! | rate | how fast it changes, either way | every run alike |
//! | hold time | the logarithm of the time at rest, by the height of the step before | every run alike |
//! | time in the run | that | every run alike |
//! | command | the time in the run, anew for each command | repeats of it |
//!
//! Beside them gain, zero and time of every run, further than the repeats told: of few repeats that scatter
//! is hardly known, and what it makes of a command's mean is no discrepancy.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::design::{Design, Series};
use super::fit::Problem;
use super::law::Law;
use super::noise::{Jitter, Noise};
use super::sample::{Sample, samples};
use super::whiten::shapes;
use crate::infer::evidence::Sizes;
use crate::infer::process::Shapes;
use crate::infer::sets::{Group, Groups, Kind};

/// Size of a discrepancy, as a share of the span: as often above as below, and a factor of 2.7 to either
/// side. Sensors and drives of a display are sold as good to about a percent.
const SIZE: (f64, f64) = (0.01, 1.0);
/// Correlation lengths: of what all runs share, of a pitch, of a drift, and of one command.
const COMMON: f64 = 0.25;
const PITCH: f64 = 0.04;
const DRIFT: f64 = 0.5;
const COMMAND: f64 = 0.15;
/// Time from which the logarithm of a rest begins, s: a tick.
const TICK_S: f64 = 0.02;

/// Where a sample lies in a group: in [0, 1], from where it begins from nothing, how much of the span it
/// is, and the level that has shapes of its own.
struct Place {
    u: f64,
    from: Option<f64>,
    scale: f64,
    level: usize,
}

type Placed = Box<dyn Fn(&Series, &Sample) -> Option<Place> + Send + Sync>;
/// A group: its name, the length of its shapes, its levels, and where a sample lies.
type Varied = (&'static str, f64, usize, Placed);

/// All groups of a channel, whose scatter from run to run is that of a fit of the base.
#[must_use]
pub fn groups(problem: &Problem<'_>, base: &Law, noise: &Noise) -> Groups {
    let design = problem.design;
    let samples = samples(design);
    let made = |(over, length, levels, place): Varied| {
        let shapes = Shapes::new(length);
        let mut readings = DMatrix::zeros(design.samples(), levels * shapes.len());
        for (s, series) in design.series.iter().enumerate().filter(|(s, _)| problem.used[*s]) {
            for (k, sample) in samples[s].iter().enumerate().filter(|(k, _)| series.compared[*k]) {
                let Some(Place { u, from, scale, level }) = place(series, sample) else { continue };
                for shape in 0..shapes.len() {
                    let before = from.map_or(0.0, |from| shapes.at(shape, from));
                    let value = design.span * scale * (shapes.at(shape, u) - before);
                    readings[(design.first(s) + k, level * shapes.len() + shape)] = value;
                }
            }
        }
        whitened(problem, over, Kind::Misfit, readings)
    };
    let misfits = varied(design, &samples).into_par_iter().map(made);
    let each: Vec<Group> = scatter(problem, base, noise).into_par_iter().chain(misfits).collect();
    let each = each.into_iter().filter(|group| group.columns.amax() > 0.0);
    Groups::new(design.samples(), each.collect(), Sizes::about(SIZE.0, SIZE.1))
}

fn whitened(problem: &Problem<'_>, over: &'static str, kind: Kind, readings: DMatrix<f64>) -> Group {
    let mut columns = readings.clone();
    for mut column in columns.column_iter_mut() {
        let mut own: DVector<f64> = column.clone_owned();
        problem.whitening.apply(&mut own);
        column.copy_from(&own);
    }
    Group { over, kind, readings, columns }
}

/// Part of the sensor's noise below which few repeats do not tell what zero and time of a run scatter by.
const UNTOLD: f64 = 0.25;

/// Gain, zero and time of every run, a column each of the deviation that the repeats told; no less than is expected of a gain,
/// or than they can tell.
fn scatter(problem: &Problem<'_>, base: &Law, noise: &Noise) -> Vec<Group> {
    let design = problem.design;
    let mut told: Vec<(usize, DMatrix<f64>)> = Vec::new();
    for (s, series) in design.series.iter().enumerate().filter(|(s, _)| problem.used[*s]) {
        told.push((s, shapes(design.channel, series, &base.predict(series))));
    }
    let count: usize = told.iter().map(|(s, _)| design.series[*s].count()).sum();
    let group = |(at, (over, deviation, least)): (usize, (&'static str, f64, f64))| {
        let square: f64 = told.iter().map(|(_, own)| own.column(at).norm_squared()).sum();
        let untold = UNTOLD * noise.sensor.sigma / (square / count.max(1) as f64).sqrt();
        let deviation = deviation.max(if least > 0.0 { least } else { untold });
        let mut readings = DMatrix::zeros(design.samples(), told.len());
        for (column, (s, own)) in told.iter().enumerate().filter(|_| square > 0.0) {
            readings.view_mut((design.first(*s), column), (own.nrows(), 1)).copy_from(&(deviation * own.column(at)));
        }
        whitened(problem, over, Kind::Noise, readings)
    };
    let Jitter { gain, zero, slide } = noise.jitter;
    let each = [
        ("gain of a run", gain, design.channel.expected_gain()),
        ("zero of a run", zero, 0.0),
        ("time of a run", slide, 0.0),
    ];
    each.into_iter().enumerate().map(group).collect()
}

fn varied(design: &Design, samples: &[Vec<Sample>]) -> Vec<Varied> {
    let most = |of: &dyn Fn(&Sample) -> f64| samples.iter().flatten().map(of).fold(f64::MIN_POSITIVE, f64::max);
    let steepest = most(&|s| s.rate.abs());
    let longest = most(&|s| late(s.rest_s));
    let place = |u: f64, from: Option<f64>, scale: f64| Some(Place { u, from, scale, level: 0 });
    let commands = design.conditions.len();
    let mut all: Vec<Varied> = vec![
        ("level", COMMON, 1, Box::new(move |_, s| place(s.level, None, 1.0))),
        ("fine level", PITCH, 1, Box::new(move |_, s| place(s.level, None, 1.0))),
        (
            "direction",
            COMMON,
            1,
            Box::new(move |_, s| s.is_falling.then(|| place(s.level, Some(s.turn), 1.0)).flatten()),
        ),
        ("rate", COMMON, 1, Box::new(move |_, s| place(0.5 + 0.5 * s.rate / steepest, Some(0.5), 1.0))),
        ("hold time", COMMON, 1, Box::new(move |_, s| place(late(s.rest_s) / longest, Some(0.0), s.step))),
        ("time in the run", DRIFT, 1, Box::new(move |_, s| place(s.clock, Some(0.0), 1.0))),
    ];
    if commands > 1 {
        let own = move |series: &Series, s: &Sample| {
            Some(Place { u: s.clock, from: None, scale: 1.0, level: series.condition })
        };
        all.push(("command", COMMAND, commands, Box::new(own)));
    }
    all
}

/// Logarithm of a time at rest, in ticks.
fn late(rest_s: f64) -> f64 {
    (rest_s / TICK_S).ln_1p()
}
