//! Slow ripples: a wave of a few periods in a branch, which a spectrum cannot tell from a trend.
//!
//! What repeats of a condition differ by is noise as the diagnosis assumes it, or that noise and a wave of one frequency whose phase is another
//! in every run; so is what they share beyond a model that leaves no more than noise. Both likelihoods are exact: shifts of the contact, gain and zero are free, and the wave is a covariance of rank two, with
//! harmonics two for each.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::super::design::{Branch, Design, Node, Series};
use super::super::noise::{Contrast, Curve, SensorNoise, contrasts, means};
use super::{Over, Ripple};
use crate::infer::lowrank::Directions;

/// Contrasts that are looked at, at most.
const CONTRASTS: usize = 64;
/// Correlation times (s) and white shares of the noise that are tried, with a wave and without.
const TIMES_S: [f64; 7] = [0.01, 0.04, 0.1, 0.2, 0.4, 1.0, 2.5];
const WHITE: [f64; 3] = [0.0, 0.3, 0.8];
/// Amplitudes in units of the noise of a sample: the first and how many, each [`LOUDER`] times the one before.
const AMPLITUDES: (f64, usize) = (0.1, 13);
const LOUDER: f64 = 1.6;
/// Periods in the longest run, or in the largest depth, of the slowest wave; and in the longest way down, or in the largest depth, of the fastest:
/// from there on there are spectra.
const SLOWEST: (f64, f64) = (0.5, 1.5);
const FASTEST: (f64, f64) = (14.0, 21.0);
/// Periods between two frequencies that are tried.
const BETWEEN: f64 = 0.35;
/// Twice the logarithm of the likelihood ratio from which on there is a wave. About a hundred and fifty waves, half of a chi-square of one degree of
/// freedom each: one clean experiment in a thousand exceeds 19. Of 400 clean ones, half of them with other noise than is assumed (heavy tails, in
/// proportion to the force, quantised, a wandering zero), the largest were 17.0, 16.7 and 15.8.
const CLEARLY: f64 = 20.0;

/// Fewest periods in the largest depth of a wave with harmonics: fewer follow what repeats differ by where the contact shifts far.
const SLIPS: f64 = 4.0;
/// Harmonics of a wave that builds up and falls at once, as what sticks and slips does: each is as large as its number says, of a phase of its own.
const HARMONICS: usize = 3;

/// One frequency.
#[derive(Debug, Clone, Copy)]
struct Wave {
    over: Over,
    /// Hz or periods a millimetre.
    frequency: f64,
    /// 1 for a sine.
    harmonics: usize,
}

impl Wave {
    /// Factors on its frequency, and on the amplitude.
    fn parts(self) -> impl Iterator<Item = (f64, f64)> {
        (1..=self.harmonics).map(|n| (n as f64, 1.0 / n as f64))
    }
}

/// What a contrast says of every wave under one noise of unit level.
struct Sums {
    /// Square of what is whitened.
    square: f64,
    /// Logarithms of the determinants of the covariance and of the free shapes' information.
    log: f64,
    /// What the data say of every wave of unit amplitude.
    waves: Vec<Directions>,
}

/// The likeliest wave, if noise alone is not as likely.
pub(super) fn of(design: &Design, curves: &[Curve], sensor: &SensorNoise, adequate: bool) -> Option<Ripple> {
    let mut all = contrasts(design, curves);
    if adequate {
        all.extend(means(design, curves));
    }
    // as many windows as shapes say nothing
    all.retain(|c| c.values.len() > c.shapes.ncols());
    let few: Vec<&Contrast<'_>> = all.iter().step_by(all.len().div_ceil(CONTRASTS).max(1)).collect();
    let waves = waves(design);
    if few.is_empty() || waves.is_empty() {
        return None;
    }
    let columns: Vec<DMatrix<f64>> = few.iter().map(|c| shapes(c.nodes, &waves)).collect();
    let count: f64 = few.iter().map(|c| (c.values.len() - c.shapes.ncols()) as f64).sum();
    let relative = if sensor.sigma_n > 0.0 { sensor.relative / sensor.sigma_n } else { 0.0 };
    // the likeliest noise without a wave lies between those of the grid: a wave must not stand for the difference
    let noises: Vec<SensorNoise> = TIMES_S
        .iter()
        .flat_map(|correlation_s| WHITE.map(|white| (*correlation_s, white)))
        .chain([(sensor.correlation_s, sensor.white)])
        .map(|(correlation_s, white)| SensorNoise { sigma_n: 1.0, white, correlation_s, relative })
        .collect();
    // deviance without a wave, and the least with one: deviance, which wave, amplitude, level of the noise
    type Best = (f64, (f64, usize, f64, f64));
    let each: Vec<Best> = noises
        .par_iter()
        .filter_map(|unit| {
            let sums: Option<Vec<Sums>> = few
                .iter()
                .zip(&columns)
                .map(|(contrast, columns)| Sums::of(contrast, (&waves, columns), unit))
                .collect();
            let sums = sums?;
            let none = deviance(&sums, None, count).0;
            let mut best = (f64::INFINITY, 0, 0.0, 0.0);
            for wave in 0..waves.len() {
                for k in 0..AMPLITUDES.1 {
                    let amplitude = AMPLITUDES.0 * LOUDER.powi(k as i32);
                    let (there, level) = deviance(&sums, Some((wave, amplitude)), count);
                    if there < best.0 {
                        best = (there, wave, amplitude * level, level);
                    }
                }
            }
            Some((none, best))
        })
        .collect();
    let none = each.iter().map(|e| e.0).fold(f64::INFINITY, f64::min);
    let (with, wave, deviation_n, level_n) = each.iter().map(|e| e.1).min_by(|a, b| a.0.total_cmp(&b.0))?;
    let share = deviation_n.powi(2) / (deviation_n.powi(2) + level_n.powi(2));
    let Wave { over, frequency, .. } = waves[wave];
    let amplitude_n = std::f64::consts::SQRT_2 * deviation_n;
    (none - with > CLEARLY).then_some(Ripple { over, frequency, amplitude_n, share })
}

