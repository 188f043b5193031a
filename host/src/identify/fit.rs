//! The fit of one material: search, residuals, noise, intervals.

use crate::experiment::Experiment;
use crate::experiment::motion::noise_of;
use lut_gen::model::{Resolution, Simulation};

use super::data::{LoadingCurve, Selection};
use super::interval::{self, Interval, StandardErrors};
use super::model::ForwardModel;
use super::multistart::{self, Search};
use super::newton::coordinate::{Kind, Unknown};
use super::newton::fit::{Newton, Span};
use super::newton::linear::Linear;
use super::newton::problem::{Problem, forces};
use super::newton::verdict::Verdict;
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
    /// What these runs say of it; the simplex does not.
    pub verdict: Option<Verdict>,
    /// It follows from others and was not searched itself.
    pub derived: bool,
    /// It was searched by its logarithm.
    pub logarithmic: bool,
    /// What effects that nobody fitted do to its interval, once that was asked for ([`crate::unseen`]).
    pub unseen: Option<Unseen>,
}

/// What widened an interval.
#[derive(Debug, Clone, PartialEq)]
pub struct Unseen {
    /// The interval of noise alone.
    pub noise: Interval,
    /// Width of the interval over that of noise alone, in the coordinate of the search.
    pub times: f64,
    /// Codes of effects with the share of the variance that each adds, the largest first.
    pub by: Vec<(&'static str, f64)>,
}

impl Parameter {
    /// The value at a coordinate of the search.
    pub fn shown(&self, x: f64) -> f64 {
        if self.logarithmic { x.exp() } else { x }
    }

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
    /// What was found.
    pub parameters: Vec<Parameter>,
    /// Eq. 14 at the optimum: the sum of absolute differences, N.
    pub objective_n: f64,
    /// Every run, predicted ones included.
    pub runs: Vec<RunFit>,
    /// Root mean square residual over the fitted runs, N.
    pub rmse_n: f64,
    /// Noise behind the intervals.
    pub noise: Noise,
    /// Relative error bound of the forward model.
    pub model_error: f64,
    /// MultiStart, if that was the method.
    pub search: Option<Search>,
    /// Gauss-Newton, if that was the method.
    pub newton: Option<Newton>,
    /// The fit near its minimum, row by row, of Gauss-Newton.
    pub linear: Option<Linear>,
    /// The run that went deepest, simulated with what was found.
    pub deepest: Option<Simulation>,
}

/// Fits a selection by MultiStart; `None` if no material pushes back like these data.
///
/// Also returns the point in the search's own coordinates. `groups` lists runs (indices into the experiment) that repeat each other.
pub fn by_simplex(
    selection: &Selection,
    model: &dyn ForwardModel,
    groups: &[Vec<usize>],
    stated_noise_n: Option<f64>,
) -> Option<(Fit, Vec<f64>)> {
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
    let fit = Fit {
        parameters: parameters(selection, &point, &search, &errors),
        objective_n: best.value,
        rmse_n: noise::rms(&series),
        model_error: model.relative_error(),
        runs,
        noise,
        search: Some(search),
        newton: None,
        linear: None,
        deepest: None,
    };
    Some((fit, point))
}

/// What Gauss-Newton found, as a fit.
pub fn by_newton(problem: &Problem<'_>, newton: Newton) -> Fit {
    let selection = problem.selection;
    let point = &newton.minimum.x;
    let tracks = problem.tracks(point);
    let runs: Vec<RunFit> = (0..selection.curves.len())
        .map(|at| {
            let track = &tracks[problem.condition_of[at]];
            let contact_mm = problem.contact(at, track);
            run_fit(at, &selection.curves[at], contact_mm, forces(&selection.curves[at], track, contact_mm))
        })
        .collect();
    let fitted: Vec<&RunFit> = runs.iter().filter(|run| !selection.curves[run.curve].hold_out).collect();
    let residuals: Vec<Vec<f64>> =
        fitted.iter().map(|run| run.residual(&selection.curves[run.curve]).residual_n).collect();
    let deepest = fitted
        .iter()
        .filter(|run| problem.conditions[problem.condition_of[run.curve]].grip.indenter().is_some())
        .map(|run| {
            let data = &selection.curves[run.curve];
            let last = data.depth_mm[..data.hold_from].iter().copied().fold(f64::NEG_INFINITY, f64::max);
            (last - run.contact_mm, run.curve)
        })
        .max_by(|a, b| a.0.total_cmp(&b.0));
    let deepest = deepest.and_then(|(depth_mm, curve)| {
        let condition = problem.condition_of[curve];
        let values = problem.values(condition, point);
        let mut condition = problem.conditions[condition].clone();
        (condition.depth_mm, condition.hold_s) = (depth_mm, 0.0);
        let mut simulation = condition.simulation(&values, Resolution::Standard).ok()?;
        simulation.material = values.material().ok()?;
        Some(simulation)
    });
    let mut parameters: Vec<Parameter> = (0..problem.unknowns.len()).map(|at| found(problem, &newton, at)).collect();
    parameters.extend(derived(problem, &newton));
    Fit {
        parameters,
        objective_n: residuals.iter().flatten().map(|r| r.abs()).sum(),
        rmse_n: noise::rms(&residuals),
        noise: pooled(&newton, &fitted),
        model_error: newton.model_error,
        runs,
        search: None,
        deepest,
        linear: problem.linear(&newton.minimum.x),
        newton: Some(newton),
    }
}

/// One noise for all fitted curves: the worst source, the rms of the levels, the mean correlation.
fn pooled(newton: &Newton, fitted: &[&RunFit]) -> Noise {
    let all: Vec<Noise> = fitted.iter().map(|run| newton.noises[run.curve]).collect();
    let count = all.len().max(1) as f64;
    let worst = all.iter().map(|n| n.source).max_by_key(|source| *source as u8);
    Noise {
        source: worst.unwrap_or(NoiseSource::Residual),
        sigma_n: (all.iter().map(|n| n.sigma_n.powi(2)).sum::<f64>() / count).sqrt(),
        correlated_samples: all.iter().map(|n| n.correlated_samples).sum::<f64>() / count,
    }
}

fn found(problem: &Problem<'_>, newton: &Newton, at: usize) -> Parameter {
    let unknown = &problem.unknowns[at];
    let x = newton.minimum.x[at];
    let Span { low: from, high: to, .. } = newton.spans[at];
    Parameter {
        name: unknown.name.clone(),
        value: unknown.value(x),
        interval95: Interval { low: unknown.value(from), high: unknown.value(to) },
        bounds: (unknown.low, unknown.high),
        at_bound: unknown.stands_on_bound(x),
        verdict: newton.verdicts.get(at).cloned(),
        derived: false,
        logarithmic: unknown.is_logarithmic(),
        unseen: None,
    }
}

/// Parameters that follow from the coordinates; their intervals are their range over the ends of all profiles.
fn derived(problem: &Problem<'_>, newton: &Newton) -> Vec<Parameter> {
    let place = |kind: Kind| problem.unknowns.iter().position(|u: &Unknown| u.kind == kind);
    let mut list = Vec::new();
    let mut add = |name: &str, of: &dyn Fn(&[f64]) -> f64| {
        let value = of(&newton.minimum.x);
        let all = newton.supports.iter().map(|point| of(point)).chain([value]);
        let (low, high) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
        list.push(Parameter {
            name: name.to_owned(),
            value,
            interval95: Interval { low, high },
            bounds: (f64::NEG_INFINITY, f64::INFINITY),
            at_bound: false,
            verdict: None,
            derived: true,
            logarithmic: false,
            unseen: None,
        });
    };
    let value = |at: usize| move |point: &[f64]| problem.unknowns[at].value(point[at]);
    if let (Some(mu), Some(share)) = (place(Kind::Modulus), place(Kind::Share)) {
        let (mu, share) = (value(mu), value(share));
        add("mu_1_MPa", &|point| mu(point) * (1.0 - share(point)));
        add("mu_2_MPa", &|point| mu(point) * share(point));
    }
    if let (Some(mu), Some(c)) = (place(Kind::Modulus), place(Kind::Compressibility)) {
        let (mu, c) = (value(mu), value(c));
        add("D_per_MPa", &|point| c(point) / mu(point));
        add("nu", &|point| (3.0 - c(point)) / (6.0 + c(point)));
    }
    list
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
            verdict: None,
            derived: false,
            logarithmic: axis == LN_MU,
            unseen: None,
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
        for parameter in self.parameters.iter().filter(|parameter| parameter.fills_its_bounds() && !parameter.derived) {
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
        messages.extend(self.newton.iter().flat_map(Newton::messages));
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
        let descents = self.search.iter().flat_map(|search| &search.descents);
        let ends: Vec<f64> = descents.map(|end| end.value).collect();
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
