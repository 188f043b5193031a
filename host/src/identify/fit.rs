//! The fit of one material: search, residuals, noise, intervals.

use crate::experiment::Experiment;
use crate::experiment::motion::noise_of;
use crate::infer::covariance::{Z95, covariance};
use crate::infer::descent::{Ending, Minimum};
use lut_gen::solid::law::Material;
use lut_gen::solid::model::{Resolution, Simulation};

use super::data::{LoadingCurve, Selection};
use super::interval::Interval;
use super::multistart::{self, Search, StandardErrors};
use super::newton::condition::Condition;
use super::newton::coordinate::{Kind, ON_BOUND, Unknown};
use super::newton::fit::{Newton, Span};
use super::newton::linear::Linear;
use super::newton::problem::{Problem, forces};
use super::newton::verdict::{Judged, Verdict, judge};
use super::noise::{self, Noise, NoiseSource, Residual};

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
    /// What these runs say of it.
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
    /// What the sensor most likely read at its first sample without a contact, N, where that is free.
    pub zero_n: f64,
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
    /// The law that was found: one, or one a specimen (an index into the experiment's) where they have their own.
    pub materials: Vec<(usize, Material)>,
}

/// What MultiStart found, as a fit; the problem is left with Eq. 14 as its objective. `None` without a start.
///
/// `groups` lists runs (indices into the experiment) that repeat each other.
pub fn by_multistart(
    problem: &mut Problem<'_>,
    search: Search,
    groups: &[Vec<usize>],
    stated_noise_n: Option<f64>,
) -> Option<Fit> {
    let point = search.starts.first()?.descent.point.clone();
    let curves = runs_at(problem, &point);
    let noises = problem.weigh_by_fit(&point, groups, stated_noise_n);
    multistart::as_eq_14(problem);
    let model_error = problem.conditions.iter().map(Condition::error).fold(0.0, f64::max);
    let end = Minimum {
        at: problem.quadratic(&point),
        x: point.clone(),
        steps: search.evaluations(),
        ending: if search.converged() { Ending::Settled } else { Ending::OutOfSteps },
        promised: 0.0,
    };
    let errors = StandardErrors::of(problem, &search.bounds, &end, &noises, model_error);
    let mut parameters = simplex_parameters(problem, &search, &point, &errors);
    parameters.extend(derived(problem, &point, &spread(&point, &errors)));
    let (objective_n, rmse_n, noise) = summary(problem.selection, &curves, &noises);
    Some(Fit {
        parameters,
        objective_n,
        rmse_n,
        noise,
        model_error,
        deepest: deepest_at(problem, &point, &curves),
        materials: materials_at(problem, &point),
        runs: curves,
        search: Some(search),
        newton: None,
        linear: None,
    })
}

/// The point with each coordinate at the ends of its interval in turn, the others following: where a derived parameter can be.
fn spread(point: &[f64], errors: &StandardErrors) -> Vec<Vec<f64>> {
    let Some(covariance) = covariance(&errors.information) else { return Vec::new() };
    let ends = |axis: usize| {
        let variance = covariance[(axis, axis)].max(f64::MIN_POSITIVE);
        [-Z95, Z95].map(|z| {
            let along = |i: usize| point[i] + z * covariance[(i, axis)] / variance.sqrt();
            (0..point.len()).map(along).collect::<Vec<_>>()
        })
    };
    (0..point.len()).flat_map(ends).collect()
}

fn simplex_parameters(
    problem: &Problem<'_>,
    search: &Search,
    point: &[f64],
    errors: &StandardErrors,
) -> Vec<Parameter> {
    let ends: Vec<(f64, f64)> = (0..point.len())
        .map(|axis| {
            let half = Z95 * errors.noise[axis].hypot(errors.model[axis]);
            ((point[axis] - half).max(search.bounds.low[axis]), (point[axis] + half).min(search.bounds.high[axis]))
        })
        .collect();
    let on_bound = |axis: usize| {
        let (x, side) = (point[axis], search.bounds.side(axis));
        (x - search.bounds.low[axis]).min(search.bounds.high[axis] - x) < ON_BOUND * side
    };
    let judged: Vec<Judged> = problem
        .unknowns
        .iter()
        .enumerate()
        .map(|(axis, unknown)| {
            let (low, high) = unknown.bounds();
            Judged {
                name: unknown.name.clone(),
                range: high - low,
                interval: ends[axis].1 - ends[axis].0,
                open_low: !errors.noise[axis].is_finite(),
                open_high: !errors.noise[axis].is_finite(),
                at_bound: on_bound(axis),
                logarithmic: unknown.is_logarithmic(),
            }
        })
        .collect();
    let verdicts = judge(&errors.information, &judged);
    let one = |(axis, verdict): (usize, Verdict)| {
        let unknown = &problem.unknowns[axis];
        Parameter {
            name: unknown.name.clone(),
            value: unknown.value(point[axis]),
            interval95: Interval { low: unknown.value(ends[axis].0), high: unknown.value(ends[axis].1) },
            bounds: (unknown.value(search.bounds.low[axis]), unknown.value(search.bounds.high[axis])),
            at_bound: on_bound(axis),
            verdict: Some(verdict),
            derived: false,
            logarithmic: unknown.is_logarithmic(),
            unseen: None,
        }
    };
    verdicts.into_iter().enumerate().map(one).collect()
}

