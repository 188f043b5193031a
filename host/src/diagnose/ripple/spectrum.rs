//! Fast ripples: a line in the spectrum of what two repeats of a condition differ by.
//!
//! Every branch of such a difference is freed of a polynomial and tapered; its power over that of its neighbours in frequency, averaged over
//! all branches, is about the same everywhere unless there is a line.

use std::ops::Range;

use rustfft::FftPlannerScalar;
use rustfft::num_complex::Complex;

use crate::experiment::motion;
use crate::experiment::{Experiment, Recording};

use super::super::design::{Branch as Way, Design, Series};
use super::super::noise::Curve;
use super::{Over, Ripple};

/// Terms of the polynomial that a branch is freed of, and the least periods of a ripple in a branch: a polynomial of 8 terms follows 3, and where a contact begins
/// or ends a little late there is a kink.
const TERMS: usize = 8;
const PERIODS: f64 = 8.0;
/// Fewest samples of a branch that is looked at.
const SAMPLES: usize = 40;
/// Neighbours in frequency (in units of one over the length) that are taken for the background, on both sides.
const NEIGHBOURS: [f64; 8] = [-6.0, -5.0, -4.0, -3.0, 3.0, 4.0, 5.0, 6.0];
/// Fewest frequencies among which one can stand out.
const FREQUENCIES: usize = 30;
/// Standard deviations of the logarithm by which a line stands out of all other frequencies. The averages' logarithms have lighter tails above than
/// a normal distribution, but the most of five hundred frequencies is looked at: of a few hundred clean experiments one had a line of 5.5.
const STANDS_OUT: f64 = 7.0;
/// Least power over what is usual: with hundreds of branches the logarithms scatter so little that a bend of the spectrum would stand out.
const LEAST: f64 = 2.0;
/// Least part of the scatter: near half the sampling rate, where a correlated noise has next to no power, next to nothing stands out.
const LEAST_SHARE: f64 = 0.03;
/// Most frequencies that are looked at; more than a record of half an hour with 50 samples a second has.
const MOST: usize = 100_000;
/// Points of a spectrum for every step of one over the length, at least: between them it is straight within a percent.
const POINTS: usize = 8;
/// Samples that lie within this part of a step of where they would evenly lie are even.
const EVEN: f64 = 0.05;

/// One branch, freed of its polynomial and tapered.
struct Branch {
    spectrum: Spectrum,
    length_s: f64,
    /// Highest frequency that can be told from lower ones, Hz.
    nyquist_hz: f64,
    /// mm/s; 0 in a hold.
    rate_mm_per_s: f64,
    variance: f64,
}

/// The line that stands out most, if any does. `curves` is what a model predicts: repeats differ by a gain and by a shift, whose kinks are no
/// ripple.
pub(super) fn of(experiment: &Experiment, design: &Design, curves: &[Curve]) -> Option<Ripple> {
    let branches = branches(experiment, design, curves);
    let time = line(&branches, Over::Time);
    let depth = line(&branches, Over::Depth);
    let best = time.into_iter().chain(depth).max_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(best.1)
}

/// Differences between each run and the next one of its condition, branch by branch.
fn branches(experiment: &Experiment, design: &Design, curves: &[Curve]) -> Vec<Branch> {
    let mut list = Vec::new();
    let mut planner = FftPlannerScalar::new();
    for (at, series) in design.series.iter().enumerate() {
        let repeats = |other: &&Series| other.condition == series.condition && other.spot != series.spot;
        let Some(next) = design.series[at + 1..].iter().find(repeats) else { continue };
        let (one, two) = (&experiment.runs[series.run].recording, &experiment.runs[next.run].recording);
        let (Some(own), Some(other)) = (motion::of(one), motion::of(two)) else { continue };
        let parts = [
            (Some(own.loading), Some(other.loading), own.rate_mm_per_s, Way::Loading),
            (own.hold, other.hold, 0.0, Way::Hold),
            (own.unloading, other.unloading, own.rate_mm_per_s, Way::Unloading),
        ];
        for (own, other, rate, way) in parts {
            if let (Some(own), Some(other)) = (own, other) {
                let (time, difference) = difference((one, own.clone()), (two, other));
                let depth = one.depth_mm[own].iter().take(time.len()).map(|d| d - design.zero_mm);
                let shapes = shapes(series, &curves[at], way, &depth.collect::<Vec<_>>());
                list.extend(Branch::of(&mut planner, &time, &difference, &shapes, rate));
            }
        }
    }
    list
}

