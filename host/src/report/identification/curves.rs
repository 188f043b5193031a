//! Figures of measured and fitted curves, with what the fit leaves.

use crate::experiment::Experiment;
use crate::identify::Identification;
use crate::identify::data::LoadingCurve;
use crate::identify::fit::{Fit, RunFit};
use crate::infer::covariance::Z95;
use crate::report::figure::{Axis, Figure, Series, Stroke};
use crate::report::{Page, number};

/// Most measured samples drawn per run; more only make the file large.
const DRAWN_SAMPLES: usize = 90;
/// Colour of lines that are no curves.
const GREY: usize = 5;

/// What a run is drawn in: depth and force, or, where a whole specimen deforms, strain and nominal stress.
struct Units {
    /// mm of depth per unit drawn.
    depth: f64,
    /// N per unit drawn.
    force: f64,
}

impl Units {
    /// Depth and force as they are.
    const PLAIN: Units = Units { depth: 1.0, force: 1.0 };

    fn of(experiment: &Experiment, found: &Identification, run: &RunFit) -> Self {
        let pairing = &found.selection.pairings[found.selection.curves[run.curve].pairing];
        let specimen = &experiment.specimens[pairing.specimen];
        match (pairing.grip.mode(), specimen.height_mm.known(), specimen.radius_mm.known()) {
            (Some(_), Some(height_mm), Some(radius_mm)) => {
                Self { depth: 0.01 * height_mm, force: std::f64::consts::PI * radius_mm * radius_mm }
            }
            _ => Self::PLAIN,
        }
    }

    fn drawn(&self, depth_mm: f64, force_n: f64) -> (f64, f64) {
        (depth_mm / self.depth, force_n / self.force)
    }
}

/// Every `n`-th sample of a run, drawn over depth past its contact point.
fn measured(found: &Identification, run: &RunFit, units: &Units) -> Vec<(f64, f64)> {
    let data = &found.selection.curves[run.curve];
    let every = data.depth_mm.len().div_ceil(DRAWN_SAMPLES).max(1);
    let samples = data.depth_mm.iter().zip(&data.force_n).step_by(every);
    samples.map(|(depth, force)| units.drawn(depth - run.contact_mm, *force)).collect()
}

fn modelled(found: &Identification, run: &RunFit, units: &Units) -> Vec<(f64, f64)> {
    let data = &found.selection.curves[run.curve];
    let samples = data.depth_mm.iter().zip(&run.model_n);
    samples.map(|(depth, force)| units.drawn(depth - run.contact_mm, *force)).collect()
}

fn residual(found: &Identification, run: &RunFit, units: &Units) -> Vec<(f64, f64)> {
    let data = &found.selection.curves[run.curve];
    let samples = data.depth_mm.iter().zip(data.force_n.iter().zip(&run.model_n));
    samples.map(|(depth, (force, model))| units.drawn(depth - run.contact_mm, force - model)).collect()
}

fn short_name(experiment: &Experiment, found: &Identification, run: &RunFit) -> String {
    let file = &experiment.runs[found.selection.curves[run.curve].run].file;
    let name = file.rsplit(['/', '\\', ':']).next().unwrap_or(file);
    name.trim_end_matches(".csv").to_owned()
}

/// All runs in two figures for each kind of test: forces, residuals.
pub(super) fn overview(page: &mut Page, experiment: &Experiment, found: &Identification, fit: &Fit) {
    let word = |run: &RunFit| found.selection.pairings[found.selection.curves[run.curve].pairing].grip.word();
    let mut kinds: Vec<&str> = Vec::new();
    for run in &fit.runs {
        if !kinds.contains(&word(run)) {
            kinds.push(word(run));
        }
    }
    for kind in &kinds {
        let runs: Vec<&RunFit> = fit.runs.iter().filter(|run| word(run) == *kind).collect();
        let title = if kinds.len() > 1 { format!("{kind}: measured") } else { "Measured".to_owned() };
        together(page, experiment, found, &runs, &format!("{title} (marks) and fitted (lines)"));
    }
}