/// Twice the negative logarithm of the likelihood with a wave of an amplitude (in units of the noise's level), and the level that is likeliest.
fn deviance(sums: &[Sums], wave: Option<(usize, f64)>, count: f64) -> (f64, f64) {
    let (mut square, mut log) = (0.0, 0.0);
    for sum in sums {
        square += sum.square;
        log += sum.log;
        if let Some((wave, amplitude)) = wave {
            let (taken, price) = sum.waves[wave].at(amplitude);
            square -= taken;
            log += price;
        }
    }
    let variance = (square / count).max(f64::MIN_POSITIVE);
    (log + count * variance.ln(), variance.sqrt())
}

impl Sums {
    fn of(contrast: &Contrast<'_>, (waves, columns): (&[Wave], &DMatrix<f64>), unit: &SensorNoise) -> Option<Self> {
        let nodes = contrast.nodes;
        let factor = unit.factor(nodes, &contrast.force_n)?;
        let free = factor.whitened(contrast.shapes.clone()).qr();
        let q = free.q();
        let values = factor.whitened(contrast.values.clone());
        let values = &values - &q * q.tr_mul(&values);
        let columns = factor.whitened(columns.clone());
        let columns = &columns - &q * q.tr_mul(&columns);
        let logs = |diagonal: DVector<f64>| 2.0 * diagonal.iter().map(|d| d.abs().ln()).sum::<f64>();
        let log = factor.log_determinant() + logs(free.r().diagonal());
        let said = columns.tr_mul(&values);
        let mut first = 0;
        let each = waves.iter().map(|wave| {
            let (from, count) = (first, 2 * wave.harmonics);
            first += count;
            Directions::of(&columns.columns(from, count).into_owned(), &said.rows(from, count).into_owned())
        });
        Some(Self { square: values.norm_squared(), log, waves: each.collect() })
    }
}

/// Waves that are tried: over time, and over depth.
fn waves(design: &Design) -> Vec<Wave> {
    let length_s = |s: &Series| s.nodes.iter().map(|n| n.time_s + 0.5 * n.length_s).fold(0.0, f64::max);
    let loading_s = |s: &Series| {
        let own = s.nodes.iter().filter(|n| n.branch == Branch::Loading);
        own.map(|n| n.time_s + 0.5 * n.length_s).fold(0.0, f64::max)
    };
    let longest = |of: &dyn Fn(&Series) -> f64| design.series.iter().map(of).fold(0.0, f64::max);
    let (run_s, ramp_s) = (longest(&length_s), longest(&loading_s));
    let depth_mm = longest(&|s: &Series| s.nodes.iter().map(|n| n.depth_mm).fold(0.0, f64::max));
    let ladder = |over: Over, slowest: f64, fastest: f64, step: f64| {
        let count = if step > 0.0 { ((fastest - slowest) / step).max(0.0) as usize } else { 0 };
        (0..count).map(move |k| Wave { over, frequency: slowest + k as f64 * step, harmonics: 1 })
    };
    let depth: Vec<Wave> =
        ladder(Over::Depth, SLOWEST.1 / depth_mm, FASTEST.1 / depth_mm, BETWEEN / depth_mm).collect();
    let often = depth.iter().filter(|wave| wave.frequency * depth_mm > SLIPS);
    let slips: Vec<Wave> = often.map(|wave| Wave { harmonics: HARMONICS, ..*wave }).collect();
    ladder(Over::Time, SLOWEST.0 / run_s, FASTEST.0 / ramp_s, BETWEEN / run_s).chain(depth).chain(slips).collect()
}

/// Cosine and sine of every wave and its harmonics as means over a run's windows. In a hold nothing slips.
fn shapes(nodes: &[Node], waves: &[Wave]) -> DMatrix<f64> {
    let parts: Vec<(Over, f64, f64)> =
        waves.iter().flat_map(|w| w.parts().map(|(times, size)| (w.over, times * w.frequency, size))).collect();
    let mut columns = DMatrix::zeros(nodes.len(), 2 * parts.len());
    for (k, node) in nodes.iter().enumerate() {
        let rate = rate(nodes, k);
        for (j, (over, frequency, size)) in parts.iter().enumerate() {
            let (phase, length) = match over {
                Over::Time => (frequency * node.time_s, frequency * node.length_s),
                Over::Depth if node.branch == Branch::Hold => continue,
                Over::Depth => (frequency * node.depth_mm, frequency * rate * node.length_s),
            };
            // mean of a wave over equal steps
            let half = std::f64::consts::PI * length / node.samples as f64;
            let mean = if half.sin().abs() < 1e-9 {
                1.0
            } else {
                (node.samples as f64 * half).sin() / (node.samples as f64 * half.sin())
            };
            let (sin, cos) = (std::f64::consts::TAU * phase).sin_cos();
            columns[(k, 2 * j)] = size * mean * cos;
            columns[(k, 2 * j + 1)] = size * mean * sin;
        }
    }
    columns
}

/// Rate at a node, mm/s.
fn rate(nodes: &[Node], k: usize) -> f64 {
    let same = |i: usize| nodes.get(i).filter(|n| n.branch == nodes[k].branch);
    let two = same(k + 1).map(|n| (n, &nodes[k])).or(k.checked_sub(1).and_then(same).map(|n| (&nodes[k], n)));
    two.map_or(0.0, |(a, b)| (a.depth_mm - b.depth_mm) / (a.time_s - b.time_s).max(1e-9))
}
