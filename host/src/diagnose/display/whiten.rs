//! From differences in a channel's unit to numbers that are independent with unit variance when the law is right.

use nalgebra::{DMatrix, DVector};

use super::channel::{Channel, slope};
use super::design::{Design, Series};
use super::noise::{Noise, SensorNoise};
use crate::diagnose::whiten::kernel;

/// Innovations of one run's noise: a first-order process plus white noise (Kalman filter with known variances), sample by sample.
#[derive(Debug, Clone)]
pub struct Innovations {
    /// What the correlated part keeps since the sample before, its gain, and one over the deviation of the innovation.
    steps: Vec<(f64, f64, f64)>,
    /// Sum of the logarithms of the innovations' deviations.
    pub log_deviation: f64,
}

impl Innovations {
    /// Of a run with the level of its noise at every sample. Samples that are not compared give 0.
    #[must_use]
    pub fn new(series: &Series, level: &[f64], noise: &SensorNoise) -> Self {
        let (mut variance, mut before_s) = (1.0 - noise.white, f64::NAN);
        let mut log_deviation = 0.0;
        let mut steps = Vec::with_capacity(level.len());
        for (k, level) in level.iter().enumerate() {
            let now_s = series.time_s[k];
            let kept = if before_s.is_nan() { 0.0 } else { (-(now_s - before_s) / noise.correlation_s).exp() };
            variance = kept * kept * variance + (1.0 - kept * kept) * (1.0 - noise.white);
            before_s = now_s;
            if !series.compared[k] {
                steps.push((kept, 0.0, 0.0));
                continue;
            }
            // two samples of one stamp and no white noise would leave nothing: a millionth stays
            let whole = (variance + noise.white).max(1e-6);
            let gain = variance / whole;
            variance *= 1.0 - gain;
            let deviation = level * whole.sqrt();
            log_deviation += deviation.ln();
            // the state is kept in units of the level, which may change from sample to sample
            steps.push((kept, gain, 1.0 / deviation));
        }
        Self { steps, log_deviation }
    }

    /// Whitens values of this run in place. `level` is the noise level at every sample.
    pub fn apply(&self, values: &mut [f64], level: impl Fn(usize) -> f64) {
        let mut state = 0.0;
        for (k, (value, (kept, gain, scale))) in values.iter_mut().zip(&self.steps).enumerate() {
            state *= kept;
            if *scale == 0.0 {
                *value = 0.0;
                continue;
            }
            let unit = level(k);
            let innovation = *value / unit - state;
            state += gain * innovation;
            *value = innovation * unit * scale;
        }
    }
}

/// What a run may differ by from its repeats, whitened: gain, zero, and time where that matters.
#[derive(Debug, Clone)]
struct Jitter {
    first: usize,
    columns: DMatrix<f64>,
    kernel: DMatrix<f64>,
}

/// A linear map of all runs' residuals.
#[derive(Debug, Clone)]
pub struct Whitening {
    runs: Vec<(usize, Innovations, Vec<f64>)>,
    jitter: Vec<Jitter>,
    shared: (DMatrix<f64>, DMatrix<f64>),
    len: usize,
}

/// Standard deviation of the base law's own error, relative to the span, along each of three smooth shapes over the output: converters and
/// sensors are no straighter than a thousandth.
const LAW: f64 = 0.001;

/// What a recorded gap may be wrong by, mm: shims and calipers are no better.
const SHIM_MM: f64 = 0.02;

impl Whitening {
    /// For a noise, at what the base predicts.
    #[must_use]
    pub fn new(design: &Design, predicted: &[Vec<f64>], noise: &Noise) -> Self {
        let mut runs = Vec::new();
        let mut jitter = Vec::new();
        for (s, (series, output)) in design.series.iter().zip(predicted).enumerate() {
            let first = design.first(s);
            let level = levels(design.channel, series, output, &noise.sensor);
            let innovations = Innovations::new(series, &level, &noise.sensor);
            let mut columns = shapes(design.channel, series, output);
            for (j, scale) in [noise.jitter.gain, noise.jitter.zero, noise.jitter.slide].into_iter().enumerate() {
                let mut column: Vec<f64> = columns.column(j).iter().map(|x| x * scale).collect();
                innovations.apply(&mut column, |k| level[k]);
                columns.set_column(j, &DVector::from_vec(column));
            }
            jitter.push(Jitter { first, kernel: kernel(&columns), columns });
            runs.push((first, innovations, level));
        }
        let len = design.samples();
        let mut out = Self { runs, jitter, shared: (DMatrix::zeros(len, 0), DMatrix::zeros(0, 0)), len };
        let mut shared = errors(design, predicted);
        for j in 0..shared.ncols() {
            let mut whole = shared.column(j).into_owned();
            out.apply(&mut whole);
            shared.set_column(j, &whole);
        }
        out.shared = (shared.clone(), kernel(&shared));
        out
    }

