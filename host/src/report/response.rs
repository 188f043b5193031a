//! Page of an identified actuator: what was measured, what its law says, and what is left.

use super::figure::{Axis, Figure, Series, Stroke};
use super::{Page, number};
use crate::response::identified::{Identified, SHOWN_LAGS};
use crate::response::interval::Known;
use crate::response::law::Parameter;
use crate::response::noise::autocorrelation;
use crate::response::push::{PushFit, Pushed};

/// Most points of a curve.
const POINTS: usize = 1500;

/// Every so many samples of a curve, so that it has no more than [`POINTS`] points.
fn curve(x: &[f64], y: &[f64]) -> Vec<(f64, f64)> {
    let every = x.len().div_ceil(POINTS).max(1);
    x.iter().copied().zip(y.iter().copied()).step_by(every).collect()
}

/// Highest and lowest of a few neighbouring samples, so that a thinned curve hides no peak.
fn envelope(x: &[f64], y: &[f64]) -> Vec<(f64, f64)> {
    let every = (2 * x.len()).div_ceil(POINTS).max(1);
    let pairs = x.chunks(every).zip(y.chunks(every));
    pairs
        .flat_map(|(x, y)| {
            let low = y.iter().copied().fold(f64::INFINITY, f64::min);
            let high = y.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            [(x[0], low), (x[x.len() - 1], high)]
        })
        .collect()
}

/// Autocorrelation with the band of white noise.
fn correlation(rho: &[f64], samples: usize, what: &str) -> Figure {
    let band = 1.96 / (samples as f64).sqrt();
    let last = rho.len().saturating_sub(1) as f64;
    let points = rho.iter().enumerate().map(|(lag, rho)| (lag as f64, *rho)).collect();
    let line = |at: f64, label: &str| Series::new(label, vec![(0.0, at), (last, at)], Stroke::Dotted, 5);
    let least = rho.iter().copied().fold(-0.2, f64::min);
    Figure::new(
        &format!("Autocorrelation of the {what}"),
        Axis::new("lag (samples)"),
        Axis::new("correlation").over(least, 1.0),
    )
    .with(line(band, "95 % of white"))
    .with(line(-band, ""))
    .with(Series::new("residual", points, Stroke::Solid, 0))
}

/// Figures of an actuator with a command.
#[must_use]
pub fn figures(found: &Identified) -> Vec<(Figure, &'static str)> {
    let (record, fit) = (&found.record, &found.best().fitted);
    let model: Vec<f64> = record.position_mm.iter().zip(&fit.residual_mm).map(|(y, r)| y - r).collect();
    let time = &record.time_s;
    let motion = Figure::new("Position of the shaft", Axis::new("time (s)"), Axis::new("position (mm)"))
        .with(Series::new("measured", curve(time, &record.position_mm), Stroke::Circles, 1))
        .with(Series::new("law", curve(time, &model), Stroke::Solid, 0));
    let residual = Figure::new("Residual", Axis::new("time (s)"), Axis::new("measured less law (mm)"))
        .with(Series::new("", envelope(time, &fit.residual_mm), Stroke::Solid, 0));
    let given: Vec<f64> = record.command_v.iter().map(|v| if found.inverted { -v } else { *v }).collect();
    let loops = Figure::new("Position over command", Axis::new("command (V)"), Axis::new("position (mm)"))
        .with(Series::new("measured", curve(&given, &record.position_mm), Stroke::Faint, 1))
        .with(Series::new("law", curve(&given, &model), Stroke::Dotted, 0));
    vec![
        (motion, "What was measured, and what the law makes of the command."),
        (residual, "What is left; of neighbouring samples the highest and the lowest."),
        (
            correlation(&found.correlation(), record.time_s.len(), "residual"),
            "White noise stays between the dotted lines.",
        ),
        (loops, "Friction and backlash open the loop, dead time and lag widen it with the speed."),
    ]
}

/// Interval in words.
#[must_use]
pub fn interval(known: &Known) -> String {
    let (low, high) = known.interval95;
    match (low.is_finite(), high.is_finite()) {
        (true, true) => format!("{} to {}", number(low), number(high)),
        (true, false) => format!("at least {}", number(low)),
        _ => "not told".to_owned(),
    }
}