/// Force and slope of a curve over the depths of a branch's samples; none in a hold.
fn shapes(series: &Series, curve: &Curve, way: Way, depth_mm: &[f64]) -> Vec<Vec<f64>> {
    if way == Way::Hold {
        return Vec::new();
    }
    let mut nodes: Vec<(f64, f64, f64)> = (0..series.nodes.len())
        .filter(|k| series.nodes[*k].branch == way)
        .map(|k| (series.nodes[k].depth_mm, curve.force_n[k], curve.slope_n_per_mm[k]))
        .collect();
    nodes.sort_by(|a, b| a.0.total_cmp(&b.0));
    let at = |depth: f64, of: fn(&(f64, f64, f64)) -> f64| {
        let next = nodes.partition_point(|n| n.0 < depth);
        match (next.checked_sub(1).and_then(|i| nodes.get(i)), nodes.get(next)) {
            (Some(a), Some(b)) => of(a) + (of(b) - of(a)) * (depth - a.0) / (b.0 - a.0),
            (Some(end), None) | (None, Some(end)) => of(end),
            (None, None) => 0.0,
        }
    };
    let each = |of: fn(&(f64, f64, f64)) -> f64| depth_mm.iter().map(|d| at(*d, of)).collect();
    vec![each(|n| n.1), each(|n| n.2)]
}

/// Force of one branch less that of another at the same time since its beginning: times (s) and values (N).
fn difference(
    (one, own): (&Recording, Range<usize>),
    (two, other): (&Recording, Range<usize>),
) -> (Vec<f64>, Vec<f64>) {
    let clock = |r: &Recording, range: &Range<usize>, i: usize| r.time_s[i] - r.time_s[range.start];
    let mut next = other.start;
    let mut list: Vec<(f64, f64)> = Vec::new();
    for i in own.clone() {
        let time_s = clock(one, &own, i);
        while next + 1 < other.end && clock(two, &other, next + 1) <= time_s + 1e-9 {
            next += 1;
        }
        if next + 1 >= other.end {
            break;
        }
        let (from, to) = (clock(two, &other, next), clock(two, &other, next + 1));
        let share = if to > from { ((time_s - from) / (to - from)).clamp(0.0, 1.0) } else { 0.0 };
        let there = two.force_n[next] + share * (two.force_n[next + 1] - two.force_n[next]);
        list.push((time_s, one.force_n[i] - there));
    }
    list.into_iter().unzip()
}

impl Branch {
    fn of(
        planner: &mut FftPlannerScalar<f64>,
        time_s: &[f64],
        force_n: &[f64],
        shapes: &[Vec<f64>],
        rate_mm_per_s: f64,
    ) -> Option<Self> {
        if time_s.len() < SAMPLES {
            return None;
        }
        let length_s = time_s[time_s.len() - 1] - time_s[0];
        if length_s <= 0.0 {
            return None;
        }
        let mut values = force_n.to_vec();
        // Legendre-like columns, made orthogonal one after the other
        let mut columns: Vec<Vec<f64>> = Vec::new();
        let power = |power: usize| -> Vec<f64> {
            time_s.iter().map(|t| (2.0 * (t - time_s[0]) / length_s - 1.0).powi(power as i32)).collect()
        };
        for mut column in (0..TERMS).map(power).chain(shapes.iter().cloned()) {
            let whole = dot(&column, &column).sqrt();
            for q in &columns {
                let share = dot(q, &column);
                column.iter_mut().zip(q).for_each(|(c, q)| *c -= share * q);
            }
            let norm = dot(&column, &column).sqrt();
            if norm <= 1e-6 * whole {
                continue;
            }
            column.iter_mut().for_each(|c| *c /= norm);
            let share = dot(&column, &values);
            values.iter_mut().zip(&column).for_each(|(v, c)| *v -= share * c);
            columns.push(column);
        }
        let variance = dot(&values, &values) / (values.len() - TERMS) as f64;
        let taper = |t: f64| 0.5 - 0.5 * (std::f64::consts::TAU * (t - time_s[0]) / length_s).cos();
        values.iter_mut().zip(time_s).for_each(|(v, t)| *v *= taper(*t));
        let nyquist_hz = 0.5 * (time_s.len() - 1) as f64 / length_s;
        Some(Self { spectrum: Spectrum::of(planner, time_s, values), length_s, nyquist_hz, rate_mm_per_s, variance })
    }