/// Every run beside its model at a point.
fn runs_at(problem: &Problem<'_>, point: &[f64]) -> Vec<RunFit> {
    let selection = problem.selection;
    let tracks = problem.tracks(point);
    (0..selection.curves.len())
        .map(|at| {
            let track = &tracks[problem.condition_of[at]];
            let contact_mm = problem.contact(at, track);
            let data = &selection.curves[at];
            let mut force_n = forces(data, track, contact_mm);
            let zero_n = problem.zero_n(at, &force_n);
            force_n.iter_mut().zip(&zero_n).for_each(|(force, zero)| *force += zero);
            RunFit { zero_n: zero_n.first().copied().unwrap_or(0.0), ..run_fit(at, data, contact_mm, force_n) }
        })
        .collect()
}

/// Eq. 14 and the rms of what is left over (N), and the noise behind it.
fn summary(selection: &Selection, runs: &[RunFit], noises: &[Noise]) -> (f64, f64, Noise) {
    let fitted: Vec<&RunFit> = runs.iter().filter(|run| !selection.curves[run.curve].hold_out).collect();
    let residuals: Vec<Vec<f64>> =
        fitted.iter().map(|run| run.residual(&selection.curves[run.curve]).residual_n).collect();
    (residuals.iter().flatten().map(|r| r.abs()).sum(), noise::rms(&residuals), pooled(noises, &fitted))
}

/// The run that a ball went deepest in, simulated at a point.
fn deepest_at(problem: &Problem<'_>, point: &[f64], runs: &[RunFit]) -> Option<Simulation> {
    let selection = problem.selection;
    let under_ball = |run: &&RunFit| problem.conditions[problem.condition_of[run.curve]].grip.indenter().is_some();
    let (depth_mm, curve) = runs
        .iter()
        .filter(|run| !selection.curves[run.curve].hold_out)
        .filter(under_ball)
        .map(|run| {
            let data = &selection.curves[run.curve];
            let last = data.depth_mm[..data.hold_from].iter().copied().fold(f64::NEG_INFINITY, f64::max);
            (last - run.contact_mm, run.curve)
        })
        .max_by(|a, b| a.0.total_cmp(&b.0))?;
    let condition = problem.condition_of[curve];
    let values = problem.values(condition, point);
    let mut condition = problem.conditions[condition].clone();
    (condition.depth_mm, condition.hold_s) = (depth_mm, 0.0);
    let mut simulation = condition.simulation(&values, Resolution::Standard).ok()?;
    simulation.material = values.material().ok()?;
    Some(simulation)
}

/// The laws at a point that differ, each with the first specimen that has it.
fn materials_at(problem: &Problem<'_>, point: &[f64]) -> Vec<(usize, Material)> {
    let mut found: Vec<(usize, Material)> = Vec::new();
    for (at, condition) in problem.conditions.iter().enumerate() {
        let Ok(material) = problem.values(at, point).material() else { continue };
        if found.iter().all(|(_, other)| *other != material) {
            found.push((condition.specimen, material));
        }
    }
    found
}

/// What Gauss-Newton found, as a fit.
pub fn by_newton(problem: &Problem<'_>, newton: Newton) -> Fit {
    let point = &newton.minimum.x;
    let runs = runs_at(problem, point);
    let mut parameters: Vec<Parameter> = (0..problem.unknowns.len()).map(|at| found(problem, &newton, at)).collect();
    parameters.extend(derived(problem, point, &newton.supports));
    let (objective_n, rmse_n, noise) = summary(problem.selection, &runs, &newton.noises);
    Fit {
        parameters,
        objective_n,
        rmse_n,
        noise,
        model_error: newton.model_error,
        deepest: deepest_at(problem, point, &runs),
        materials: materials_at(problem, point),
        runs,
        search: None,
        linear: problem.linear(point),
        newton: Some(newton),
    }
}

