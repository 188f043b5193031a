//! The fit of one material: search, residuals, noise, intervals.

use crate::experiment::Experiment;
use crate::experiment::motion::noise_of;

use super::data::{LoadingCurve, Selection};
use super::interval::{self, Interval, StandardErrors};
use super::model::ForwardModel;
use super::multistart::{self, Search};
use super::noise::{self, Noise, NoiseSource, Residual};
use super::objective::{self, ALPHA, FIRST_HEIGHT, LN_MU, Objective};

/// A fitted parameter in the user's units.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Name with unit, as in the answer: `mu_MPa`, `alpha`, `height_mm`.
    pub name: String,
    /// Best value.
    pub value: f64,
    /// 95 % interval, cut to the bounds.
    pub interval95: Interval,
    /// Bounds of the search.
    pub bounds: (f64, f64),
    /// The best value lies on a bound.
    pub at_bound: bool,
}

impl Parameter {
    /// The interval is the whole range that was searched.
    pub fn fills_its_bounds(&self) -> bool {
        self.interval95.low <= self.bounds.0 && self.interval95.high >= self.bounds.1
    }
}

/// A run beside its model.
#[derive(Debug, Clone, PartialEq)]
pub struct RunFit {
    /// Index into [`Selection::curves`].
    pub curve: usize,
    /// Fitted contact point, mm.
    pub contact_mm: f64,
    /// The contact point lies on a wall of its range.
    pub contact_at_bound: bool,
    /// Modelled forces at the run's samples, N.
    pub model_n: Vec<f64>,
    /// Root mean square of measured minus modelled force, N.
    pub rmse_n: f64,
    /// Where the smoothed residual is largest: depth below contact in mm, residual in N.
    pub worst: (f64, f64),
    /// Sample-to-sample noise of its force, N.
    pub sample_noise_n: f64,
}

/// Everything a fit found.
#[derive(Debug, Clone)]
pub struct Fit {
    /// alpha, ln mu, free heights.
    pub point: Vec<f64>,
    /// The same for the user.
    pub parameters: Vec<Parameter>,
    /// Eq. 14 at the optimum, N.
    pub objective_n: f64,
    /// Every run, predicted ones included.
    pub runs: Vec<RunFit>,
    /// Root mean square residual over the fitted runs, N.
    pub rmse_n: f64,
    /// Noise behind the intervals.
    pub noise: Noise,
    /// Standard errors in the space of the fit.
    pub errors: StandardErrors,
    /// Relative error bound of the forward model.
    pub model_error: f64,
    /// MultiStart.
    pub search: Search,
}

/// Fits a selection; `None` if no material pushes back like these data.
///
/// `groups` lists runs (indices into the experiment) that repeat each other.
pub fn fit(
    selection: &Selection,
    model: &dyn ForwardModel,
    groups: &[Vec<usize>],
    stated_noise_n: Option<f64>,
) -> Option<Fit> {
    let objective = Objective { selection, model };
    let search = multistart::search(&objective)?;
    let best = search.descents.first()?;
    let point = best.point.clone();
    let curves = objective.unit_curves(&point);
    let mu_mpa = point[LN_MU].exp();
    let runs: Vec<RunFit> = selection
        .curves
        .iter()
        .enumerate()
        .map(|(at, data)| {
            let (contact_mm, _) = objective::best_contact(data, &curves[data.pairing], mu_mpa);
            let model_n: Vec<f64> =
                data.depth_mm.iter().map(|depth| mu_mpa * curves[data.pairing].at(depth - contact_mm)).collect();
            run_fit(at, data, contact_mm, model_n)
        })
        .collect();
    let fitted: Vec<&RunFit> = runs.iter().filter(|run| !selection.curves[run.curve].hold_out).collect();
    let residuals: Vec<Residual> = fitted.iter().map(|run| run.residual(&selection.curves[run.curve])).collect();
    let groups = groups_of_residuals(groups, selection, &fitted);
    let noise = noise::estimate(&residuals, &groups, stated_noise_n);
    let contacts: Vec<f64> = fitted.iter().map(|run| run.contact_mm).collect();
    let errors = interval::standard_errors(&objective, &search.bounds, &point, &contacts, &noise);
    let series: Vec<Vec<f64>> = residuals.into_iter().map(|r| r.residual_n).collect();
    Some(Fit {
        parameters: parameters(selection, &point, &search, &errors),
        objective_n: best.value,
        rmse_n: noise::rms(&series),
        model_error: model.relative_error(),
        point,
        runs,
        noise,
        errors,
        search,
    })
}

fn run_fit(curve: usize, data: &LoadingCurve, contact_mm: f64, model_n: Vec<f64>) -> RunFit {
    let residual: Vec<f64> = data.force_n.iter().zip(&model_n).map(|(f, m)| f - m).collect();
    let window = (residual.len() / 20).max(3);
    let worst = residual
        .windows(window)
        .enumerate()
        .map(|(at, part)| {
            let depth = data.depth_mm[at + window / 2] - contact_mm;
            (depth, part.iter().sum::<f64>() / window as f64)
        })
        .max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
        .unwrap_or((0.0, 0.0));
    let reach = 1e-3 * (data.contact.high_mm - data.contact.low_mm);
    let inside = data.contact.low_mm + reach..data.contact.high_mm - reach;
    RunFit {
        curve,
        contact_mm,
        contact_at_bound: !inside.contains(&contact_mm),
        model_n,
        rmse_n: noise::rms(&[residual]),
        worst,
        sample_noise_n: noise_of(&data.force_n),
    }
}

