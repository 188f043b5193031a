//! The report of `palpate identify`.

use crate::experiment::Experiment;
use crate::identify::data::LoadingCurve;
use crate::identify::fit::{Fit, Parameter, RunFit};
use crate::identify::newton::fit::Newton;
use crate::identify::newton::valley::Valley;
use crate::identify::{Identification, Outcome, deepest_field};

use super::figure::{Axis, Figure, Series, Stroke};
use super::{Page, field, map, number, valley};

/// Most measured samples drawn per run; more only make the file large.
const DRAWN_SAMPLES: usize = 90;

/// Words of messages that must not be overlooked.
const GRAVE: [&str; 5] = ["systematically", "lies on a bound", "not used", "fault", "not determined"];

/// Builds the page for all materials of an experiment.
pub fn page(experiment: &Experiment, found: &[Identification]) -> Page {
    let mut page = Page::new(
        &format!("Identification: {}", experiment.name),
        "The law fitted to the first loading branch of every run, and to the hold after it for a relaxing material: by finite elements under a ball, in closed form where all of a specimen deforms alike. Units: mm, N, MPa, s.",
    );
    if found.is_empty() {
        page.warning("The experiment holds no run that indents, compresses or pulls a soft specimen.");
    }
    for one in found {
        if found.len() > 1 {
            page.section(&format!("Material: {}", one.material));
        }
        material(&mut page, experiment, one);
    }
    page
}

fn outcome_sentence(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Fitted => "Parameters were found.",
        Outcome::TooFewPoints => "Nothing was fitted: no run has enough samples on its way down.",
        Outcome::NoContact => "Nothing was fitted: force never rises above its noise.",
        Outcome::OutsideGrid => {
            "The best alpha lies at the edge of what the model covers: the parameters below are not to be trusted."
        }
        Outcome::DeeperThanTable => "Nothing was fitted: all samples lie deeper than the model reaches.",
    }
}

fn material(page: &mut Page, experiment: &Experiment, found: &Identification) {
    page.section("Result");
    match found.outcome {
        Outcome::Fitted => page.paragraph(outcome_sentence(found.outcome)),
        _ => page.warning(outcome_sentence(found.outcome)),
    }
    if let Some(fit) = &found.fit {
        let rows: Vec<Vec<String>> = fit.parameters.iter().map(parameter_row).collect();
        page.table(&["parameter", "value", "95 % interval", "bounds", ""], &rows);
        page.table(&["figure", "value"], &figures_of_fit(found, fit));
    }
    let grave = |message: &&String| GRAVE.iter().any(|word| message.contains(word));
    for message in found.messages.iter().filter(grave) {
        page.warning(message);
    }
    let plain: Vec<String> = found.messages.iter().filter(|m| !grave(m)).cloned().collect();
    page.list(&plain);
    page.section("Assumptions");
    page.list(&found.assumptions);
    if let Some(fit) = &found.fit {
        page.section("Data and fit");
        overview(page, experiment, found, fit);
        inside(page, found);
        page.section("Runs");
        for run in &fit.runs {
            one_run(page, experiment, found, run);
        }
        if let Some(search) = &fit.search {
            page.section("Objective");
            page.figure(
                &map::svg("Objective of MultiStart", search),
                "Sum of absolute force differences (Eq. 14), contact points at their best and other parameters where the best simplex ended; lines: simplex paths.",
            );
        }
        if let Some(newton) = &fit.newton {
            page.section("Objective");
            around(page, found, newton);
        }
    }
}

/// How the parameters hang together: the objective around the minimum, correlations.
fn around(page: &mut Page, found: &Identification, newton: &Newton) {
    let Some(valley) = Valley::around(newton, &found.selection) else {
        page.paragraph("One parameter: nothing makes up for it but the contact points.");
        return;
    };
    page.figure(&valley::svg("Objective around the minimum", newton, &valley), &valley::caption(newton, &valley));
    let Some(correlation) = &newton.correlation else {
        page.warning("The data tie some parameters exactly: no correlations can be given.");
        return;
    };
    let names: Vec<&str> = newton.solved.unknowns.iter().map(|unknown| unknown.name.as_str()).collect();
    let rows: Vec<Vec<String>> = names
        .iter()
        .enumerate()
        .map(|(i, name)| {
            let cells =
                (0..names.len()).map(|j| if j > i { String::new() } else { format!("{:.2}", correlation[(i, j)]) });
            std::iter::once((*name).to_owned()).chain(cells).collect()
        })
        .collect();
    page.paragraph("Correlation of the estimates:");
    page.table(&std::iter::once("").chain(names.iter().copied()).collect::<Vec<_>>(), &rows);
}

