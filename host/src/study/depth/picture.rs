//! Fig. 11: parameters against depth, and both in one plane with the trends.

use crate::report::figure::{Axis, Figure, Series, Stroke};
use crate::study::Subject;
use crate::study::findings::Picture;
use crate::study::trend::Line;

use super::{Ball, Depths, EARLY_MM, Point, logarithms};

/// Half the width of an interval's end caps, mm, and how far the balls stand apart.
const CAP_MM: f64 = 0.025;
const APART_MM: f64 = 0.05;

/// All pictures of the study.
pub fn all(found: &Depths, subject: &Subject) -> Vec<Picture> {
    let truth = subject.foam.as_ref().map(|foam| [foam.mu_mpa, foam.alpha]);
    let meeting = found.meeting.as_ref().map(|meeting| meeting.value);
    let held = format!("contact points held {EARLY_MM} mm early");
    vec![
        against_depth(found, truth, 1, "alpha", "study-depth-alpha"),
        against_depth(found, truth, 0, "mu (MPa)", "study-depth-mu"),
        plane(
            found,
            truth,
            meeting,
            found.joint.filter(|_| found.balls.len() > 1),
            &|point| point.value,
            "contact points fitted",
            "study-depth-plane",
        ),
        plane(found, truth, found.early_meeting, None, &|point| point.early, &held, "study-depth-early"),
    ]
}

fn against_depth(found: &Depths, truth: Option<[f64; 2]>, at: usize, name: &str, file: &str) -> Picture {
    let mut figure = Figure::new(
        &format!("Identified {} against depth", name.split(' ').next().unwrap_or(name)),
        Axis::new("largest depth used (mm)"),
        Axis::new(name).logarithmic(),
    );
    let depths = || found.balls.iter().flat_map(|ball| ball.points.iter().map(|point| point.depth_mm));
    if let Some(truth) = truth {
        let (low, high) = depths().fold((f64::INFINITY, 0.0_f64), |(l, h), d| (l.min(d), h.max(d)));
        let line = vec![(low - 2.0 * APART_MM, truth[at]), (high + 2.0 * APART_MM, truth[at])];
        figure = figure.with(Series::new("truth", line, Stroke::Dotted, 5));
    }
    for (colour, ball) in found.balls.iter().enumerate() {
        let shift = APART_MM * (colour as f64 - 0.5 * (found.balls.len() - 1) as f64);
        let place = |point: &Point| point.depth_mm + shift;
        let values: Vec<(f64, f64)> = ball.points.iter().map(|p| (place(p), p.value[at])).collect();
        let bars = ball.points.iter().flat_map(|p| bar(place(p), p.interval[at])).collect();
        figure = figure
            .with(Series::new("", bars, Stroke::Solid, colour))
            .with(Series::new("", values.clone(), Stroke::Faint, colour))
            .with(Series::new(&ball.name, values, Stroke::Dots, colour));
    }
    Picture {
        file: file.to_owned(),
        svg: figure.svg(),
        caption: "Each ball alone; bars: 95 % intervals. The balls stand a little apart to be told apart.".to_owned(),
    }
}

/// An interval as an upright line with caps; the point that is no number lifts the pen.
fn bar(x: f64, (low, high): (f64, f64)) -> Vec<(f64, f64)> {
    let pen_up = (f64::NAN, f64::NAN);
    vec![
        (x - CAP_MM, low),
        (x + CAP_MM, low),
        pen_up,
        (x, low),
        (x, high),
        pen_up,
        (x - CAP_MM, high),
        (x + CAP_MM, high),
        pen_up,
    ]
}

fn plane(
    found: &Depths,
    truth: Option<[f64; 2]>,
    meeting: Option<[f64; 2]>,
    joint: Option<[(f64, f64, f64); 2]>,
    of: &dyn Fn(&Point) -> [f64; 2],
    how: &str,
    file: &str,
) -> Picture {
    let mut figure = Figure::new(&format!("Both parameters: {how}"), Axis::new("alpha"), Axis::new("mu (MPa)"));
    for (colour, ball) in found.balls.iter().enumerate() {
        figure = with_ball(figure, ball, of, colour, meeting);
    }
    if let Some([mu, alpha]) = truth {
        figure = figure.with(Series::new("truth", cross(alpha, mu), Stroke::Solid, 5));
    }
    if let Some([mu, alpha]) = meeting {
        figure = figure.with(Series::new("trends meet", diamond(alpha, mu), Stroke::Solid, 3));
    }
    if let Some([(mu, mu_low, mu_high), (alpha, alpha_low, alpha_high)]) = joint {
        let pen_up = (f64::NAN, f64::NAN);
        let bars = vec![(alpha_low, mu), (alpha_high, mu), pen_up, (alpha, mu_low), (alpha, mu_high)];
        figure = figure.with(Series::new("one fit to all", bars, Stroke::Solid, 2));
    }
    Picture {
        file: file.to_owned(),
        svg: figure.svg(),
        caption: format!(
            "Dots: one a depth, joined from shallow to deep, the larger open circle the deepest; dashed: trends, extended to where they meet; {how}."
        ),
    }
}

fn with_ball(
    figure: Figure,
    ball: &Ball,
    of: &dyn Fn(&Point) -> [f64; 2],
    colour: usize,
    meeting: Option<[f64; 2]>,
) -> Figure {
    let logarithms = logarithms(ball, of);
    let points: Vec<(f64, f64)> = logarithms.iter().map(|[alpha, mu]| (alpha.exp(), mu.exp())).collect();
    let mut figure = figure.with(Series::new("", points.clone(), Stroke::Faint, colour));
    if let Some(line) = Line::through(&logarithms) {
        let own = logarithms.iter().map(|point| line.place(*point));
        let crossed = meeting.map(|[mu, alpha]| line.place([alpha.ln(), mu.ln()]));
        let (from, to) = own.chain(crossed).fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), t| (l.min(t), h.max(t)));
        // Straight in the logarithms, so bent here.
        let places = (0..=40).map(|i| from + (to - from) * f64::from(i) / 40.0);
        let bent = places.map(|t| line.at(t)).map(|[alpha, mu]| (alpha.exp(), mu.exp())).collect();
        figure = figure.with(Series::new("", bent, Stroke::Dashed, colour));
    }
    if let Some(&(alpha, mu)) = points.last() {
        figure = figure.with(Series::new("", ring(alpha, mu), Stroke::Solid, colour));
    }
    figure.with(Series::new(&ball.name, points, Stroke::Dots, colour))
}

/// Sizes of marks as shares of the values.
fn cross(x: f64, y: f64) -> Vec<(f64, f64)> {
    vec![(x / 1.04, y), (x * 1.04, y), (f64::NAN, f64::NAN), (x, y / 1.04), (x, y * 1.04)]
}

fn diamond(x: f64, y: f64) -> Vec<(f64, f64)> {
    vec![(x / 1.025, y), (x, y * 1.025), (x * 1.025, y), (x, y / 1.025), (x / 1.025, y)]
}

fn ring(x: f64, y: f64) -> Vec<(f64, f64)> {
    (0..=24)
        .map(|i| f64::from(i) * std::f64::consts::TAU / 24.0)
        .map(|angle| (x * (0.02 * angle.cos()).exp(), y * (0.02 * angle.sin()).exp()))
        .collect()
}
