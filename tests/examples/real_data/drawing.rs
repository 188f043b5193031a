//! Measured against fitted, with what is left over below.

use std::path::Path;

use palpate::identify::Identification;
use palpate::identify::fit::RunFit;
use palpate::report::figure::{Axis, Figure, Series, Stroke};

use super::Outcome;

/// Most samples drawn of a run.
const DRAWN: usize = 70;
const WIDTH: f64 = 640.0;
const UPPER: f64 = 330.0;
const LOWER: f64 = 230.0;

/// What is drawn over what.
#[derive(Clone, Copy)]
pub enum Over {
    /// Force over depth past contact.
    Depth,
    /// Force over the time since the end of loading.
    Time,
    /// Nominal stress over nominal strain, of a specimen of this height (mm) and area (mm^2).
    Strain(f64, f64),
}

/// A fit's run that is drawn, with its label.
pub struct Drawn<'a> {
    /// Fit.
    pub found: &'a Identification,
    /// One of its runs.
    pub run: &'a RunFit,
    /// Label at the end of its fitted line.
    pub label: &'a str,
    /// What it is drawn over.
    pub over: Over,
    /// Draw the measurement as well; a second fit of the same run need not repeat it.
    pub measured: bool,
}

impl Drawn<'_> {
    fn points(&self, values: impl Fn(usize) -> f64, most: usize) -> Vec<(f64, f64)> {
        let data = &self.found.selection.curves[self.run.curve];
        let place = |at: usize| match self.over {
            Over::Depth => data.depth_mm[at] - self.run.contact_mm,
            Over::Time => data.time_s[at],
            Over::Strain(height_mm, _) => 100.0 * (data.depth_mm[at] - self.run.contact_mm) / height_mm,
        };
        let unit = if let Over::Strain(_, area_mm2) = self.over { area_mm2 } else { 1.0 };
        let end = if matches!(self.over, Over::Time) { data.force_n.len() } else { data.hold_from };
        (0..end).step_by(end.div_ceil(most).max(1)).map(|at| (place(at), values(at) / unit)).collect()
    }

    fn force(&self, at: usize) -> f64 {
        self.found.selection.curves[self.run.curve].force_n[at]
    }
}

/// Writes a picture of some runs: circles measured, lines fitted, below what is left over.
pub fn write(file: &Path, title: &str, runs: &[Drawn<'_>]) -> Outcome<()> {
    let (across, up) = match runs.first().map(|one| one.over) {
        Some(Over::Strain(..)) => ("nominal strain (%)", "nominal stress (MPa)"),
        Some(Over::Time) => ("time since the end of loading (s)", "force (N)"),
        _ => ("depth past contact (mm)", "force (N)"),
    };
    let mut upper = Figure::new(title, Axis::new(across), Axis::new(up));
    let mut lower = Figure::new("Measured minus fitted", Axis::new(across), Axis::new(up));
    (upper.size, lower.size) = ((WIDTH, UPPER), (WIDTH, LOWER));
    for (at, one) in runs.iter().enumerate() {
        let line = Stroke::LINES[at % Stroke::LINES.len()];
        if one.measured {
            upper = upper.with(Series::new("", one.points(|i| one.force(i), DRAWN), Stroke::Circles, at));
        }
        upper = upper.with(Series::new(one.label, one.points(|i| one.run.model_n[i], 2 * DRAWN), line, at));
        let left = one.points(|i| one.force(i) - one.run.model_n[i], 2 * DRAWN);
        lower = lower.with(Series::new(one.label, left, line, at));
    }
    let svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{0}\" viewBox=\"0 0 {WIDTH} {0}\">\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n{1}\n<g transform=\"translate(0,{UPPER})\">{2}</g>\n</svg>\n",
        UPPER + LOWER,
        upper.svg(),
        lower.svg()
    );
    Ok(std::fs::write(file, svg)?)
}
