//! A tour of the bench as pictures: Figs. 19, 25, 28, 29, 31 and 32 of the thesis.

use firmware::search::Slice;
use firmware::surface::Surface;
use lut_gen::solid::law::Hyperfoam;
use protocol::lut::Table;

use super::figure::{Axis, COLOURS, Figure, Series, Stroke};
use crate::tour::{Filtered, Law, Pressed, Specimens, Tour};

/// A figure with the name of its file and its caption.
pub type Drawn = (&'static str, Figure, String);

/// Largest compression of Fig. 25, as a part of the height.
const COMPRESSED: f64 = 0.6;
/// Height (mm) and depths (mm) of Fig. 19, its moduli (MPa), and how many exponents are computed.
const SURFACE_HEIGHT_MM: f32 = 19.05;
const SURFACE_DEPTHS_MM: [f32; 2] = [2.0, 4.0];
const SURFACE_MU_MPA: [f32; 4] = [0.05, 0.1, 0.2, 0.3];
const SURFACE_POINTS: usize = 60;

/// Compression of the foams, every point deforming alike.
#[must_use]
pub fn compressions(tour: &Tour) -> Drawn {
    let mut figure = Figure::new("Compression of the foams", Axis::new("strain"), Axis::new("stress (kPa)"));
    let foams = tour.stops.iter().enumerate().filter(|(_, stop)| stop.law == Law::Hyperfoam);
    for (at, stop) in foams {
        let Ok(law) = Hyperfoam::one_term(stop.mu_mpa, stop.alpha) else { continue };
        let strain = |k: usize| COMPRESSED * k as f64 / 100.0;
        let points = (0..=100).map(|k| (strain(k), -1e3 * law.uniaxial_stress_mpa(1.0 - strain(k))));
        figure = figure.with(Series::new(&stop.name, points.collect(), Stroke::LINES[at % 4], at));
    }
    ("compression", figure, "Stress over strain of the foams' laws (Fig. 25).".to_owned())
}

/// Force of the ball on fresh specimens: foams, then tissues.
#[must_use]
pub fn indentations(tour: &Tour, specimens: &Specimens) -> Vec<Drawn> {
    let of = |name, title: &str, is_foam: bool, caption: &str| {
        let mut figure = Figure::new(title, Axis::new("depth (mm)"), Axis::new("force (N)"));
        let stops = tour.stops.iter().enumerate().filter(|(_, stop)| (stop.law == Law::Hyperfoam) == is_foam);
        for (at, stop) in stops {
            figure = figure.with(Series::new(&stop.name, specimens.fresh(at), Stroke::LINES[at % 4], at));
        }
        (name, figure, caption.to_owned())
    };
    let all = [
        of("foams", "Foams under the ball, simulated", true, "Force over depth on the foams (Fig. 28)."),
        of("tissues", "Tissues under the ball, simulated", false, "Force over depth on the tissues (Fig. 29)."),
    ];
    all.into_iter().filter(|(_, figure, _)| !figure.series.is_empty()).collect()
}

/// What presses are identified as: modulus and exponent over the number of the press, by the search and by the filter.
#[must_use]
pub fn identified(
    tour: &Tour,
    presses: &[(Pressed, Option<Filtered>)],
    (bounding, is_simulated): (&str, bool),
) -> Vec<Drawn> {
    type Of<'a> = &'a dyn Fn(&Pressed, Option<&Filtered>) -> Option<(f64, f64)>;
    let search = |press: &Pressed, _: Option<&Filtered>| press.identified();
    let filter = |_: &Pressed, found: Option<&Filtered>| found.map(|found| (found.mu_mpa, found.alpha));
    let ways: [(&str, &str, Of<'_>); 2] =
        [("search", "variance search", &search), ("filter", "Kalman filter", &filter)];
    let mut all = Vec::new();
    for (is_mu, what, number) in [(true, "mu (MPa)", 31), (false, "alpha", 32)] {
        for (word, title, of) in ways {
            let title = format!("{what}, {title}{}", if is_simulated { ", simulated" } else { "" });
            let mut figure = Figure::new(&title, Axis::new("press"), Axis::new(what));
            let pick = |(mu_mpa, alpha): (f64, f64)| if is_mu { mu_mpa } else { alpha };
            let foams = tour.stops.iter().enumerate().filter(|(_, stop)| stop.law == Law::Hyperfoam);
            for (stop, own) in foams {
                let found = presses.iter().filter(|(press, _)| press.stop == stop);
                let point = |(press, by_filter): &(Pressed, Option<Filtered>)| {
                    Some((press.number as f64, pick(of(press, by_filter.as_ref())?)))
                };
                let points: Vec<(f64, f64)> = found.filter_map(point).collect();
                let truth = pick((own.mu_mpa, own.alpha));
                let line = vec![(1.0, truth), (presses.len().max(2) as f64, truth)];
                figure = figure.with(Series::new("", points, Stroke::Marks, stop % COLOURS.len())).with(Series::new(
                    &own.name,
                    line,
                    Stroke::Dashed,
                    stop % COLOURS.len(),
                ));
            }
            let by = if word == "filter" { format!(", bounded by {bounding}") } else { String::new() };
            let name = match (is_mu, word) {
                (true, "search") => "mu-search",
                (true, _) => "mu-filter",
                (false, "search") => "alpha-search",
                (false, _) => "alpha-filter",
            };
            let caption = format!(
                "Identified in each press by the {word}{by}; dashed: as stated of the fresh foam (Fig. {number})."
            );
            all.push((name, figure, caption));
        }
    }
    all
}

/// Force over the exponent at some moduli and two depths; none where the table has no such specimen.
#[must_use]
pub fn surface(table: &Table<'_>) -> Option<Drawn> {
    let slice = Slice::nearest(table, SURFACE_HEIGHT_MM, 1.0)?;
    let surface = Surface::new(table, &slice)?;
    let (low, high) = surface.alpha_range();
    let mut figure = Figure::new("Force over the parameters", Axis::new("alpha"), Axis::new("force (N)"));
    for (line, depth_mm) in SURFACE_DEPTHS_MM.into_iter().enumerate() {
        for (colour, mu_mpa) in SURFACE_MU_MPA.into_iter().enumerate() {
            let alpha = |k: usize| low + (high - low) * k as f32 / SURFACE_POINTS as f32;
            let points = (0..=SURFACE_POINTS).filter_map(|k| {
                let force = surface.at(mu_mpa, alpha(k), depth_mm.min(surface.depth_max_mm()))?;
                Some((f64::from(alpha(k)), f64::from(force.force_n)))
            });
            let label = if line == 1 { format!("{mu_mpa} MPa") } else { String::new() };
            figure = figure.with(Series::new(&label, points.collect(), Stroke::LINES[1 - line], colour));
        }
    }
    let caption = format!(
        "Indentation force over alpha and mu, {} mm high: dashed {} mm deep, solid {} mm (Fig. 19).",
        SURFACE_HEIGHT_MM, SURFACE_DEPTHS_MM[0], SURFACE_DEPTHS_MM[1]
    );
    Some(("surface", figure, caption))
}