/// One noise for all fitted curves: the worst source, the rms of the levels, the mean correlation.
fn pooled(noises: &[Noise], fitted: &[&RunFit]) -> Noise {
    let all: Vec<Noise> = fitted.iter().map(|run| noises[run.curve]).collect();
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

/// Parameters that follow from the coordinates; their intervals are their range over the ends of all other intervals.
fn derived(problem: &Problem<'_>, point: &[f64], supports: &[Vec<f64>]) -> Vec<Parameter> {
    let place = |kind: Kind| problem.unknowns.iter().position(|u: &Unknown| u.kind == kind);
    let mut list = Vec::new();
    let mut add = |name: &str, of: &dyn Fn(&[f64]) -> f64| {
        let value = of(point);
        let all = supports.iter().map(|point| of(point)).chain([value]);
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
        zero_n: 0.0,
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

    /// Repeats that differ by far more than readings scatter.
    fn unlike_repeats(&self, selection: &Selection) -> Option<String> {
        let fitted = self.runs.iter().filter(|run| !selection.curves[run.curve].hold_out);
        let peak_n = fitted.clone().flat_map(|run| &selection.curves[run.curve].force_n).copied().fold(0.0, f64::max);
        let scatter_n = fitted.map(|run| run.sample_noise_n).fold(0.0, f64::max);
        let apart_n = self.noise.sigma_n;
        let unlike = self.noise.source == NoiseSource::Replicates
            && apart_n > UNLIKE_SIGMA * scatter_n
            && apart_n > UNLIKE_SHARE * peak_n;
        unlike.then(|| {
            format!(
                "runs that are taken for repeats differ by {:.1} % of the largest force, {:.0} times what readings scatter: places or \
                 pieces that differ, or runs of which one is of another ball or specimen than it says",
                100.0 * apart_n / peak_n,
                apart_n / scatter_n.max(f64::MIN_POSITIVE)
            )
        })
    }

    /// What became of zeros of the force that no approach shows.
    fn free_zeros(&self, experiment: &Experiment, selection: &Selection) -> Option<String> {
        let curve = |run: &RunFit| &selection.curves[run.curve];
        let free = |run: &&RunFit| curve(run).zero_is_free && !curve(run).hold_out;
        let all: Vec<&RunFit> = self.runs.iter().filter(free).collect();
        let list = |run: &&RunFit| format!("{} {:+.4} N", experiment.runs[curve(run).run].file, run.zero_n);
        let told: Vec<String> = all.iter().take(4).map(list).collect();
        let more = if all.len() > told.len() { ", ..." } else { "" };
        (!all.is_empty()).then(|| {
            format!(
                "force zero: {} run(s) record no force before contact, so it is not seen; it is free within {:.0} % of the largest \
                 force (one standard deviation), which widens the intervals: {}{more}. Record a millimetre of approach, or state \
                 [sensor] zero = \"known\"",
                all.len(),
                100.0 * super::zero::PRIOR_SHARE,
                told.join(", "),
            )
        })
    }

    pub(super) fn messages(&self, experiment: &Experiment, selection: &Selection) -> Vec<String> {
        let mut messages = Vec::new();
        for parameter in self.parameters.iter().filter(|parameter| parameter.at_bound) {
            messages.push(format!(
                "{} = {:.4} lies on a bound of its search ({:.4} to {:.4}): these data do not fix it; `palpate diagnose` looks for what the law lacks",
                parameter.name, parameter.value, parameter.bounds.0, parameter.bounds.1
            ));
        }
        for parameter in self.parameters.iter().filter(|parameter| parameter.fills_its_bounds() && !parameter.derived) {
            messages.push(format!(
                "{} is not determined by these data: its interval is all of the range searched, {:.4} to {:.4}",
                parameter.name, parameter.bounds.0, parameter.bounds.1
            ));
        }
        for run in self.runs.iter().filter(|run| run.contact_at_bound) {
            let file = &experiment.runs[selection.curves[run.curve].run].file;
            messages
                .push(format!("{file}: the contact point, {:.3} mm, lies on a bound of its search", run.contact_mm));
        }
        messages.extend(self.free_zeros(experiment, selection));
        messages.extend(self.newton.iter().flat_map(Newton::messages));
        messages.push(format!("intervals: {}", self.noise.source.sentence()));
        messages.extend(self.unlike_repeats(selection));
        if let Some((at, units)) = self.largest_misfit(selection)
            && units > SYSTEMATIC
        {
            let run = &self.runs[at];
            let unit = match self.noise.source {
                NoiseSource::Replicates | NoiseSource::Stated if self.noise.sigma_n > 0.0 => "the noise",
                _ => "the scatter between neighbouring samples",
            };
            messages.push(format!(
                "the model is systematically wrong: {} differs by {:+.4} N near {:.2} mm past contact, {:.0} times {unit}; the intervals do not cover that, and `palpate diagnose` looks for the cause",
                experiment.runs[selection.curves[run.curve].run].file, run.worst.1, run.worst.0, units
            ));
        }
        messages.extend(self.search.iter().flat_map(Search::messages));
        messages
    }
}

/// Repeats are unlike where they differ by this many times what readings scatter, and by this share of the largest force.
const UNLIKE_SIGMA: f64 = 8.0;
const UNLIKE_SHARE: f64 = 0.02;

/// A smoothed residual above this many noise units is called systematic. Smoothing over a
/// twentieth of the samples divides white noise by three or more, so chance stays far below.
const SYSTEMATIC: f64 = 4.0;