/// Runs of one kind of test in two figures: forces, residuals.
fn together(page: &mut Page, experiment: &Experiment, found: &Identification, runs: &[&RunFit], title: &str) {
    let stretched = runs
        .first()
        .is_some_and(|run| found.selection.pairings[found.selection.curves[run.curve].pairing].grip.mode().is_some());
    let (across, up) = if stretched {
        ("nominal strain (%)", "nominal stress (MPa)")
    } else {
        ("depth past contact (mm)", "force (N)")
    };
    let mut forces = Figure::new(title, Axis::new(across), Axis::new(up));
    let left = if stretched { "measured minus fitted (MPa)" } else { "measured minus fitted (N)" };
    let mut residuals = Figure::new("Measured minus fitted", Axis::new(across), Axis::new(left));
    residuals.size.1 = 280.0;
    if let Some(fit) = found.fit.as_ref().filter(|_| !stretched) {
        let depths = || runs.iter().flat_map(|run| measured(found, run, &Units::PLAIN)).map(|p| p.0);
        let (from, to) = (depths().fold(0.0, f64::min), depths().fold(0.0, f64::max));
        for noise in [-Z95 * fit.noise.sigma_n, Z95 * fit.noise.sigma_n] {
            residuals = residuals.with(Series::new("", vec![(from, noise), (to, noise)], Stroke::Faint, GREY));
        }
    }
    for (at, run) in runs.iter().enumerate() {
        let name = short_name(experiment, found, run);
        let units = Units::of(experiment, found, run);
        let line = Stroke::LINES[at % Stroke::LINES.len()];
        forces = forces.with(Series::new("", measured(found, run, &units), Stroke::Marks, at)).with(Series::new(
            &name,
            modelled(found, run, &units),
            line,
            at,
        ));
        residuals = residuals.with(Series::new(&name, residual(found, run, &units), line, at));
    }
    page.figure(&forces.svg(), "Every run begins at its own fitted contact point.");
    let noise = if stretched { "" } else { "Between the thin lines lie 95 % of the noise of single samples. " };
    page.figure(&residuals.svg(), &format!("{noise}A residual that waves is misfit, not noise."));
}

pub(super) fn one_run(page: &mut Page, experiment: &Experiment, found: &Identification, run: &RunFit) {
    let data = &found.selection.curves[run.curve];
    let name = short_name(experiment, found, run);
    let held = if data.hold_out { ", held out: predicted, not fitted" } else { "" };
    let readings =
        |values: &[f64]| -> Vec<(f64, f64)> { data.depth_mm.iter().copied().zip(values.iter().copied()).collect() };
    let every = data.depth_mm.len().div_ceil(DRAWN_SAMPLES).max(1);
    let samples: Vec<(f64, f64)> = readings(&data.force_n).into_iter().step_by(every).collect();
    let highest = data.force_n.iter().copied().fold(0.0, f64::max);
    let contact = vec![(run.contact_mm, 0.0), (run.contact_mm, highest)];
    let depth = || Axis::new("depth reading (mm)");
    let mut forces = Figure::new(&name, depth(), Axis::new("force (N)"))
        .with(Series::new("", contact, Stroke::Faint, GREY))
        .with(Series::new("measured", samples, Stroke::Circles, 1))
        .with(Series::new("fit", readings(&run.model_n), Stroke::Solid, 0));
    forces.size.1 = 260.0;
    let difference: Vec<f64> = data.force_n.iter().zip(&run.model_n).map(|(force, model)| force - model).collect();
    let mut left = Figure::new("", depth(), Axis::new("residual (N)")).with(Series::new(
        "residual",
        readings(&difference),
        Stroke::Solid,
        1,
    ));
    left.size.1 = 170.0;
    let caption = format!(
        "{name}{held}: contact at {:.3} mm (thin upright line), {:.3} mm/s, {} samples, residual {} N rms.",
        run.contact_mm,
        data.rate_mm_per_s,
        data.depth_mm.len(),
        number(run.rmse_n),
    );
    page.figure(&format!("{}{}", forces.svg(), left.svg()), &caption);
    if data.hold_from < data.force_n.len() {
        hold(page, &name, data, run);
    }
}

/// A ramp and its hold over time, which a figure over depth draws as one upright line.
fn hold(page: &mut Page, name: &str, data: &LoadingCurve, run: &RunFit) {
    let over_time =
        |values: &[f64]| -> Vec<(f64, f64)> { data.time_s.iter().copied().zip(values.iter().copied()).collect() };
    let every = data.force_n.len().div_ceil(DRAWN_SAMPLES).max(1);
    let measured: Vec<(f64, f64)> = over_time(&data.force_n).into_iter().step_by(every).collect();
    let mut forces = Figure::new(name, Axis::new("time after the ramp (s)"), Axis::new("force (N)"))
        .with(Series::new("measured", measured, Stroke::Circles, 1))
        .with(Series::new("fit", over_time(&run.model_n), Stroke::Solid, 0));
    forces.size.1 = 230.0;
    let held = data.force_n.len() - data.hold_from;
    page.figure(&forces.svg(), &format!("{name}: ramp and hold over time, {held} samples of the hold."));
}