impl RunFit {
    fn residual(&self, data: &LoadingCurve) -> Residual {
        Residual {
            depth_mm: data.depth_mm.iter().map(|depth| depth - self.contact_mm).collect(),
            residual_n: data.force_n.iter().zip(&self.model_n).map(|(f, m)| f - m).collect(),
        }
    }
}

/// Replicate groups, from indices of runs to indices of fitted residuals.
fn groups_of_residuals(groups: &[Vec<usize>], selection: &Selection, fitted: &[&RunFit]) -> Vec<Vec<usize>> {
    let place = |run: &usize| fitted.iter().position(|f| selection.curves[f.curve].run == *run);
    groups.iter().map(|group| group.iter().filter_map(place).collect()).collect()
}

fn parameters(selection: &Selection, point: &[f64], search: &Search, errors: &StandardErrors) -> Vec<Parameter> {
    let bounds = &search.bounds;
    let mut list = Vec::new();
    for axis in [LN_MU, ALPHA].into_iter().chain(FIRST_HEIGHT..point.len()) {
        let interval = errors.interval(point, bounds, axis);
        let (name, shown): (String, fn(f64) -> f64) = match axis {
            LN_MU => ("mu_MPa".to_owned(), f64::exp),
            ALPHA => ("alpha".to_owned(), |x| x),
            _ if selection.heights.len() > 1 => (format!("height_{}_mm", axis - FIRST_HEIGHT + 1), |x| x),
            _ => ("height_mm".to_owned(), |x| x),
        };
        list.push(Parameter {
            name,
            value: shown(point[axis]),
            interval95: Interval { low: shown(interval.low), high: shown(interval.high) },
            bounds: (shown(bounds.low[axis]), shown(bounds.high[axis])),
            at_bound: interval::at_bound(point, bounds, axis),
        });
    }
    list
}

impl Fit {
    /// Largest smoothed residual of a fitted run in units of that run's sample noise, with the
    /// run's index into [`Fit::runs`].
    pub fn largest_misfit(&self, selection: &Selection) -> Option<(usize, f64)> {
        self.runs
            .iter()
            .enumerate()
            .filter(|(_, run)| !selection.curves[run.curve].hold_out)
            .map(|(at, run)| (at, run.worst.1.abs() / self.noise_unit(run)))
            .max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// The noise a misfit is measured in: known noise, or what one sample scatters around its
    /// neighbours where only the residual itself is known.
    fn noise_unit(&self, run: &RunFit) -> f64 {
        match self.noise.source {
            NoiseSource::Replicates | NoiseSource::Stated if self.noise.sigma_n > 0.0 => self.noise.sigma_n,
            // Replicates that are equal to the last digit say nothing about noise.
            _ => run.sample_noise_n,
        }
        // A micronewton is below what any of these sensors resolves: data without noise, from a model.
        .max(1e-6)
    }

    pub(super) fn messages(&self, experiment: &Experiment, selection: &Selection) -> Vec<String> {
        let mut messages = Vec::new();
        for parameter in self.parameters.iter().filter(|parameter| parameter.at_bound) {
            messages.push(format!(
                "{} = {:.4} lies on a bound of its search ({:.4} to {:.4}): the data ask for more than the model covers",
                parameter.name, parameter.value, parameter.bounds.0, parameter.bounds.1
            ));
        }
        for parameter in self.parameters.iter().filter(|parameter| parameter.fills_its_bounds()) {
            messages.push(format!(
                "{} is not determined by these data: its interval fills the range searched, {:.4} to {:.4}",
                parameter.name, parameter.bounds.0, parameter.bounds.1
            ));
        }
        for run in self.runs.iter().filter(|run| run.contact_at_bound) {
            let file = &experiment.runs[selection.curves[run.curve].run].file;
            messages
                .push(format!("{file}: the contact point, {:.3} mm, lies on a bound of its search", run.contact_mm));
        }
        messages.push(format!("intervals: {}", self.noise.source.sentence()));
        if let Some((at, units)) = self.largest_misfit(selection)
            && units > SYSTEMATIC
        {
            let run = &self.runs[at];
            let unit = match self.noise.source {
                NoiseSource::Replicates | NoiseSource::Stated if self.noise.sigma_n > 0.0 => "the noise",
                _ => "the scatter between neighbouring samples",
            };
            messages.push(format!(
                "the model is systematically wrong: {} lies {:+.4} N off it around {:.2} mm past contact, {:.0} times {unit}; the intervals say how well the fit is determined, not how near it is to the truth",
                experiment.runs[selection.curves[run.curve].run].file, run.worst.1, run.worst.0, units
            ));
        }
        let ends: Vec<f64> = self.search.descents.iter().map(|end| end.value).collect();
        let agreeing = ends.iter().filter(|value| **value <= 1.01 * self.objective_n).count();
        if agreeing < ends.len() {
            messages
                .push(format!("{agreeing} of {} starts end within 1 % of the best objective; see the map", ends.len()));
        }
        messages
    }
}

/// A smoothed residual above this many noise units is called systematic. Smoothing over a
/// twentieth of the samples divides white noise by three or more, so chance stays far below.
const SYSTEMATIC: f64 = 4.0;
