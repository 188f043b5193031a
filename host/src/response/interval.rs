//! Intervals of a law's parameters.
//!
//! From the information of the whitened slopes. Where the whitened residual still depends on its past, the covariance is that of Newey and
//! West (1987, doi:10.2307/1913610). A parameter that is near the end of its range, where the misfit is no parabola, has the interval of its
//! profile: the values at which all others, searched again, leave no more misfit than Student's quantile allows.

use nalgebra::{DMatrix, DVector};

use super::fit::{Fitted, Problem, Record, coordinate, value};
use super::law::{Law, Parameter};
use super::noise::ljung_box;
use super::rough::roughness;
use crate::calibration::distribution::student_critical;

/// Lags of the test whether the residual is white.
pub const LAGS: usize = 30;
/// Nearer to zero than so many standard errors a profile is taken.
const NEAR: f64 = 4.0;
/// Steps of a search of a profile.
const STEPS: usize = 12;
/// Halvings of a profile's bracket.
const HALVINGS: usize = 8;

/// A parameter with what is known of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Known {
    /// Which.
    pub parameter: Parameter,
    /// Estimate.
    pub value: f64,
    /// 95 % interval; an end that the recording does not tell is infinite.
    pub interval95: (f64, f64),
}

/// What the intervals rest on.
#[derive(Debug, Clone, PartialEq)]
pub struct Known95 {
    /// The parameters.
    pub parameters: Vec<Known>,
    /// Statistic of Ljung and Box over its degrees of freedom, and what white noise exceeds once in a hundred records.
    pub whiteness: (f64, f64),
    /// Mean square of the estimates' scatter over that of the slopes: kinks make it more than 1.
    pub rough: f64,
    /// Standard deviation of the residual, mm.
    pub sd_mm: f64,
    /// Covariance of the coordinates that were free, in the order of the fit; zero for the others.
    pub covariance: DMatrix<f64>,
}

/// Intervals of a fit.
#[must_use]
pub fn intervals(record: &Record, fitted: &Fitted) -> Known95 {
    let n = fitted.white_mm.len();
    let variance = fitted.misfit() / (n.saturating_sub(fitted.free.len())).max(1) as f64;
    let whiteness = ljung_box(fitted.white_mm.as_slice(), LAGS.min(n / 5).max(1), fitted.noise.coefficients.len());
    let robust = whiteness.0 > whiteness.1;
    let covariance = covariance(fitted, variance, robust);
    // A rough misfit hides what a search has chosen among.
    let rough = roughness(record, fitted, variance.sqrt(), &covariance);
    let t = rough.sqrt() * student_critical(0.05, n as f64 - fitted.free.len() as f64);
    let each = fitted.free.iter().enumerate().map(|(i, parameter)| {
        let at = coordinate(*parameter, parameter.of(&fitted.law));
        let reach = t * covariance[(i, i)].sqrt();
        let from_zero = !parameter.is_logarithmic() && zero_based(*parameter);
        let mut interval95 = if reach > 0.0 {
            (value(*parameter, at - reach), value(*parameter, at + reach))
        } else {
            (f64::NEG_INFINITY, f64::INFINITY)
        };
        if from_zero && (reach == 0.0 || at < NEAR * reach / t) {
            // Correlation that is left makes the misfit count for less.
            let inflation = if robust { inflation(fitted, variance, &covariance, i) } else { 1.0 };
            interval95 = profile(record, fitted, *parameter, t * (inflation * variance).sqrt());
        }
        Known { parameter: *parameter, value: parameter.of(&fitted.law), interval95 }
    });
    Known95 { parameters: each.collect(), whiteness, rough, sd_mm: variance.sqrt(), covariance: covariance.clone() }
}

/// Parameters that cannot be below 0.
fn zero_based(parameter: Parameter) -> bool {
    matches!(parameter, Parameter::Delay | Parameter::Friction | Parameter::Play)
}

/// Coordinates that the recording tells something of, and that no end of their range holds.
fn told(fitted: &Fitted) -> Vec<usize> {
    let norms: Vec<f64> = fitted.slopes.column_iter().map(|column| column.norm()).collect();
    let is_told = |i: &usize| {
        let parameter = fitted.free[*i];
        let at_end = zero_based(parameter) && parameter.of(&fitted.law) == 0.0;
        let in_corner = parameter == Parameter::StartShare && parameter.of(&fitted.law).abs() >= 0.5;
        norms[*i] > 0.0 && !at_end && !in_corner
    };
    (0..norms.len()).filter(is_told).collect()
}

