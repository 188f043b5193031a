//! Pictures of the objective: shaded over two parameters, sampled over four, and parameters along the way.

use crate::identify::multistart::Search;
use crate::identify::newton::coordinate::{Kind, Unknown};
use crate::report::cloud::Cloud;
use crate::report::figure::{Axis, Figure, Series, Stroke};
use crate::report::map::{self, Overlay};
use crate::study::Subject;
use crate::study::findings::Picture;

use super::{Asked, Panel};

/// What the pictures of one choice of parameters are called.
fn stem(asked: &Asked) -> String {
    let terms = if asked.terms > 1 { "-terms" } else { "" };
    let free: Vec<&str> = asked
        .free
        .iter()
        .map(|extra| match extra {
            crate::identify::spec::Extra::Nu => "-nu",
            crate::identify::spec::Extra::Friction => "-friction",
            _ => "-free",
        })
        .collect();
    format!("study-objective{terms}{}", free.concat())
}

pub(super) fn pictures(subject: &Subject, asked: &Asked, panels: &[Panel]) -> Vec<Picture> {
    let truth = subject.foam.as_ref().map(|foam| (foam.alpha, foam.mu_mpa));
    let stem = stem(asked);
    let mut pictures = Vec::new();
    for (at, panel) in panels.iter().enumerate() {
        let file = |kind: &str| format!("{stem}{kind}-{}", at + 1);
        if asked.terms == 1 {
            pictures.push(shaded(panel, file(""), truth));
        } else {
            pictures.extend((0..asked.terms).map(|term| sampled(panel, file(&format!("-{}", term + 1)), term, truth)));
        }
        for kind in [Kind::Nu, Kind::Friction] {
            pictures.extend(along(panel, file("-way"), kind));
        }
    }
    pictures
}

/// Fig. 9: the objective over alpha and mu with all ways down.
fn shaded(panel: &Panel, file: String, truth: Option<(f64, f64)>) -> Picture {
    let axes = panel.search.slice.axes;
    let of = |point: &[f64]| {
        let value = |axis: usize| panel.search.unknowns[axis].value(point[axis]);
        (value(axes[0]), value(axes[1]))
    };
    let newton: Vec<(f64, f64)> = panel.newton.path.iter().map(|visit| of(&visit.point)).collect();
    let overlay = Overlay { newton: &newton, truth };
    let others =
        if panel.search.unknowns.len() > 2 { ", the other parameters where the best simplex ended" } else { "" };
    Picture {
        file,
        svg: map::svg_over(&format!("Eq. 14 over alpha and mu: {}", panel.balls), &panel.search, &overlay),
        caption: format!(
            "{}: dark is good{others}. {} starts below the threshold, their simplex paths (thin; the best one solid), and the points that Gauss-Newton solved (orange).",
            panel.balls,
            panel.search.starts.len()
        ),
    }
}

/// Exponent and modulus (MPa) of a term at a point.
fn term_of(unknowns: &[Unknown], point: &[f64], term: usize) -> (f64, f64) {
    let value = |kind: Kind| unknowns.iter().position(|u| u.kind == kind).map(|at| unknowns[at].value(point[at]));
    let (mu, share) = (value(Kind::Modulus).unwrap_or(0.0), value(Kind::Share).unwrap_or(0.0));
    let part = if term == 0 { 1.0 - share } else { share };
    (value(Kind::Alpha(term)).unwrap_or(0.0), mu * part)
}

/// Moduli of a term below this share of the largest are drawn on the axis.
const LEAST_MODULUS: f64 = 3e-4;

/// Ways drawn over a sample, the best ones: the thesis draws three.
const DRAWN: usize = 4;

/// Fig. 10: the sample of four parameters, seen from the two of one term.
fn sampled(panel: &Panel, file: String, term: usize, truth: Option<(f64, f64)>) -> Picture {
    let search: &Search = &panel.search;
    let of = |point: &[f64]| term_of(&search.unknowns, point, term);
    let points: Vec<(f64, f64, f64)> = search
        .sample
        .iter()
        .map(|sampled| {
            let (alpha, mu) = of(&sampled.point);
            (alpha, mu, sampled.objective_n)
        })
        .collect();
    let paths: Vec<Vec<(f64, f64)>> =
        search.starts.iter().take(DRAWN).map(|start| start.descent.path.iter().map(|p| of(p)).collect()).collect();
    let every = || points.iter().map(|p| (p.0, p.1)).chain(paths.iter().flatten().copied());
    let highest = every().map(|p| p.1).fold(f64::MIN_POSITIVE, f64::max);
    let (low, high) = every().map(|p| p.0).fold((f64::INFINITY, 0.0_f64), |(a, b), v| (a.min(v), b.max(v)));
    let number = term + 1;
    let cloud = Cloud {
        title: format!("Eq. 14 over four parameters, term {number}: {}", panel.balls),
        x: Axis::new(&format!("alpha_{number}")).over(low, high).logarithmic(),
        y: Axis::new(&format!("mu_{number} (MPa)")).over(LEAST_MODULUS * highest, highest).logarithmic(),
        value: "N, Eq. 14".to_owned(),
        points,
        paths,
        truth,
    };
    Picture {
        file,
        svg: cloud.svg(),
        caption: format!(
            "{}: every point of the map by its term {number}, deep and large is good; lines: the {} best simplices, open circle to cross, the best one wide. A modulus below {LEAST_MODULUS} of the largest is drawn on the axis.",
            panel.balls,
            DRAWN.min(search.starts.len())
        ),
    }
}

/// Fig. 13: a parameter at the best vertex of every simplex, over its evaluations.
fn along(panel: &Panel, file: String, kind: Kind) -> Option<Picture> {
    let search = &panel.search;
    let axis = search.unknowns.iter().position(|unknown| unknown.kind == kind)?;
    let unknown = &search.unknowns[axis];
    let title = format!("{} on the way of every simplex: {}", unknown.name, panel.balls);
    let mut figure = Figure::new(&title, Axis::new("evaluations of Eq. 14"), Axis::new(&unknown.name));
    for (at, start) in search.starts.iter().enumerate().rev() {
        let descent = &start.descent;
        let points: Vec<(f64, f64)> = descent
            .counts
            .iter()
            .zip(&descent.path)
            .map(|(count, point)| (*count as f64, unknown.value(point[axis])))
            .collect();
        let stroke = Stroke::LINES[at % Stroke::LINES.len()];
        let label = if at == 0 { "best".to_owned() } else { (at + 1).to_string() };
        figure = figure.with(Series::new(&label, points, stroke, at));
    }
    Some(Picture {
        file,
        svg: figure.svg(),
        caption: format!(
            "{}: {} of the best vertex of each of {} simplices, restarts included, best end first. The thesis smooths such points; here every one is drawn.",
            panel.balls,
            unknown.name,
            search.starts.len()
        ),
    })
}
