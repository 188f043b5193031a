//! From differences in a channel's unit to numbers that are independent with unit variance when the law is right.

use crate::finger::round;
use nalgebra::{DMatrix, DVector};

use super::channel::{Channel, slope};
use super::design::{Design, Series};
use super::effect::fluid_response;
use super::law::{Law, RESPONSE_S, Setting};
use super::noise::{Noise, SensorNoise};
use super::sample::samples;
use crate::infer::lowrank::Fold;
use crate::infer::product::beside;

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
        let (mut variance, mut before_s) = (1.0 - noise.white, None);
        // of a steady clock one exponential, and one logarithm of many deviations
        let (mut span_s, mut decay) = (f64::INFINITY, 0.0);
        let (mut log_deviation, mut product) = (0.0, 1.0_f64);
        let mut steps = Vec::with_capacity(level.len());
        for (k, level) in level.iter().enumerate() {
            let now_s = series.time_s[k];
            let kept = before_s.map_or(0.0, |before_s: f64| {
                // a clock's differences are steady to its last digits
                if (now_s - before_s - span_s).abs() > 1e-12 {
                    span_s = now_s - before_s;
                    decay = (-span_s / noise.correlation_s).exp();
                }
                decay
            });
            variance = kept * kept * variance + (1.0 - kept * kept) * (1.0 - noise.white);
            before_s = Some(now_s);
            if !series.compared[k] {
                steps.push((kept, 0.0, 0.0));
                continue;
            }
            // two samples of one stamp and no white noise would leave nothing: a millionth stays
            let whole = (variance + noise.white).max(1e-6);
            let gain = variance / whole;
            variance *= 1.0 - gain;
            let deviation = level * whole.sqrt();
            product *= deviation;
            if !(1e-100..1e100).contains(&product) {
                log_deviation += product.ln();
                product = 1.0;
            }
            // the state is kept in units of the level, which may change from sample to sample
            steps.push((kept, gain, 1.0 / deviation));
        }
        Self { steps, log_deviation: log_deviation + product.ln() }
    }

    /// Whitens columns of values of this run in place.
    pub fn apply_to(&self, columns: &mut DMatrix<f64>, level: &[f64]) {
        for mut column in columns.column_iter_mut() {
            let mut own: Vec<f64> = column.iter().copied().collect();
            self.apply(&mut own, |k| level[k]);
            column.copy_from_slice(&own);
        }
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

/// What a run may differ by from its repeats, whitened: gain, zero, time where that matters, and what its input was read by.
#[derive(Debug, Clone)]
struct Jitter {
    first: usize,
    of: Fold,
    /// The same in the channel's unit, 0 where nothing is compared.
    plain: DMatrix<f64>,
    /// Expected sum of the squares of the sensor's noise.
    noise: f64,
}

/// A linear map of all runs' residuals.
#[derive(Debug, Clone)]
pub struct Whitening {
    runs: Vec<(usize, Innovations, Vec<f64>)>,
    jitter: Vec<Jitter>,
    /// What the base law may be wrong by in all runs, after the runs' own whitening.
    common: DMatrix<f64>,
    /// Runs that count.
    used: Vec<bool>,
    /// The same after the rest of the whitening.
    shared: Fold,
    len: usize,
}

/// Standard deviation of the base law's own error, relative to the span, along each of three smooth shapes over the output, and between its
/// two ways: converters and sensors are no straighter than a thousandth.
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
            let of_run = shapes(design.channel, series, output);
            let scales = [noise.jitter.gain, noise.jitter.zero, noise.jitter.slide].into_iter().enumerate();
            let of_run = scales.map(|(j, scale)| of_run.column(j) * scale);
            let of_input = of_input(design.channel, series, output);
            let mut columns = beside(output.len(), [&DMatrix::from_columns(&of_run.collect::<Vec<_>>()), &of_input]);
            let plain = columns.clone();
            let compared = level.iter().zip(&series.compared).filter(|(_, compared)| **compared);
            let noise = compared.map(|(level, _)| level * level).sum();
            innovations.apply_to(&mut columns, &level);
            jitter.push(Jitter { first, of: Fold::of(columns), plain, noise });
            runs.push((first, innovations, level));
        }
        let len = design.samples();
        let used = vec![true; runs.len()];
        let mut out = Self { runs, jitter, used, common: DMatrix::zeros(len, 0), shared: Fold::none(), len };
        let mut common = errors(design, predicted);
        for j in 0..common.ncols() {
            let mut whole = common.column(j).into_owned();
            out.innovate(&mut whole);
            common.set_column(j, &whole);
        }
        out.common = common;
        out.share();
        out
    }

    /// For readings that count alike.
    #[must_use]
    pub fn none(samples: usize) -> Self {
        Self {
            runs: Vec::new(),
            jitter: Vec::new(),
            used: Vec::new(),
            common: DMatrix::zeros(samples, 0),
            shared: Fold::none(),
            len: samples,
        }
    }

    /// The same where some runs count only: the others are removed, and nothing is known of the law's own error from them. Values of these must be 0.
    #[must_use]
    pub fn for_runs(&self, used: &[bool]) -> Self {
        let mut out = self.clone();
        out.used = used.to_vec();
        out.share();
        out
    }

    /// What the base law may be wrong by in runs that count, after the runs' own whitening.
    fn common(&self) -> DMatrix<f64> {
        let mut common = self.common.clone();
        for ((first, _, level), _) in self.runs.iter().zip(&self.used).filter(|(_, used)| !**used) {
            common.rows_mut(*first, level.len()).fill(0.0);
        }
        common
    }

    fn share(&mut self) {
        let mut shared = self.common();
        for j in 0..shared.ncols() {
            let mut whole = shared.column(j).into_owned();
            self.fold_jitter(&mut whole);
            shared.set_column(j, &whole);
        }
        self.shared = Fold::of(shared);
    }

    /// Number of residuals.
    #[must_use]
    pub fn residuals(&self) -> usize {
        self.len
    }

    /// Whitens residuals of all runs, one after the other, in place.
    pub fn apply(&self, values: &mut DVector<f64>) {
        self.innovate(values);
        self.fold_jitter(values);
        self.fold_shared(values);
    }

    /// What a run is expected to differ by from its repeats, in the channel's unit: columns of unit deviation of its gain,
    /// zero, time and input, and the sum of the squares of the sensor's noise.
    #[must_use]
    pub fn expected(&self, run: usize) -> (&DMatrix<f64>, f64) {
        (&self.jitter[run].plain, self.jitter[run].noise)
    }

    /// Residuals in the channel's unit without what gain, zero and time of every run, and the noise of its input, make of them.
    #[must_use]
    pub fn without_scatter(&self, plain: &DVector<f64>) -> DVector<f64> {
        let (mut told, mut out) = (plain.clone(), plain.clone());
        self.innovate(&mut told);
        for one in self.jitter.iter().filter(|one| !one.of.is_empty()) {
            let rows = one.plain.nrows();
            let amounts = one.of.amounts(&told.rows(one.first, rows).into_owned());
            let mut own = out.rows_mut(one.first, rows);
            own -= &one.plain * amounts;
        }
        out
    }

    fn innovate(&self, values: &mut DVector<f64>) {
        let all = values.as_mut_slice();
        for (first, innovations, level) in &self.runs {
            innovations.apply(&mut all[*first..first + level.len()], |k| level[k]);
        }
    }

    fn fold_jitter(&self, values: &mut DVector<f64>) {
        for one in &self.jitter {
            let mut rows = values.rows_mut(one.first, one.of.columns().nrows());
            let left = one.of.taken_off(&rows.clone_owned());
            rows.copy_from(&left);
        }
    }

    fn fold_shared(&self, values: &mut DVector<f64>) {
        *values = self.shared.taken_off(values);
    }
}

