//! What was measured against what the base predicts, with what noise alone would make.

use crate::diagnose::Evidence;
use crate::diagnose::design::{Branch, Series as Run};
use crate::diagnose::noise::Curve;
use crate::diagnose::whiten::SIMULATED;
use crate::experiment::Experiment;
use crate::infer::covariance::Z95;
use crate::report::Page;
use crate::report::figure::{Series, Stroke};

use super::drawn::Drawn;
use super::panel::{Band, Grid, Key, Panel, Row};
use super::words;

/// Most plots beside each other.
const COLUMNS: usize = 4;

/// Forces and residuals of one run, predictions those of plain best fits at the contact point of its spot.
pub(super) struct Shown {
    pub depth_mm: Vec<f64>,
    pub measured_n: Vec<f64>,
    pub base_n: Vec<f64>,
    pub extended_n: Option<Vec<f64>>,
    /// Standard deviations: of the sensor alone, of everything.
    pub sigma_n: Vec<(f64, f64)>,
}

impl Shown {
    /// Of the run at a place in the design.
    pub fn of(evidence: &Evidence, run: usize) -> Self {
        let series = &evidence.design.series[run];
        let base = &evidence.before.curves[run];
        Self {
            depth_mm: series.nodes.iter().map(|n| n.depth_mm).collect(),
            measured_n: series.nodes.iter().map(|n| n.force_n).collect(),
            base_n: base.force_n.clone(),
            extended_n: evidence.after.as_ref().map(|after| after.curves[run].force_n.clone()),
            sigma_n: sigma(evidence, series, base),
        }
    }

    /// Measured less base, N.
    pub fn residual_n(&self) -> Vec<f64> {
        self.measured_n.iter().zip(&self.base_n).map(|(m, b)| m - b).collect()
    }

    /// Measured less extended, N.
    pub fn residual_after_n(&self) -> Option<Vec<f64>> {
        self.extended_n.as_ref().map(|after| self.measured_n.iter().zip(after).map(|(m, b)| m - b).collect())
    }

    fn over_depth(&self, values: &[f64]) -> Vec<(f64, f64)> {
        self.depth_mm.iter().copied().zip(values.iter().copied()).collect()
    }
}

/// Standard deviation of every node: of the sensor alone; with the scatter of contact, gain and zero and the simulation's own error.
fn sigma(evidence: &Evidence, series: &Run, base: &Curve) -> Vec<(f64, f64)> {
    let jitter = evidence.noise.jitter;
    let each = series.nodes.iter().zip(&base.force_n).zip(&base.slope_n_per_mm);
    each.map(|((node, force), slope)| {
        let sensor = evidence.noise.sensor.variance(node, *force).sqrt();
        let parts = [jitter.contact_mm * slope, jitter.gain * force, jitter.zero_n, SIMULATED * force];
        (sensor, parts.iter().fold(sensor, |sum: f64, part| sum.hypot(*part)))
    })
    .collect()
}

/// What varies inside one figure: specimen, ball, cycle.
type Place = (usize, usize, i64);

/// The section.
pub(super) fn section(page: &mut Page, experiment: &Experiment, evidence: &Evidence, drawn: Option<&Drawn<'_>>) {
    page.section("Measured against simulated");
    let after = drawn.map(|drawn| drawn.name.as_str());
    page.paragraph(&format!(
        "One run of each condition ({} conditions, {} runs used). Above: force. Below: measured minus simulated. \
         The dark band holds 95 % of the sensor's noise, the light band 95 % of what repeats differ by. \
         Noise does not explain a curve outside the light band.{}",
        evidence.design.conditions,
        evidence.design.series.len(),
        match drawn {
            Some(drawn) if drawn.named => " Dashed: the extended simulation, fitted to the same data.",
            Some(_) => " Dashed: the likeliest set of effects, which is not certain enough for a name.",
            None => "",
        }
    ));
    // said once, under the first figure
    let mut caption = "Loading runs to the right, a hold is upright, unloading runs back. Depth is as recorded.";
    for place in places(evidence) {
        let runs = runs(evidence, place);
        for part in runs.chunks(COLUMNS) {
            page.figure(&grid(experiment, evidence, place, part, after).svg(), std::mem::take(&mut caption));
        }
    }
}

