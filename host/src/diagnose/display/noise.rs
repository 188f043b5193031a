//! What repeats of one command differ by: sensor noise with its correlation in time, and jitter of gain, zero and time from run to run.

use nalgebra::{DMatrix, DVector};

use super::channel::Channel;
use super::design::Design;
use super::whiten::{Innovations, levels, of_input, shapes};
use crate::infer::covariance::Factor;
use crate::infer::lowrank::Fold;

/// Noise of one sample: a part that is correlated in time and a white one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SensorNoise {
    /// Standard deviation at output 0, in the channel's unit.
    pub sigma: f64,
    /// Share of its variance that is white.
    pub white: f64,
    /// Correlation time of the rest, s.
    pub correlation_s: f64,
    /// Added in quadrature: this times the output, or times what [`Channel::weight`] says.
    pub relative: f64,
}

impl SensorNoise {
    /// Standard deviation at a weight.
    #[must_use]
    pub fn level(&self, output: f64) -> f64 {
        self.sigma.hypot(self.relative * output)
    }
}

/// Scatter from run to run, as standard deviations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jitter {
    /// Of the gain.
    pub gain: f64,
    /// Of the zero, in the channel's unit.
    pub zero: f64,
    /// Of what slides: time of the position (s), the current's reading for the flux (A), where a finger touches (mm).
    pub slide: f64,
}

/// Noise of a channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Of the sensor.
    pub sensor: SensorNoise,
    /// From run to run.
    pub jitter: Jitter,
    /// Degrees of freedom behind the jitter.
    pub freedom: f64,
    /// Degrees of freedom behind the sensor noise.
    pub sensor_freedom: f64,
}

/// Degrees of freedom that the expectation of the gain's scatter weighs.
const EXPECTED_FREEDOM: f64 = 1.0;
const TIMES_S: [f64; 7] = [0.01, 0.03, 0.08, 0.2, 0.5, 1.2, 3.0];
const WHITE: [f64; 4] = [0.02, 0.2, 0.5, 0.9];
/// Parts in proportion to the output, at the largest output over that at 0.
const RELATIVE: [f64; 4] = [0.0, 1.0, 4.0, 20.0];
/// Correlation times about the best of the grid.
const FINER: [f64; 5] = [0.7, 0.85, 1.0, 1.2, 1.45];
/// Runs that the shape of a noise is found from.
const ENOUGH: usize = 10;

/// How one run differs from the mean of its repeats.
struct Deviation {
    run: usize,
    values: Vec<f64>,
    shapes: DMatrix<f64>,
    /// What its input was read by: columns of unit deviation.
    of_input: DMatrix<f64>,
}

/// Finds the noise from repeats; `None` without any. `predicted` is a fit of the base: what it misses is common to the repeats.
#[must_use]
pub fn estimate(design: &Design, predicted: &[Vec<f64>]) -> Option<Noise> {
    let deviations = deviations(design, predicted);
    if deviations.is_empty() {
        return None;
    }
    let mut sensor = most_likely(design, predicted, &deviations, None)?;
    if deviations.iter().any(|one| one.of_input.ncols() > 0) {
        sensor = most_likely(design, predicted, &deviations, Some(&sensor))?;
    }
    let (jitter, freedom) = jitter(design, predicted, &deviations, &sensor);
    let samples: usize = deviations.iter().map(|d| design.series[d.run].count().saturating_sub(3)).sum();
    Some(Noise { sensor, jitter, freedom, sensor_freedom: 0.5 * samples as f64 })
}

fn deviations(design: &Design, predicted: &[Vec<f64>]) -> Vec<Deviation> {
    let mut list = Vec::new();
    for condition in 0..design.conditions.len() {
        let runs: Vec<usize> = (0..design.series.len()).filter(|s| design.series[*s].condition == condition).collect();
        if runs.len() < 2 {
            continue;
        }
        let least = runs.iter().map(|s| design.series[*s].time_s.len()).min().unwrap_or(0);
        let rest = |s: usize, k: usize| design.series[s].output[k] - predicted[s][k];
        let count = runs.len() as f64;
        let mean: Vec<f64> = (0..least).map(|k| runs.iter().map(|s| rest(*s, k)).sum::<f64>() / count).collect();
        // the mean takes one of n degrees of freedom
        let scale = (count / (count - 1.0)).sqrt();
        for &s in &runs {
            let values = (0..predicted[s].len()).map(|k| if k < least { scale * (rest(s, k) - mean[k]) } else { 0.0 });
            list.push(Deviation {
                run: s,
                values: values.collect(),
                shapes: shapes(design.channel, &design.series[s], &predicted[s]),
                of_input: of_input(design.channel, &design.series[s], &predicted[s]),
            });
        }
    }
    list
}

/// Deviation and shapes whitened, and the logarithm of the determinant of what whitens them. What is left of the input's
/// noise counts in a unit; none: it does not count.
fn whitened(
    design: &Design,
    predicted: &[Vec<f64>],
    one: &Deviation,
    noise: &SensorNoise,
    unit: Option<f64>,
) -> (DVector<f64>, DMatrix<f64>, f64) {
    let output = &predicted[one.run];
    let levels = levels(design.channel, &design.series[one.run], output, noise);
    let innovations = Innovations::new(&design.series[one.run], &levels, noise);
    let mut values = one.values.clone();
    innovations.apply(&mut values, |k| levels[k]);
    let mut shapes = one.shapes.clone();
    innovations.apply_to(&mut shapes, &levels);
    let fold = unit.map_or_else(Fold::none, |unit| {
        let mut of_input = &one.of_input / unit;
        innovations.apply_to(&mut of_input, &levels);
        Fold::of(of_input)
    });
    let values = fold.taken_off(&DVector::from_vec(values));
    (values, fold.all_taken_off(shapes), 2.0 * innovations.log_deviation + fold.price())
}