/// Level of the noise at every sample.
#[must_use]
pub fn levels(channel: Channel, series: &Series, output: &[f64], noise: &SensorNoise) -> Vec<f64> {
    (0..output.len()).map(|k| noise.level(channel.weight(series, output, k))).collect()
}

/// Output, 1, and what slides ([`Channel::slide`]): what the three kinds of jitter look like; 0 where nothing is compared.
#[must_use]
pub fn shapes(channel: Channel, series: &Series, output: &[f64]) -> DMatrix<f64> {
    DMatrix::from_fn(output.len(), 3, |k, j| match j {
        _ if !series.compared[k] => 0.0,
        0 => output[k],
        1 => 1.0,
        _ => channel.slide(series, output, k),
    })
}

/// What is left of the noise of an input's readings, as the output follows it: columns of unit deviation.
#[must_use]
pub fn of_input(channel: Channel, series: &Series, output: &[f64]) -> DMatrix<f64> {
    let follows = |of: usize, k: usize| match of {
        0 => channel.slide(series, output, k),
        _ => round::fluid_over_yield(series.input[k], series.yield_kpa[k]),
    };
    let mut columns: Vec<DVector<f64>> = Vec::new();
    for (of, left) in series.left.iter().enumerate().flat_map(|(of, all)| all.iter().map(move |left| (of, left))) {
        let mut column = DVector::zeros(output.len());
        let samples = left.first..left.first + left.errors.len();
        for (k, error) in samples.zip(&left.errors).filter(|(k, _)| series.compared[*k]) {
            column[k] = error * follows(of, k);
        }
        if column.amax() > 0.0 {
            columns.push(column);
        }
    }
    if columns.is_empty() { DMatrix::zeros(output.len(), 0) } else { DMatrix::from_columns(&columns) }
}

