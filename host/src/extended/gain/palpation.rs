//! A recorded run as a palpation, and what the board's own logic makes of it.

use firmware::contact::Sample;
use firmware::palpation::{Motion, Palpation, PalpationConfig};
use lut_gen::chain::Setting;
use protocol::lut::Table;
use protocol::message::Outcome;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

use crate::diagnose::design::{Design, Series};
use crate::experiment::{Experiment, motion};
use crate::extended::rig;

use super::GainError;
use super::table::Peaks;

/// Samples a second of a board.
const SAMPLES_HZ: f64 = 50.0;
/// Way of the approach before the recording, mm, and its fewest samples: the board needs a zero and a noise.
const APPROACH_MM: f64 = 3.0;
const APPROACH_SAMPLES: usize = 40;
/// Pieces of an analysis at most.
const PIECES: usize = 2000;

/// Samples of a palpation and its rate.
#[derive(Debug, Clone)]
pub(super) struct Press {
    samples: Vec<Sample>,
    rate_mm_s: f64,
}

/// What the board made of a palpation.
#[derive(Debug, Clone, PartialEq)]
pub struct Palpated {
    /// How it ended, in the firmware's word.
    pub outcome: String,
    /// Place of the named material in the library; none if nothing was near enough.
    pub named: Option<usize>,
    /// Modulus (MPa) and exponent, if they were given.
    pub found: Option<(f64, f64)>,
    /// Their relative errors, and that of the force at full depth that they stand for: modulus and exponent make up for each other, the
    /// force is what a palpation sees.
    pub error: Option<[f64; 3]>,
    /// Mean difference to the nearest material, N, and the most that is accepted.
    pub error_n: f64,
    /// See `error_n`.
    pub limit_n: f64,
}

impl Palpated {
    /// Fills in the errors relative to a modulus (MPa) and an exponent, in a table of these peaks.
    pub(super) fn refer(&mut self, (mu_mpa, alpha): (f64, f64), peaks: &Peaks) {
        let force = peaks.force_n(mu_mpa, alpha);
        self.error = self.found.map(|(m, a)| [m / mu_mpa - 1.0, a / alpha - 1.0, peaks.force_n(m, a) / force - 1.0]);
    }
}

/// A run as the board would have sampled it: the way down, behind an approach at the same rate without contact. What `freed` has of the rig is taken
/// off first. `height_mm` is what the board's transducer would read at the contact.
pub(super) fn press(
    experiment: &Experiment,
    design: &Design,
    series: &Series,
    freed: &[Setting],
    height_mm: f64,
    noise_n: f64,
) -> Press {
    let run = &experiment.runs[series.run];
    let recording = &run.recording;
    let recorded: Vec<f64> = recording.depth_mm.iter().map(|d| d - design.zero_mm).collect();
    let first_s = recording.time_s.first().copied().unwrap_or(0.0);
    let time: Vec<f64> = recording.time_s.iter().map(|t| t - first_s).collect();
    let start_s = series.start_s.unwrap_or(0.0);
    let (depth, force) = rig::freed(freed, &time, start_s, &recorded, &recording.force_n);
    let loading = motion::of(recording).map_or(0..time.len(), |m| m.loading);
    let rate_mm_s = design.rates_mm_per_s[series.rate];
    let (time, depth, force) = (&time[loading.clone()], &depth[loading.clone()], &force[loading]);
    let above: Vec<f64> = depth.iter().zip(force).filter(|(d, _)| **d <= 0.0).map(|(_, f)| *f).collect();
    let zero_n = if above.is_empty() { 0.0 } else { above.iter().sum::<f64>() / above.len() as f64 };
    let step_mm = rate_mm_s / SAMPLES_HZ;
    let approach = ((APPROACH_MM / step_mm).ceil() as usize).max(APPROACH_SAMPLES);
    let mut chance = Pcg64::seed_from_u64(series.run as u64);
    let mut noise = || -> f64 { StandardNormal.sample(&mut chance) };
    let sample =
        |depth_mm: f64, force_n: f64| Sample { probe_mm: (height_mm - depth_mm) as f32, force_n: force_n as f32 };
    let begin_mm = depth.first().copied().unwrap_or(0.0);
    let mut samples: Vec<Sample> =
        (1..=approach).rev().map(|k| sample(begin_mm - step_mm * k as f64, zero_n + noise_n * noise())).collect();
    let (from_s, to_s) = (time.first().copied().unwrap_or(0.0), time.last().copied().unwrap_or(0.0));
    let count = ((to_s - from_s) * SAMPLES_HZ + 1e-6) as usize;
    samples.extend((0..=count).map(|k| {
        let at_s = from_s + k as f64 / SAMPLES_HZ;
        sample(between(time, depth, at_s), between(time, force, at_s))
    }));
    Press { samples, rate_mm_s }
}

/// A value at a time, straight between samples.
fn between(time_s: &[f64], values: &[f64], at_s: f64) -> f64 {
    let next = time_s.partition_point(|t| *t < at_s).min(time_s.len().saturating_sub(1));
    let before = next.saturating_sub(1);
    let width = time_s[next] - time_s[before];
    let share = if width > 0.0 { ((at_s - time_s[before]) / width).clamp(0.0, 1.0) } else { 1.0 };
    values[before] + share * (values[next] - values[before])
}

/// Runs the board's palpation on the samples, one a tick, to their end, and its analysis.
pub(super) fn judge(bytes: &[u8], press: &Press) -> Result<Palpated, GainError> {
    let table = Table::parse(bytes).map_err(|cause| GainError::Unreadable(cause.to_string()))?;
    let config = PalpationConfig::default();
    let mut palpation = Palpation::new();
    palpation.start(press.rate_mm_s as f32);
    let mut ended = None;
    for sample in &press.samples {
        ended = palpation.step(&config, &table, *sample).refused();
        if ended.is_some() {
            break;
        }
    }
    let reached = if palpation.has_contact() { Outcome::Identified } else { Outcome::NoContact };
    for _ in 0..PIECES {
        if palpation.analyse(&config, &table) {
            break;
        }
    }
    let motion = Motion { number: 1, rate_mm_s: press.rate_mm_s as f32, tick_max_us: 0, tick_mean_us: 0.0 };
    let verdict = palpation.verdict(&config, Some(&table), ended.unwrap_or(reached), motion);
    let index = usize::from(verdict.material.index);
    let given = verdict.outcome == Outcome::Identified && verdict.mu_mpa > 0.0;
    Ok(Palpated {
        outcome: format!("{:?}", verdict.outcome),
        named: (index < table.material_count()).then_some(index),
        found: given.then_some((f64::from(verdict.mu_mpa), f64::from(verdict.alpha))),
        error: None,
        error_n: f64::from(verdict.material.error_n),
        limit_n: f64::from(verdict.material.limit_n),
    })
}