/// The page of an actuator with a command.
#[must_use]
pub fn page(found: &Identified, file: &str) -> Page {
    let law = found.law();
    let mut page = Page::new("Actuator, identified", file);
    let remarks = found.remarks();
    if let Some((first, rest)) = remarks.split_first() {
        page.verdict(first);
        page.list(rest);
    }
    let shown =
        found.known.parameters.iter().filter(|k| !matches!(k.parameter, Parameter::Start | Parameter::StartShare));
    let mut rows: Vec<Vec<String>> = shown
        .map(|known| vec![known.parameter.name(law.structure).to_owned(), number(known.value), interval(known)])
        .collect();
    if let Some(least) = found.least_rate_mm_s {
        rows.push(vec![
            "rate_limit_mm_per_s".to_owned(),
            "none reached".to_owned(),
            format!("at least {}", number(least)),
        ]);
    }
    page.section("Parameters");
    page.table(&["parameter", "value", "95 % interval"], &rows);
    page.section("Measured, law, residual");
    for (figure, caption) in figures(found) {
        page.figure(&figure.svg(), caption);
    }
    page.section("Orders that were tried");
    let least = found.tried.iter().map(|tried| tried.bic).fold(f64::INFINITY, f64::min);
    let rows: Vec<Vec<String>> = found
        .tried
        .iter()
        .map(|tried| {
            let fit = &tried.fitted;
            let sd = (fit.residual_mm.iter().map(|r| r * r).sum::<f64>() / fit.residual_mm.len() as f64).sqrt();
            let limit = if tried.is_limited() { "yes" } else { "no" };
            vec![fit.law.structure.name().to_owned(), limit.to_owned(), number(sd), format!("{:.1}", tried.bic - least)]
        })
        .collect();
    page.table(&["law", "rate limit", "residual (mm)", "BIC above the least"], &rows);
    page
}

/// Figures of a pushed actuator.
#[must_use]
pub fn pushed_figures(record: &Pushed, fit: &PushFit) -> Vec<(Figure, &'static str)> {
    let (time, x) = (&record.time_s, &record.position_mm);
    let loops = Figure::new("Force over position", Axis::new("position (mm)"), Axis::new("force (N)"))
        .with(Series::new("parts", curve(x, &fit.predicted_n), Stroke::Solid, 0))
        .with(Series::new("measured", curve(x, &record.force_n), Stroke::Faint, 1));
    let over = Figure::new("Force", Axis::new("time (s)"), Axis::new("force (N)"))
        .with(Series::new("parts", curve(time, &fit.predicted_n), Stroke::Solid, 0))
        .with(Series::new("measured", curve(time, &record.force_n), Stroke::Faint, 1));
    let residual = Figure::new("Residual", Axis::new("position (mm)"), Axis::new("measured less parts (N)"))
        .with(Series::new("", curve(x, &fit.residual_n), Stroke::Faint, 0));
    let rho = autocorrelation(&fit.residual_n, SHOWN_LAGS);
    vec![
        (loops, "Loading above, unloading below: half the width of the loop is the friction."),
        (over, "The same over time."),
        (residual, "What is left over the position: lines that lie on each other come again in every stroke."),
        (correlation(&rho, time.len(), "residual"), "White noise stays between the dotted lines."),
    ]
}

/// The page of a pushed actuator.
#[must_use]
pub fn pushed_page(record: &Pushed, fit: &PushFit, file: &str) -> Page {
    let mut page = Page::new("Actuator, pushed", file);
    let friction = fit.part(crate::response::push::Part::Friction);
    if let Some((value, (low, high))) = friction {
        page.verdict(&format!("Dry friction {} N (95 %: {} to {} N).", number(value), number(low), number(high)));
    }
    page.list(&fit.remarks());
    page.section("Parts of the force");
    let mut rows: Vec<Vec<String>> = fit
        .parts
        .iter()
        .map(|(part, value, (low, high))| {
            vec![part.name().to_owned(), number(*value), format!("{} to {}", number(*low), number(*high))]
        })
        .collect();
    let (turning, (low, high)) = fit.turning_mm;
    rows.push(vec!["turning_mm".to_owned(), number(turning), format!("{} to {}", number(low), number(high))]);
    page.table(&["part", "amount", "95 % interval"], &rows);
    page.section("Measured, parts, residual");
    for (figure, caption) in pushed_figures(record, fit) {
        page.figure(&figure.svg(), caption);
    }
    page
}