/// Sensor noise of the largest likelihood over a grid, its level in closed form, jitter removed as free parameters. `near` one
/// that was found without what is left of the input's noise, that counts in units of its level.
fn most_likely(
    design: &Design,
    predicted: &[Vec<f64>],
    deviations: &[Deviation],
    near: Option<&SensorNoise>,
) -> Option<SensorNoise> {
    let told: Vec<&Deviation> = deviations.iter().filter(|d| design.series[d.run].count() > 3).collect();
    let few: Vec<&Deviation> = told.iter().copied().step_by(told.len().div_ceil(ENOUGH).max(1)).collect();
    let weights =
        design.series.iter().zip(predicted).flat_map(|(series, output)| {
            (0..output.len()).map(move |k| design.channel.weight(series, output, k).abs())
        });
    let peak = weights.fold(0.0, f64::max);
    let mut best: Option<(f64, SensorNoise)> = None;
    let mut ask = |correlation_s: f64, white: f64, relative: f64| {
        let unit = SensorNoise { sigma: 1.0, white, correlation_s, relative };
        let Some((level, deviance)) = likelihood(design, predicted, &few, &unit, near.map(|near| near.sigma)) else {
            return best;
        };
        if best.is_none_or(|(least, _)| deviance < least) {
            best = Some((deviance, SensorNoise { sigma: level, relative: relative * level, ..unit }));
        }
        best
    };
    match near {
        Some(near) => {
            for part in RELATIVE {
                ask(near.correlation_s, near.white, part / peak.max(1e-12));
            }
        }
        None => {
            for correlation_s in TIMES_S {
                for white in WHITE {
                    for part in RELATIVE {
                        ask(correlation_s, white, part / peak.max(1e-12));
                    }
                }
            }
        }
    }
    // means over many samples scatter as the root of the correlation time: the grid alone would leave a quarter of error
    for _ in 0..2 {
        let (_, found) = ask(TIMES_S[0], WHITE[0], 0.0)?;
        let relative = found.relative / found.sigma;
        for time in FINER {
            for white in [0.4, 1.0, 1.8] {
                ask(found.correlation_s * time, (found.white * white).clamp(0.005, 0.97), relative);
            }
        }
    }
    // noise below a converter's rounding is not believed: a ten-thousandth of the span
    best.map(|(_, sensor)| SensorNoise { sigma: sensor.sigma.max(1e-4 * design.span), ..sensor })
}

/// Level of a noise of given shape, and twice its negative log-likelihood.
fn likelihood(
    design: &Design,
    predicted: &[Vec<f64>],
    runs: &[&Deviation],
    unit: &SensorNoise,
    of_input: Option<f64>,
) -> Option<(f64, f64)> {
    let (mut square, mut log, mut count) = (0.0, 0.0, 0.0);
    for run in runs {
        let (y, x, determinant) = whitened(design, predicted, run, unit, of_input);
        let (found, information) = amounts(&y, &x)?;
        square += (y - x * found).norm_squared();
        log += determinant + information.log_determinant();
        count += design.series[run.run].count() as f64 - 3.0;
    }
    let variance = square / count;
    (variance > 0.0).then(|| (variance.sqrt(), log + count * variance.ln()))
}

/// Least-squares amounts of the shapes that a run shows, with their information.
fn amounts(y: &DVector<f64>, x: &DMatrix<f64>) -> Option<(DVector<f64>, Factor)> {
    let mut normal = x.tr_mul(x);
    for j in 0..normal.nrows() {
        // a shape that a run does not have (no motion, no output) gets no amount
        normal[(j, j)] = normal[(j, j)] * (1.0 + 1e-6) + 1e-9;
    }
    let factor = Factor::of(&normal)?;
    Some((factor.solve(&x.tr_mul(y)), factor))
}

/// Jitter from the shapes that fit each run's deviation, less what sensor noise alone would make of them.
fn jitter(design: &Design, predicted: &[Vec<f64>], deviations: &[Deviation], sensor: &SensorNoise) -> (Jitter, f64) {
    let mut sums = [(0.0, 0.0); 3];
    for run in deviations {
        let (y, x, _) = whitened(design, predicted, run, sensor, Some(1.0));
        let Some((found, information)) = amounts(&y, &x) else { continue };
        let variance = information.inverse();
        for k in 0..3 {
            // what a run says hardly anything about weighs little
            let weight = 1.0 / variance[(k, k)].max(1e-300);
            sums[k].0 += weight * (found[k] * found[k] - variance[(k, k)]);
            sums[k].1 += weight;
        }
    }
    let mut repeated: Vec<usize> = deviations.iter().map(|d| design.series[d.run].condition).collect();
    repeated.sort_unstable();
    repeated.dedup();
    let freedom = (deviations.len() as f64 - repeated.len() as f64).max(1.0);
    let spread = |k: usize, expected: f64| {
        let (sum, weight): (f64, f64) = sums[k];
        let raw = if weight > 0.0 { (sum / weight).max(0.0) } else { 0.0 };
        ((raw * freedom + expected * expected * EXPECTED_FREEDOM) / (freedom + EXPECTED_FREEDOM)).sqrt()
    };
    let slides = !matches!(design.channel, Channel::Force | Channel::Current);
    let slide = if slides { spread(2, 0.0) } else { 0.0 };
    (
        Jitter { gain: spread(0, design.channel.expected_gain()), zero: spread(1, 0.0), slide },
        freedom + EXPECTED_FREEDOM,
    )
}