/// First and last cycle of every ball on every specimen.
fn places(evidence: &Evidence) -> Vec<Place> {
    let mut all: Vec<Place> = evidence.design.series.iter().map(|s| (s.specimen, s.indenter, s.cycle)).collect();
    all.sort_unstable();
    all.dedup();
    let same = |a: &Place, b: &Place| a.0 == b.0 && a.1 == b.1;
    let kept = all.iter().enumerate().filter(|(at, place)| {
        let first = *at == 0 || !same(&all[at - 1], place);
        first || all.get(at + 1).is_none_or(|next| !same(next, place))
    });
    kept.map(|(_, place)| *place).collect()
}

/// The first run of every condition of a place, by rate.
fn runs(evidence: &Evidence, place: Place) -> Vec<usize> {
    let series = &evidence.design.series;
    let mut found: Vec<usize> = Vec::new();
    for (at, s) in series.iter().enumerate() {
        let here = (s.specimen, s.indenter, s.cycle) == place;
        if here && !found.iter().any(|other| series[*other].condition == s.condition) {
            found.push(at);
        }
    }
    found.sort_by_key(|at| series[*at].rate);
    found
}

fn grid(experiment: &Experiment, evidence: &Evidence, place: Place, runs: &[usize], after: Option<&str>) -> Grid {
    let design = &evidence.design;
    let (mut forces, mut residuals) = (Vec::new(), Vec::new());
    for &run in runs {
        let shown = Shown::of(evidence, run);
        let series = &design.series[run];
        let held = if series.hold_out { ", held out" } else { "" };
        let rate = words::rate(design.rates_mm_per_s[series.rate]);
        forces.push(force_panel(&shown, format!("{rate} mm/s{held}"), after.is_some()));
        residuals.push(residual_panel(&shown, series, after.is_some()));
    }
    let (specimen, indenter, cycle) = place;
    let mut title = experiment.indenters.get(indenter).map_or_else(String::new, |ball| ball.name.clone());
    if experiment.specimens.len() > 1 {
        title = format!("{title} on {}", experiment.specimens.get(specimen).map_or("", |its| its.name.as_str()));
    }
    if design.series.iter().any(|s| s.cycle != cycle) {
        title = format!("{title}, press {cycle} on its spot");
    }
    let mut keys = vec![
        Key::Curve("measured".to_owned(), Stroke::Circles, 5),
        Key::Curve("base".to_owned(), Stroke::Solid, 0),
        Key::Band("noise, 95 %".to_owned(), 0),
        Key::Band("sensor alone".to_owned(), 1),
    ];
    // the longest comes last, where there is room
    if let Some(after) = after {
        keys.push(Key::Curve(after.to_owned(), Stroke::Dashed, 1));
    }
    let row = |label: &str, height_px, panels| Row { label: label.to_owned(), height_px, panels };
    let rows = vec![row("force (N)", 150.0, forces), row("residual (N)", 130.0, residuals)];
    Grid { title, across: "depth (mm)".to_owned(), rows, keys }
}

fn force_panel(shown: &Shown, title: String, extended: bool) -> Panel {
    let mut series = vec![
        Series::new("", shown.over_depth(&shown.measured_n), Stroke::Circles, 5),
        Series::new("", shown.over_depth(&shown.base_n), Stroke::Solid, 0),
    ];
    if let Some(after) = shown.extended_n.as_ref().filter(|_| extended) {
        series.push(Series::new("", shown.over_depth(after), Stroke::Dashed, 1));
    }
    Panel { title, bands: Vec::new(), series }
}

fn residual_panel(shown: &Shown, run: &Run, extended: bool) -> Panel {
    let mut bands = Vec::new();
    for shade in [0, 1] {
        for branch in [Branch::Loading, Branch::Unloading] {
            let nodes = run.nodes.iter().zip(&shown.sigma_n).filter(|(n, _)| n.branch == branch);
            let points = nodes.map(|(n, (sensor, all))| {
                let half = Z95 * if shade == 0 { *all } else { *sensor };
                (n.depth_mm, -half, half)
            });
            bands.push(Band { points: points.collect(), shade });
        }
    }
    let mut series = vec![Series::new("", shown.over_depth(&shown.residual_n()), Stroke::Solid, 0)];
    if let Some(after) = shown.residual_after_n().filter(|_| extended) {
        series.push(Series::new("", shown.over_depth(&after), Stroke::Dashed, 1));
    }
    Panel { title: String::new(), bands, series }
}