/// What the base law may itself be wrong by: smooth over the output, along time, between gaps, and between the way up
/// and the way down.
fn errors(design: &Design, predicted: &[Vec<f64>]) -> DMatrix<f64> {
    let all = predicted.iter().flatten();
    let (low, high) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), y| (a.min(*y), b.max(*y)));
    let span = (high - low).max(1e-12);
    let timing_s = design.channel.timing_s();
    let mut columns = DMatrix::zeros(design.samples(), 9);
    for (s, series) in design.series.iter().enumerate().filter(|_| design.channel == Channel::Fluid) {
        let late = late_by(series).into_iter().enumerate();
        late.for_each(|(k, change_n)| {
            columns[(design.first(s) + k, 7)] = change_n;
            columns[(design.first(s) + k, 8)] = round::fluid_open_n(series.input[k], series.yield_kpa[k]);
        });
    }
    let told = samples(design);
    for (s, (series, output)) in design.series.iter().zip(predicted).enumerate() {
        for (k, y) in output.iter().enumerate() {
            let (row, x) = (design.first(s) + k, 2.0 * (y - low) / span - 1.0);
            for (j, shape) in [1.0, 1.5 * x * x - 0.5, 2.5 * x.powi(3) - 1.5 * x].into_iter().enumerate() {
                columns[(row, j)] = LAW * span * shape;
            }
            let sample = &told[s][k];
            if sample.has_moved {
                let way = if sample.is_falling { 0.5 } else { -0.5 };
                columns[(row, 5)] = LAW * span * way;
                columns[(row, 6)] = LAW * span * way * sample.level;
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

/// What a fluid's response of some milliseconds, which no flux density tells, changes of its force.
fn late_by(series: &Series) -> Vec<f64> {
    let mut law = Law::nominal(Channel::Fluid);
    let at_once = law.predict(series);
    law.settings.push(Setting { effect: &fluid_response::EFFECT, values: vec![RESPONSE_S] });
    law.predict(series).into_iter().zip(at_once).map(|(late, at_once)| late - at_once).collect()
}