    /// Number of residuals.
    #[must_use]
    pub fn residuals(&self) -> usize {
        self.len
    }

    /// Whitens residuals of all runs, one after the other, in place.
    pub fn apply(&self, values: &mut DVector<f64>) {
        let all = values.as_mut_slice();
        for (first, innovations, level) in &self.runs {
            innovations.apply(&mut all[*first..first + level.len()], |k| level[k]);
        }
        self.fold(values);
    }

    /// The symmetric part of the map: takes off what jitter and the law's own error may be.
    fn fold(&self, values: &mut DVector<f64>) {
        self.fold_jitter(values);
        self.fold_shared(values);
    }

    fn fold_jitter(&self, values: &mut DVector<f64>) {
        for one in &self.jitter {
            let own = values.rows(one.first, one.columns.nrows()).into_owned();
            let change = &one.columns * (&one.kernel * one.columns.tr_mul(&own));
            let mut rows = values.rows_mut(one.first, one.columns.nrows());
            rows -= change;
        }
    }

    fn fold_shared(&self, values: &mut DVector<f64>) {
        let (columns, kernel) = &self.shared;
        if columns.ncols() > 0 {
            *values -= columns * (kernel * columns.tr_mul(values));
        }
    }

    /// What clean data make of directions (one a column, whitened): the map of white noise, of each kind of jitter of every run, and of
    /// the law's own error, each of unit variance, to a value a direction.
    #[must_use]
    pub fn response(&self, directions: &DMatrix<f64>) -> Response {
        let mut folded = directions.clone();
        let mut law = DMatrix::zeros(directions.ncols(), self.shared.0.ncols());
        for j in 0..directions.ncols() {
            let mut column = directions.column(j).into_owned();
            self.fold_shared(&mut column);
            law.set_row(j, &self.shared.0.tr_mul(&column).transpose());
            self.fold_jitter(&mut column);
            folded.set_column(j, &column);
        }
        let kinds = 3 * self.jitter.len();
        let mut jitter = DMatrix::zeros(directions.ncols(), kinds);
        for (s, one) in self.jitter.iter().enumerate() {
            let own = folded.rows(one.first, one.columns.nrows());
            jitter.view_mut((0, 3 * s), (directions.ncols(), 3)).copy_from(&own.tr_mul(&one.columns));
        }
        Response { white: folded.tr_mul(&folded), jitter, law }
    }
}

/// How clean data move a set of directions.
#[derive(Debug, Clone)]
pub struct Response {
    /// Covariance that the sensor noise alone gives them.
    pub white: DMatrix<f64>,
    /// Columns: gain, zero and slide of every run by turns.
    pub jitter: DMatrix<f64>,
    /// Columns: shapes of the law's own error.
    pub law: DMatrix<f64>,
}

impl Response {
    /// Variance of every direction.
    #[must_use]
    pub fn variances(&self) -> Vec<f64> {
        let square = |m: &DMatrix<f64>, j: usize| m.row(j).norm_squared();
        (0..self.white.nrows()).map(|j| self.white[(j, j)] + square(&self.jitter, j) + square(&self.law, j)).collect()
    }
}

/// Level of the noise at every sample.
#[must_use]
pub fn levels(channel: Channel, series: &Series, output: &[f64], noise: &SensorNoise) -> Vec<f64> {
    (0..output.len()).map(|k| noise.level(channel.weight(series, output, k))).collect()
}

/// Output, 1, and what slides ([`Channel::slide`]): what the three kinds of jitter look like.
#[must_use]
pub fn shapes(channel: Channel, series: &Series, output: &[f64]) -> DMatrix<f64> {
    DMatrix::from_fn(output.len(), 3, |k, j| match j {
        0 => output[k],
        1 => 1.0,
        _ => channel.slide(series, output, k),
    })
}

/// What the base law may itself be wrong by: smooth over the output, along time, and between gaps.
fn errors(design: &Design, predicted: &[Vec<f64>]) -> DMatrix<f64> {
    let all = predicted.iter().flatten();
    let (low, high) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), y| (a.min(*y), b.max(*y)));
    let span = (high - low).max(1e-12);
    let timing_s = design.channel.timing_s();
    let mut columns = DMatrix::zeros(design.samples(), 5);
    for (s, (series, output)) in design.series.iter().zip(predicted).enumerate() {
        for (k, y) in output.iter().enumerate() {
            let (row, x) = (design.first(s) + k, 2.0 * (y - low) / span - 1.0);
            for (j, shape) in [1.0, 1.5 * x * x - 0.5, 2.5 * x.powi(3) - 1.5 * x].into_iter().enumerate() {
                columns[(row, j)] = LAW * span * shape;
            }
            columns[(row, 3)] = timing_s * slope(&series.time_s, output, k);
            if series.gap_mm > 0.0 {
                // what is common to all gaps is the line's slope
                columns[(row, 4)] = SHIM_MM * y * (series.gap_ratio - 1.0) / series.gap_mm;
            }
        }
    }
    columns
}