/// Covariance of the coordinates.
fn covariance(fitted: &Fitted, variance: f64, robust: bool) -> DMatrix<f64> {
    let count = fitted.free.len();
    let free = told(fitted);
    let mut all = DMatrix::zeros(count, count);
    let slopes = fitted.slopes.select_columns(&free);
    // Columns of unit length, so that the inverse does not depend on units.
    let scale = DVector::from_iterator(free.len(), slopes.column_iter().map(|c| c.norm()));
    let mut unit = slopes;
    unit.column_iter_mut().zip(scale.iter()).for_each(|(mut column, s)| column /= *s);
    let Ok(inverse) = unit.tr_mul(&unit).pseudo_inverse(1e-13) else { return all };
    let inner = if robust { &inverse * meat(&unit, &fitted.white_mm, 0) * &inverse } else { inverse * variance };
    for (a, i) in free.iter().enumerate() {
        for (b, j) in free.iter().enumerate() {
            all[(*i, *j)] = inner[(a, b)] / (scale[a] * scale[b]);
        }
    }
    all
}

/// Sum of the products of scores at all distances up to the root of their number, at least `least`, weighted by Bartlett's triangle.
pub(super) fn meat(slopes: &DMatrix<f64>, residual: &DVector<f64>, least: usize) -> DMatrix<f64> {
    let n = residual.len();
    let mut scores = slopes.clone();
    scores.row_iter_mut().zip(residual.iter()).for_each(|(mut row, r)| row *= *r);
    let bandwidth = ((n as f64).sqrt().ceil() as usize).max(least).min(n / 4);
    let mut sum = scores.tr_mul(&scores);
    for lag in 1..=bandwidth {
        let weight = 1.0 - lag as f64 / (bandwidth + 1) as f64;
        let product = scores.rows(lag, n - lag).tr_mul(&scores.rows(0, n - lag));
        sum += (&product + product.transpose()) * weight;
    }
    sum
}

/// How much wider the robust variance of a coordinate is than that of white noise.
fn inflation(fitted: &Fitted, variance: f64, robust: &DMatrix<f64>, i: usize) -> f64 {
    let plain = covariance(fitted, variance, false)[(i, i)];
    if plain > 0.0 { (robust[(i, i)] / plain).max(1.0) } else { 1.0 }
}

/// Misfit with a parameter held at a value, from a law near it; and the law.
fn held(record: &Record, fitted: &Fitted, near: &Law, parameter: Parameter, at: f64) -> (f64, Law) {
    let mut base = *near;
    parameter.set(&mut base, at);
    let problem = Problem { record, base, free: fitted.free.clone(), noise: fitted.noise.clone() };
    let end = problem.search(STEPS, Some(parameter));
    (end.misfit(), end.law)
}

/// Ends at which the misfit has risen by the square of `allowed`, mm.
fn profile(record: &Record, fitted: &Fitted, parameter: Parameter, allowed: f64) -> (f64, f64) {
    let best = parameter.of(&fitted.law);
    let least = fitted.misfit();
    let rise = allowed * allowed;
    let over = |at: f64, near: &Law| {
        let (misfit, law) = held(record, fitted, near, parameter, at);
        (misfit - least > rise, law)
    };
    let bisected = |mut inside: f64, mut outside: f64, mut near: Law| {
        for _ in 0..HALVINGS {
            let middle = 0.5 * (inside + outside);
            let (is_over, law) = over(middle, &near);
            if is_over {
                outside = middle;
            } else {
                (inside, near) = (middle, law);
            }
        }
        0.5 * (inside + outside)
    };
    let low = if best <= 0.0 || !over(0.0, &fitted.law).0 { 0.0 } else { bisected(best, 0.0, fitted.law) };
    let mut step = scale(record, parameter).max(0.3 * best);
    let (mut inside, mut near) = (best, fitted.law);
    for _ in 0..12 {
        let (is_over, law) = over(inside + step, &near);
        if is_over {
            return (low, bisected(inside, inside + step, near));
        }
        inside += step;
        near = law;
        step *= 2.0;
    }
    (low, f64::INFINITY)
}

/// A first step away from a best value of 0.
fn scale(record: &Record, parameter: Parameter) -> f64 {
    let travel = record.travel_mm();
    match parameter {
        Parameter::Delay => 0.1 * record.step_s(),
        Parameter::Friction => {
            let (low, high) = super::fit::ends(&record.command_v);
            3e-4 * (high - low)
        }
        _ => 3e-4 * travel,
    }
}

/// Lower 95 % bound of a rate limit that the recording does not reach: the largest limit at which the misfit rises by what a one-sided
/// quantile allows, mm/s.
#[must_use]
pub fn least_rate(record: &Record, fitted: &Fitted, sd_mm: f64) -> f64 {
    let allowed = 1.644_853_626_951_472_7_f64.powi(2) * sd_mm * sd_mm;
    let predicted = super::motion::follow(&fitted.law, &record.time_s, &record.command_v);
    let moved = Record { position_mm: predicted, ..record.clone() };
    let (mut high, mut low) = (2.0 * moved.speed_mm_s(), 0.2 * moved.speed_mm_s());
    let mut free = fitted.free.clone();
    free.push(Parameter::Rate);
    let fitted = Fitted { free, ..fitted.clone() };
    for _ in 0..16 {
        let middle = (low * high).sqrt();
        let (misfit, _) = held(record, &fitted, &fitted.law, Parameter::Rate, middle);
        if misfit - fitted.misfit() > allowed { low = middle } else { high = middle }
    }
    high
}