    /// Power over the geometric mean of the backgrounds on both sides, and the power itself; none where there is no room for them.
    fn excess(&self, hz: f64) -> Option<(f64, f64)> {
        let step = 1.0 / self.length_s;
        if hz < PERIODS * step || hz > self.nyquist_hz - step {
            return None;
        }
        let side = |sign: f64| {
            let own = NEIGHBOURS.iter().filter(|k| **k * sign > 0.0).map(|k| hz + k * step);
            let inside: Vec<f64> =
                own.filter(|f| *f > 2.0 * step && *f < self.nyquist_hz).map(|f| self.spectrum.power(f)).collect();
            (inside.len() >= 2).then(|| inside.iter().sum::<f64>() / inside.len() as f64)
        };
        let background = match (side(-1.0), side(1.0)) {
            (Some(a), Some(b)) => (a * b).sqrt(),
            (Some(one), None) | (None, Some(one)) => one,
            (None, None) => return None,
        };
        let power = self.spectrum.power(hz);
        (background > 0.0).then(|| (power / background, power))
    }
}

/// Squared amplitudes of the waves in a tapered signal, evenly over the frequency.
struct Spectrum {
    step_hz: f64,
    power: Vec<f64>,
}

impl Spectrum {
    /// Of samples at times (s), of which there are two at least.
    fn of(planner: &mut FftPlannerScalar<f64>, time_s: &[f64], values: Vec<f64>) -> Self {
        let count = values.len();
        let step_s = (time_s[count - 1] - time_s[0]) / (count - 1) as f64;
        let values = evenly(time_s, step_s, values);
        let size = (POINTS * count).next_power_of_two();
        let mut waves: Vec<Complex<f64>> = values.into_iter().map(Complex::from).collect();
        waves.resize(size, Complex::default());
        planner.plan_fft_forward(size).process(&mut waves);
        // the taper has mean 1/2, a wave's square mean 1/2
        let scale = 4.0 / count as f64;
        let power = waves[..=size / 2].iter().map(|wave| scale * scale * wave.norm_sqr()).collect();
        Self { step_hz: 1.0 / (size as f64 * step_s), power }
    }

    /// Squared amplitude of the wave of a frequency below half the sampling rate.
    fn power(&self, hz: f64) -> f64 {
        let place = (hz / self.step_hz).clamp(0.0, (self.power.len() - 2) as f64);
        let (at, share) = (place as usize, place.fract());
        self.power[at] + share * (self.power[at + 1] - self.power[at])
    }
}