/// The specimen at the deepest point, computed with what was found.
fn inside(page: &mut Page, found: &Identification) {
    match deepest_field(found) {
        None => {}
        Some(Err(cause)) => page.warning(&format!("The inside of the specimen is not shown: {cause}.")),
        Some(Ok(field)) => {
            page.section("Inside the specimen");
            page.figure(
                &field::mises("Mises stress at the deepest point, with the parameters found", &field),
                &field::caption(&field),
            );
        }
    }
}

/// Name, value, interval, bounds and a word of warning.
fn parameter_row(parameter: &Parameter) -> Vec<String> {
    let range = |(low, high): (f64, f64)| match low.is_finite() && high.is_finite() {
        true => format!("{} to {}", number(low), number(high)),
        false => String::new(),
    };
    vec![
        parameter.name.clone(),
        number(parameter.value),
        range((parameter.interval95.low, parameter.interval95.high)),
        range(parameter.bounds),
        match (&parameter.verdict, parameter.at_bound, parameter.derived, parameter.fills_its_bounds()) {
            (_, true, ..) => "on a bound".to_owned(),
            (_, _, true, _) => "follows from the others".to_owned(),
            (Some(verdict), ..) => verdict.sentence.clone(),
            (None, .., true) => "not determined".to_owned(),
            _ => String::new(),
        },
    ]
}

fn figures_of_fit(found: &Identification, fit: &Fit) -> Vec<Vec<String>> {
    let row = |name: &str, value: String| vec![name.to_owned(), value];
    let mut rows = vec![
        row("residual, rms (N)", number(fit.rmse_n)),
        row("noise of a sample behind the intervals (N)", number(fit.noise.sigma_n)),
        row("neighbouring samples that count as one", number(fit.noise.correlated_samples)),
        row("error bound of the model, of the largest force (%)", number(100.0 * fit.model_error)),
    ];
    if let Some(check) = found.direct_check {
        rows.push(row("last solve differs from what was expected of it by (%)", number(100.0 * check)));
    }
    rows.push(row("finite element solves", found.fe_solves.to_string()));
    rows.push(row("time (s)", number(found.seconds)));
    rows
}

/// What a run is drawn in: depth and force, or, where a whole specimen deforms, strain and nominal stress.
struct Units {
    /// mm of depth per unit drawn.
    depth: f64,
    /// N per unit drawn.
    force: f64,
}

impl Units {
    fn of(experiment: &Experiment, found: &Identification, run: &RunFit) -> Self {
        let pairing = &found.selection.pairings[found.selection.curves[run.curve].pairing];
        let specimen = &experiment.specimens[pairing.specimen];
        match (pairing.grip.mode(), specimen.height_mm.known(), specimen.radius_mm.known()) {
            (Some(_), Some(height_mm), Some(radius_mm)) => {
                Self { depth: 0.01 * height_mm, force: std::f64::consts::PI * radius_mm * radius_mm }
            }
            _ => Self { depth: 1.0, force: 1.0 },
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
fn overview(page: &mut Page, experiment: &Experiment, found: &Identification, fit: &Fit) {
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
        together(page, experiment, found, &runs, &format!("{title} (circles) and fitted (lines)"));
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
    let mut residuals = Figure::new("Measured minus fitted", Axis::new(across), Axis::new(up));
    residuals.size.1 = 280.0;
    for (at, run) in runs.iter().enumerate() {
        let name = short_name(experiment, found, run);
        let units = Units::of(experiment, found, run);
        let line = Stroke::LINES[at % Stroke::LINES.len()];
        forces = forces.with(Series::new("", measured(found, run, &units), Stroke::Circles, at)).with(Series::new(
            &name,
            modelled(found, run, &units),
            line,
            at,
        ));
        residuals = residuals.with(Series::new(&name, residual(found, run, &units), line, at));
    }
    page.figure(&forces.svg(), "Every run shifted to its own fitted contact point.");
    page.figure(
        &residuals.svg(),
        "What the model leaves over. A residual that waves instead of scattering is misfit, not noise.",
    );
}

fn one_run(page: &mut Page, experiment: &Experiment, found: &Identification, run: &RunFit) {
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
        .with(Series::new("", contact, Stroke::Faint, 5))
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
