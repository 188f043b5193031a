//! Pictures like the thesis' Figs. 28 to 32.

use std::path::Path;

use palpate::report::figure::{Axis, Figure, Series, Stroke};
use protocol::message::Outcome;
use tests::palpations::{DEPTH_MM, Palpated, RATES_MM_S, Study, THESIS_COUNTS};

use super::{Bench, save};

/// Points of a drawn curve.
const POINTS: usize = 80;

/// Place of 2 mm/s, the rate of Figs. 31 and 32.
const MIDDLE: usize = 1;

fn depths() -> impl Iterator<Item = f64> {
    (0..=POINTS).map(|i| DEPTH_MM * i as f64 / POINTS as f64)
}

/// The foams at every rate (Fig. 28), and the library with its dummies at 2 mm/s (Fig. 30).
pub fn curves(bench: &Bench, docs: &Path) -> Result<(), Box<dyn std::error::Error>> {
    let title = "Simulated foams under the 4 mm ball; B1 at 1, 2 and 4 mm/s";
    let mut figure = Figure::new(title, Axis::new("depth past contact (mm)"), Axis::new("force (N)"));
    for (colour, foam) in bench.foams.iter().enumerate() {
        let rates = if foam.softens { RATES_MM_S.len() } else { 1 };
        for (rate, rate_mm_s) in RATES_MM_S.iter().enumerate().take(rates) {
            let points = depths().map(|d| (d, foam.curves[rate].force_n(d))).collect();
            let name = if foam.softens { format!("{}, {rate_mm_s} mm/s", foam.name) } else { foam.name.into() };
            figure = figure.with(Series::new(&name, points, Stroke::LINES[rate], colour));
        }
    }
    save(docs, "thesis-curves.svg", &figure.svg())?;
    let table = bench.table(MIDDLE)?;
    let title = "The library at 2 mm/s: four foams and four dummies";
    let mut figure = Figure::new(title, Axis::new("depth past contact (mm)"), Axis::new("force (N)"));
    for (i, material) in table.materials().enumerate() {
        let force = |d: f64| table.locate(d as f32).map_or(0.0, |at| f64::from(material.force_n(at)));
        let points = depths().map(|d| (d, force(d))).collect();
        let stroke = if material.name.starts_with("dummy") { Stroke::Dashed } else { Stroke::Solid };
        figure = figure.with(Series::new(material.name, points, stroke, i));
    }
    save(docs, "thesis-library.svg", &figure.svg())?;
    Ok(())
}

/// Who identified.
#[derive(Clone, Copy)]
enum Way {
    Board,
    Kalman,
    Threshold,
}

impl Way {
    /// Modulus and exponent that were found.
    fn of(self, palpated: &Palpated) -> Option<(f64, f64)> {
        match self {
            Way::Board => {
                let verdict = &palpated.judged.verdict;
                let given = verdict.outcome == Outcome::Identified;
                given.then_some((f64::from(verdict.mu_mpa), f64::from(verdict.alpha)))
            }
            Way::Kalman => {
                let estimate = &palpated.judged.filtered.as_ref()?.estimate;
                Some((f64::from(estimate.mu_mpa), f64::from(estimate.alpha)))
            }
            Way::Threshold => palpated.thesis.map(|t| (t.mu_mpa, t.alpha)),
        }
    }
}

/// Modulus and exponent over the palpations of the first session at 2 mm/s (Figs. 31 and 32).
pub fn identified(bench: &Bench, studies: &[Study], docs: &Path) -> Result<(), Box<dyn std::error::Error>> {
    let Some(study) = studies.get(MIDDLE) else { return Ok(()) };
    let first = &study.palpated[..THESIS_COUNTS.iter().sum::<usize>().min(study.palpated.len())];
    let draw = |title: &str, label: &str, way: Way, exponent: bool| {
        let y = if exponent { Axis::new(label).over(0.0, 24.0) } else { Axis::new(label).over(0.0, 0.3) };
        let x = Axis::new("palpation of the session").over(0.0, first.len() as f64);
        let mut figure = Figure::new(title, x, y);
        for (i, foam) in bench.foams.iter().enumerate() {
            let truth = if exponent { foam.alpha } else { foam.mu_mpa };
            let line = vec![(0.0, truth), (first.len() as f64, truth)];
            figure = figure.with(Series::new(foam.name, line, Stroke::Dashed, i));
            let points = first.iter().enumerate().filter(|(_, p)| p.foam == i).filter_map(|(at, p)| {
                let (mu_mpa, alpha) = way.of(p)?;
                Some((at as f64, if exponent { alpha } else { mu_mpa }))
            });
            figure = figure.with(Series::new("", points.collect(), Stroke::Circles, i));
        }
        figure.svg()
    };
    let ways = [
        (Way::Board, "the board", "board"),
        (Way::Kalman, "the Kalman filter", "kalman"),
        (Way::Threshold, "the thesis' way", "threshold"),
    ];
    for (way_of, way, file) in ways {
        let title = format!("Modulus found at 2 mm/s by {way}; dashed: identified offline");
        save(docs, &format!("thesis-mu-{file}.svg"), &draw(&title, "mu (MPa)", way_of, false))?;
        let title = format!("Exponent found at 2 mm/s by {way}; dashed: identified offline");
        save(docs, &format!("thesis-alpha-{file}.svg"), &draw(&title, "alpha", way_of, true))?;
    }
    Ok(())
}