/// A signal at even steps, straight between its samples where these are uneven.
fn evenly(time_s: &[f64], step_s: f64, values: Vec<f64>) -> Vec<f64> {
    let due = |k: usize| time_s[0] + k as f64 * step_s;
    if (0..values.len()).all(|k| (time_s[k] - due(k)).abs() < EVEN * step_s) {
        return values;
    }
    let at = |k: usize| {
        let next = time_s.partition_point(|t| *t < due(k)).clamp(1, values.len() - 1);
        let (from, to) = (time_s[next - 1], time_s[next]);
        let share = if to > from { ((due(k) - from) / (to - from)).clamp(0.0, 1.0) } else { 1.0 };
        values[next - 1] + share * (values[next] - values[next - 1])
    };
    (0..values.len()).map(at).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The frequency that stands out most of all others, by how much, if by enough.
fn line(branches: &[Branch], over: Over) -> Option<(f64, Ripple)> {
    let scale = |b: &Branch| if over == Over::Time { 1.0 } else { b.rate_mm_per_s };
    let used: Vec<&Branch> = branches.iter().filter(|b| scale(b) > 0.0).collect();
    let lowest = used.iter().map(|b| PERIODS / b.length_s / scale(b)).fold(f64::INFINITY, f64::min);
    let highest = used.iter().map(|b| b.nyquist_hz / scale(b)).fold(0.0, f64::max);
    let step = used.iter().map(|b| 1.0 / b.length_s / scale(b)).fold(f64::INFINITY, f64::min);
    let count = ((highest - lowest) / step).floor();
    if !count.is_finite() || count < FREQUENCIES as f64 {
        return None;
    }
    // a frequency is looked at where at least half of the branches that any frequency has can tell of it
    let mut seen: Vec<(f64, usize, f64, f64)> = Vec::new();
    for k in 0..(count as usize).min(MOST) {
        let frequency = lowest + k as f64 * step;
        let each: Vec<(f64, f64)> = used.iter().filter_map(|b| b.excess(frequency * scale(b))).collect();
        let mean = |of: fn(&(f64, f64)) -> f64| each.iter().map(of).sum::<f64>() / each.len() as f64;
        if !each.is_empty() {
            seen.push((frequency, each.len(), mean(|e| e.0), mean(|e| e.1)));
        }
    }
    let most = seen.iter().map(|s| s.1).max()?;
    seen.retain(|s| 2 * s.1 >= most);
    if seen.len() < FREQUENCIES {
        return None;
    }
    // the mean over n branches scatters by 1 / sqrt n
    let mut middles: Vec<f64> = seen.iter().map(|s| s.2.ln()).collect();
    middles.sort_by(f64::total_cmp);
    let middle = middles[middles.len() / 2];
    let standard = |s: &(f64, usize, f64, f64)| (s.2.ln() - middle) * (s.1 as f64).sqrt();
    let mut above: Vec<f64> = seen.iter().map(standard).collect();
    above.sort_by(f64::total_cmp);
    let deviation = above[((above.len() - 1) as f64 * 0.84) as usize].max(0.5);
    let best = seen.iter().max_by(|a, b| standard(a).total_cmp(&standard(b)))?;
    let by = standard(best) / deviation;
    let variance = used.iter().map(|b| b.variance).sum::<f64>() / used.len() as f64;
    let ripple = Ripple {
        over,
        frequency: best.0,
        amplitude_n: (0.5 * best.3).sqrt(),
        share: (0.5 * best.3 / variance.max(f64::MIN_POSITIVE)).min(1.0),
    };
    (by > STANDS_OUT && best.2 > LEAST * middle.exp() && ripple.share > LEAST_SHARE).then_some((by, ripple))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use rand::{Rng, SeedableRng};
    use rand_distr::StandardNormal;
    use rand_pcg::Pcg64;

    use super::*;

    /// Ramps at three rates of a noise that is correlated over 0.1 s, with a wave of random phase in every run.
    fn ramps(seed: u64, wave: impl Fn(f64, f64) -> f64, amplitude: f64) -> Vec<Branch> {
        let mut chance = Pcg64::seed_from_u64(seed);
        let mut list = Vec::new();
        for rate in [0.5, 1.0, 2.0] {
            for _ in 0..6 {
                let count = (3.0 / rate * 50.0) as usize;
                let time: Vec<f64> = (0..count).map(|k| k as f64 * 0.02).collect();
                let keep = (-0.2_f64).exp();
                let mut state: f64 = chance.sample(StandardNormal);
                let phase: f64 = chance.random_range(0.0..std::f64::consts::TAU);
                let force: Vec<f64> = time
                    .iter()
                    .map(|t| {
                        state = keep * state + (1.0 - keep * keep).sqrt() * chance.sample::<f64, _>(StandardNormal);
                        (rate * t).powf(1.5)
                            + 0.01 * state
                            + amplitude * (std::f64::consts::TAU * wave(*t, rate) + phase).sin()
                    })
                    .collect();
                list.extend(Branch::of(&mut FftPlannerScalar::new(), &time, &force, &[], rate));
            }
        }
        list
    }

    /// The transform against sums of sines and cosines, evenly and unevenly sampled.
    #[test]
    fn a_spectrum_is_the_sum_over_its_samples() {
        for (uneven, within) in [(0.0, 0.01), (0.3, 0.05)] {
            let time: Vec<f64> = (0..600).map(|k| 0.02 * (f64::from(k) + uneven * f64::from(k % 3))).collect();
            let tapered = |t: &f64| (0.5 - 0.5 * (std::f64::consts::TAU * t / 12.0).cos()) * (2.0 + (19.0 * t).sin());
            let values: Vec<f64> = time.iter().map(tapered).collect();
            let spectrum = Spectrum::of(&mut FftPlannerScalar::new(), &time, values.clone());
            let largest = spectrum.power.iter().copied().fold(0.0, f64::max);
            for k in 1..200 {
                let turn = std::f64::consts::TAU * 0.03 * f64::from(k);
                let wave = |f: fn(f64) -> f64| time.iter().zip(&values).map(|(t, v)| v * f(turn * t)).sum::<f64>();
                let direct = (4.0 / 600.0_f64).powi(2) * (wave(f64::cos).powi(2) + wave(f64::sin).powi(2));
                let found = spectrum.power(0.03 * f64::from(k));
                assert!((found - direct).abs() < within * largest, "{uneven} {k}: {found} {direct}");
            }
        }
    }

    /// A hum of the mains in records of 200 samples a second for minutes, beyond the four thousandth frequency.
    #[test]
    fn a_line_is_found_in_long_records() {
        let mut chance = Pcg64::seed_from_u64(3);
        let mut hold = || {
            let time: Vec<f64> = (0..24_000).map(|k| 0.005 * f64::from(k)).collect();
            let phase: f64 = chance.random_range(0.0..std::f64::consts::TAU);
            let wave = |t: &f64| 0.004 * (std::f64::consts::TAU * 50.2 * t + phase).sin();
            let force: Vec<f64> =
                time.iter().map(|t| wave(t) + 0.01 * chance.sample::<f64, _>(StandardNormal)).collect();
            Branch::of(&mut FftPlannerScalar::new(), &time, &force, &[], 0.0).unwrap()
        };
        let holds = [hold(), hold(), hold()];
        let found = line(&holds, Over::Time).unwrap();
        assert!((found.1.frequency - 50.2).abs() < 0.01, "{found:?}");
    }

    /// The chance of one false line in 80 looks at a level of a few in ten thousand is below 5 %.
    #[test]
    fn noise_has_no_line() {
        for seed in 0..40 {
            for over in [Over::Time, Over::Depth] {
                assert!(line(&ramps(seed, |t, _| t, 0.0), over).is_none(), "{seed} {over:?}");
            }
        }
    }

    #[test]
    fn a_line_is_found_with_its_frequency_and_what_it_is_regular_over() {
        // two runs differ by a wave whose square is twice as large
        let hum = ramps(1, |t, _| 7.3 * t, 0.005 * 2.0_f64.sqrt());
        let found = line(&hum, Over::Time).unwrap();
        assert!(found.1.over == Over::Time && (found.1.frequency - 7.3).abs() < 0.2, "{found:?}");
        // the mean power holds the noise's own there
        assert!((found.1.amplitude_n / 0.005 - 1.0).abs() < 0.3, "{found:?}");
        assert!(line(&hum, Over::Depth).is_none_or(|other| other.0 < found.0));
        let slip = ramps(2, |t, rate| 4.0 * rate * t, 0.005);
        let found = line(&slip, Over::Depth).unwrap();
        assert!((found.1.frequency - 4.0).abs() < 0.2, "{found:?}");
        assert!(line(&slip, Over::Time).is_none_or(|other| other.0 < found.0));
    }
}
