//! The statistics on presses whose law, jitter and noise are known in closed form: no finite elements.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::path::PathBuf;

use nalgebra::{DMatrix, DVector};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

use super::design::{Branch, Design};
use super::evidence::{self, Gauge, Panel};
use super::jitter::Posterior;
use super::noise::{self, Curve, Jitter, Noise, SensorNoise, Source};
use super::whiten::Whitening;
use super::*;
use crate::experiment::{Base, BaseLaw, Indenter, Length, Recording, Run, Sensor, Specimen, Test};

const SIGMA_N: f64 = 0.01;
const TAU_S: f64 = 0.1;
const CONTACT_MM: f64 = 0.02;
const GAIN: f64 = 0.01;
const SAMPLE_S: f64 = 0.02;
const DEPTH_MM: f64 = 3.0;
const RATES: [f64; 2] = [0.5, 2.0];
const SPOTS: usize = 4;

fn hertz_n(depth_mm: f64) -> f64 {
    0.4 * depth_mm.max(0.0).powf(1.5)
}

fn normal(chance: &mut Pcg64) -> f64 {
    StandardNormal.sample(chance)
}

/// A ramp to a depth (mm) at a rate (mm/s) with AR(1) noise, a part of which may be in proportion to the force, its contact and gain off by jitter.
fn ramp(force_n: impl Fn(f64) -> f64, (to_mm, rate): (f64, f64), relative: f64, chance: &mut Pcg64) -> Recording {
    let contact = CONTACT_MM * normal(chance);
    let gain = 1.0 + GAIN * normal(chance);
    let kept = (-SAMPLE_S / TAU_S).exp();
    let mut late = normal(chance);
    let count = (to_mm / rate / SAMPLE_S) as usize;
    let time_s: Vec<f64> = (0..=count).map(|i| i as f64 * SAMPLE_S).collect();
    let depth_mm: Vec<f64> = time_s.iter().map(|t| rate * t).collect();
    let force_n = depth_mm
        .iter()
        .map(|d| {
            late = kept * late + (1.0 - kept * kept).sqrt() * normal(chance);
            let force_n = gain * force_n(d - contact);
            force_n + SIGMA_N.hypot(relative * force_n) * late
        })
        .collect();
    Recording::from_samples(time_s, depth_mm, force_n)
}

fn press(rate: f64, chance: &mut Pcg64) -> Recording {
    ramp(hertz_n, (DEPTH_MM, rate), 0.0, chance)
}

fn experiment(seed: u64) -> Experiment {
    let mut chance = Pcg64::seed_from_u64(seed);
    let mut runs = Vec::new();
    for rate in RATES {
        for spot in 0..SPOTS {
            runs.push(Run::indentation(format!("v{rate}-{spot}"), 0, 0, press(rate, &mut chance)));
        }
    }
    Experiment {
        name: "hertz".to_owned(),
        folder: PathBuf::new(),
        specimens: vec![Specimen {
            name: "foam".to_owned(),
            material: "foam".to_owned(),
            base_law: BaseLaw::Hyperfoam,
            terms: 1,
            height_mm: Length::Known(12.7),
            radius_mm: Length::Known(25.0),
            base: Base::Bonded,
        }],
        indenters: vec![Indenter { name: "r4".to_owned(), radius_mm: Length::Known(4.0) }],
        sensor: Sensor::default(),
        runs,
    }
}

fn curves(design: &Design) -> Vec<Curve> {
    let curve = |s: &design::Series| Curve {
        force_n: s.nodes.iter().map(|n| hertz_n(n.depth_mm)).collect(),
        slope_n_per_mm: s.nodes.iter().map(|n| 0.6 * n.depth_mm.max(0.0).sqrt()).collect(),
    };
    design.series.iter().map(curve).collect()
}

#[test]
fn a_design_is_read_from_the_data() {
    let design = Design::of(&experiment(1), "foam").unwrap();
    assert_eq!((design.series.len(), design.spots, design.conditions, design.groups), (8, 8, 2, 2));
    assert_eq!(design.rates_mm_per_s.len(), 2);
    assert!(design.zero_is_contact && design.geometries.len() == 1);
    assert!(design.series.iter().all(|s| s.nodes.len() == 36 && s.nodes.iter().all(|n| n.branch == Branch::Loading)));
}

/// A zero that drifts by a third of the largest force over the session moves no contact; a session of presses that were triggered by a force begins within the specimen.
#[test]
fn a_drifting_zero_is_no_late_contact() {
    const FAST: usize = 6;
    let largest_n =
        |all: &Experiment| all.runs.iter().flat_map(|r| r.recording.force_n.iter().copied()).fold(0.0, f64::max);
    let mut drifting = experiment(3);
    let (step_n, peak_n) = (largest_n(&drifting) / 24.0, largest_n(&drifting));
    for (at, run) in drifting.runs.iter_mut().enumerate() {
        run.recording.force_n.iter_mut().for_each(|f| *f -= step_n * at as f64);
    }
    assert!(Design::of(&drifting, "foam").unwrap().zero_is_contact);
    // of a fast run the second and third reading lie well within the specimen: no run begins at no force on average
    let mut fast = experiment(3);
    fast.runs.reverse();
    for (at, run) in fast.runs.iter_mut().enumerate() {
        let all = &run.recording;
        let each = |values: &[f64]| -> Vec<f64> { values.iter().step_by(FAST).copied().collect() };
        let force_n = each(&all.force_n).into_iter().map(|f| f + step_n * at as f64).collect();
        run.recording = Recording::from_samples(each(&all.time_s), each(&all.depth_mm), force_n);
    }
    let begins_n = fast.runs.iter().map(|run| run.recording.force_n[..3].iter().sum::<f64>() / 3.0);
    assert!(begins_n.fold(f64::INFINITY, f64::min) > 0.02 * largest_n(&fast));
    assert!(Design::of(&fast, "foam").unwrap().zero_is_contact);
    let mut triggered = experiment(3);
    for run in &mut triggered.runs {
        let first = run.recording.force_n.iter().position(|f| *f > 0.2 * peak_n).unwrap();
        let at_mm = run.recording.depth_mm[first];
        run.recording = Recording::from_samples(
            run.recording.time_s.split_off(first),
            run.recording.depth_mm.split_off(first).into_iter().map(|d| d - at_mm).collect(),
            run.recording.force_n.split_off(first),
        );
    }
    let design = Design::of(&triggered, "foam").unwrap();
    assert!(!design.zero_is_contact && design.zero_mm < -0.4, "{}", design.zero_mm);
}

/// A knock soon after the contact leaves so little of two runs of eight that their contacts are guesses; the depth was zeroed there nevertheless.
#[test]
fn what_a_knock_leaves_of_a_run_moves_no_zero() {
    const KNOCKED_MM: f64 = 0.3;
    let mut knocked = experiment(3);
    for run in &mut knocked.runs[..2] {
        let at = run.recording.depth_mm.iter().position(|d| *d > KNOCKED_MM).unwrap();
        run.recording.force_n[at..].iter_mut().zip(0..).for_each(|(f, k)| *f -= 0.4 * (-0.2 * f64::from(k)).exp());
    }
    let design = Design::of(&knocked, "foam").unwrap();
    assert_eq!(design.messages.iter().filter(|m| m.contains("force falls")).count(), 2, "{:?}", design.messages);
    assert!(design.zero_is_contact, "{:?}", design.messages);
}

/// Means over 30 experiments of 8 spots, whose standard errors are 7 % of a jitter (6 degrees of freedom each), 2 % of the noise.
#[test]
fn noise_and_jitter_are_found_from_replicates() {
    let (mut sigma, mut contact, mut gain) = (0.0, 0.0, 0.0);
    let count = 30;
    for seed in 0..count {
        let design = Design::of(&experiment(seed), "foam").unwrap();
        let found = noise::estimate(&design, &curves(&design), None).unwrap();
        assert_eq!(found.source, Source::Replicates);
        sigma += found.sensor.sigma_n / count as f64;
        contact += found.jitter.contact_mm.powi(2) / count as f64;
        gain += found.jitter.gain.powi(2) / count as f64;
        assert!((0.02..=0.4).contains(&found.sensor.correlation_s), "{found:?}");
    }
    // the level over the grid of correlation times scatters by as much as its neighbours differ: a fifth
    assert!((sigma / SIGMA_N - 1.0).abs() < 0.2, "{sigma}");
    // the jitter of the contact comes out a third too large here: three shapes that look alike over one ramp share it. A threshold that is
    // too high is the safe side; one that is too low would not be
    assert!((0.85..1.5).contains(&(contact.sqrt() / CONTACT_MM)), "{contact}");
    assert!((gain.sqrt() / GAIN - 1.0).abs() < 0.25, "{gain}");
}

/// Noise of 0.3 % of the force is a quarter of the variance where presses end, at 2 N, and nearly all of it in coupons, at 14 N. One contrast of 24 windows, four shapes taken off, tells a level to a
/// sixth at best.
#[test]
fn noise_in_proportion_to_the_force_shows_in_coupons() {
    const RELATIVE: f64 = 0.003;
    const HEIGHT_MM: f64 = 12.7;
    let foam_n = |depth_mm: f64| 14.0 * (2.0 * depth_mm.max(0.0) / HEIGHT_MM).powf(1.5);
    let (mut with, mut without) = (Vec::new(), Vec::new());
    for seed in 0..8 {
        let mut chance = Pcg64::seed_from_u64(1000 + seed);
        let mut all = experiment(seed);
        for run in &mut all.runs {
            let rate = (run.recording.depth_mm[1] - run.recording.depth_mm[0]) / SAMPLE_S;
            run.recording = ramp(hertz_n, (DEPTH_MM, rate), RELATIVE, &mut chance);
        }
        let found = |all: &Experiment| {
            let design = Design::of(all, "foam").unwrap();
            noise::estimate(&design, &curves(&design), None).unwrap().sensor.relative
        };
        without.push(found(&all));
        all.specimens.push(Specimen { name: "coupon".to_owned(), ..all.specimens[0].clone() });
        for file in ["c1", "c2"] {
            let recording = ramp(foam_n, (0.5 * HEIGHT_MM, 2.0), RELATIVE, &mut chance);
            let run = Run::indentation(file.to_owned(), 1, 0, recording);
            all.runs.push(Run { test: Test::Confined, indenter: None, ..run });
        }
        with.push(found(&all));
    }
    let off = |list: &[f64]| {
        let squares = list.iter().map(|r| (r / RELATIVE - 1.0).powi(2));
        (squares.sum::<f64>() / list.len() as f64).sqrt()
    };
    assert!(off(&with) < 0.35 && off(&without) > 1.5 * off(&with), "{with:?} {without:?}");
}

/// Whitened with what was put in, residuals have unit variance: 40 experiments of 288 give 1.3 % of standard error. The contact's jitter is
/// linear to first order only, which adds as much where the force begins.
#[test]
fn whitened_residuals_have_unit_variance() {
    let (mut sum, mut neighbours, mut count) = (0.0, 0.0, 0.0);
    for seed in 100..140 {
        let design = Design::of(&experiment(seed), "foam").unwrap();
        let curves = curves(&design);
        let sensor = SensorNoise { sigma_n: SIGMA_N, white: 0.0, correlation_s: TAU_S, relative: 0.0 };
        let jitter = Jitter { contact_mm: CONTACT_MM, gain: GAIN, zero_n: 0.0 };
        let posterior = Posterior::stated(jitter, 1e6);
        let noise = Noise { source: Source::Stated, sensor, jitter, posterior, sensor_freedom: 1e6 };
        let whitening = Whitening::new(&design, &curves, &noise).unwrap();
        let measured = design.series.iter().flat_map(|s| s.nodes.iter().map(|n| n.force_n));
        let model = curves.iter().flat_map(|c| c.force_n.iter().copied());
        let mut residual = DVector::from_vec(measured.zip(model).map(|(a, b)| a - b).collect::<Vec<f64>>());
        whitening.apply(&mut residual);
        sum += residual.norm_squared();
        neighbours += residual.as_slice().windows(2).map(|w| w[0] * w[1]).sum::<f64>();
        count += residual.len() as f64;
    }
    assert!((sum / count - 1.0).abs() < 0.06, "{}", sum / count);
    assert!((neighbours / count).abs() < 0.06, "{}", neighbours / count);
}

/// A window that is not compared changes nothing of the others: they are whitened as if it had not been recorded. Set to nothing between correlated neighbours it would
/// be a step that no noise makes.
#[test]
fn what_has_lifted_says_nothing_of_the_windows_beside() {
    const GONE: usize = 20;
    let whole = Design::of(&experiment(5), "foam").unwrap();
    let (mut lifted, mut without) = (whole.clone(), whole.clone());
    // from every repeat: the curve that gains scale with is the mean of those
    let repeats: Vec<usize> =
        (0..whole.series.len()).filter(|s| whole.series[*s].condition == whole.series[0].condition).collect();
    repeats.iter().for_each(|s| lifted.series[*s].nodes[GONE].lifted = true);
    for s in &repeats {
        without.series[*s].nodes.remove(GONE);
    }
    let sensor = SensorNoise { sigma_n: SIGMA_N, white: 0.1, correlation_s: TAU_S, relative: 0.0 };
    let jitter = Jitter { contact_mm: CONTACT_MM, gain: GAIN, zero_n: SIGMA_N };
    let noise = Noise {
        source: Source::Stated,
        sensor,
        jitter,
        posterior: Posterior::stated(jitter, 1e6),
        sensor_freedom: 1e6,
    };
    let white = |design: &Design, offset_n: &dyn Fn(usize) -> f64| {
        let whitening = Whitening::new(design, &curves(design), &noise).unwrap();
        let mut values = DVector::from_fn(whitening.residuals(), |k, _| offset_n(k));
        whitening.apply(&mut values);
        values
    };
    let whitening = Whitening::new(&whole, &curves(&whole), &noise).unwrap();
    let gone: Vec<usize> = repeats.iter().map(|s| whitening.first(*s) + GONE).collect();
    // a zero that is off by two standard deviations
    let there = white(&lifted, &|k| if gone.contains(&k) { 0.0 } else { 2.0 * SIGMA_N });
    let rest = white(&without, &|_| 2.0 * SIGMA_N);
    assert!(gone.iter().all(|k| there[*k].abs() < 1e-12), "{there}");
    let kept: Vec<f64> = (0..there.len()).filter(|k| !gone.contains(k)).map(|k| there[k]).collect();
    let apart = kept.iter().zip(rest.iter()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(kept.len() == rest.len() && apart < 1e-9, "{apart}");
}

/// A matrix of what a whitening does.
fn dense(whitening: &Whitening) -> DMatrix<f64> {
    let mut out = DMatrix::identity(whitening.residuals(), whitening.residuals());
    whitening.apply_to(&mut out);
    out
}

fn noise_of_spots() -> Noise {
    let sensor = SensorNoise { sigma_n: SIGMA_N, white: 0.1, correlation_s: TAU_S, relative: 0.0 };
    let jitter = Jitter { contact_mm: CONTACT_MM, gain: GAIN, zero_n: SIGMA_N };
    let posterior = Posterior::stated(jitter, 1e6);
    Noise { source: Source::Stated, sensor, jitter, posterior, sensor_freedom: 1e6 }
}

/// Rows that are left out are removed: the others are whitened by their own covariance, which is a part of that of all, and not by a part of its inverse. A group of conditions
/// goes, single windows of runs go, nearly all goes.
#[test]
fn rows_that_are_left_out_are_removed_from_the_covariance() {
    let mut design = Design::of(&experiment(5), "foam").unwrap();
    design.series[1].nodes[3].lifted = true;
    let whole = Whitening::new(&design, &curves(&design), &noise_of_spots()).unwrap();
    let all = dense(&whole);
    let covariance = (all.transpose() * &all).try_inverse().unwrap();
    let of_series = |flag: &dyn Fn(usize, usize) -> bool| -> Vec<bool> {
        let each = design.series.iter().enumerate();
        each.flat_map(|(s, own)| (0..own.nodes.len()).map(move |k| (s, k))).map(|(s, k)| flag(s, k)).collect()
    };
    let compared = |s: usize, k: usize| !design.series[s].nodes[k].lifted;
    let masks = [
        of_series(&compared),
        of_series(&|s, k| compared(s, k) && design.series[s].group != 0),
        of_series(&|s, k| compared(s, k) && (s + 3 * k) % 5 != 0),
        of_series(&|s, k| s == 2 && k > 4),
    ];
    for used in masks {
        let rows: Vec<usize> = (0..used.len()).filter(|k| used[*k]).collect();
        let masked = whole.for_rows(&used).unwrap();
        let map = dense(&masked);
        let own = map.select_rows(&rows).select_columns(&rows);
        let left = &own * covariance.select_rows(&rows).select_columns(&rows) * own.transpose();
        // rounding of a covariance whose numbers span six orders
        assert!((left - DMatrix::identity(rows.len(), rows.len())).amax() < 1e-7, "{}", rows.len());
        let gone = used.iter().enumerate().filter(|(_, used)| !**used).map(|(k, _)| k);
        assert!(gone.clone().all(|k| map.row(k).amax() == 0.0 && map.column(k).amax() == 0.0));
        // what was left out can come back
        let back = dense(&masked.for_rows(&of_series(&compared)).unwrap());
        assert!((&back - dense(&whole.for_rows(&of_series(&compared)).unwrap())).amax() == 0.0);
    }
}

/// A contact that lifts off stays off, whatever the noise of single windows is.
#[test]
fn a_contact_lifts_off_once() {
    let mut chance = Pcg64::seed_from_u64(12);
    let mut all = experiment(6);
    for run in &mut all.runs {
        let Recording { mut time_s, mut depth_mm, mut force_n, .. } = run.recording.clone();
        let end_s = time_s[time_s.len() - 1];
        for i in (0..time_s.len() - 1).rev() {
            time_s.push(2.0 * end_s - time_s[i]);
            depth_mm.push(depth_mm[i]);
            // what a foam that relaxes gives back: less and less of what it took, with noise of a percent of the peak
            let share = 1.2 * (depth_mm[i] / DEPTH_MM) - 0.2;
            force_n.push((share * hertz_n(depth_mm[i])).max(0.0) + 2.0 * SIGMA_N * normal(&mut chance));
        }
        run.recording = Recording::from_samples(time_s, depth_mm, force_n);
    }
    let design = Design::of(&all, "foam").unwrap();
    for series in &design.series {
        let back: Vec<bool> = series.nodes.iter().filter(|n| n.branch == Branch::Unloading).map(|n| n.lifted).collect();
        let first = back.iter().position(|lifted| *lifted).expect("it lifts off");
        assert!((3..back.len() - 3).contains(&first) && back[first..].iter().all(|lifted| *lifted), "{back:?}");
    }
}

/// The threshold is the level of 1 in 200 among a thousand twins; among other thousands it is exceeded about as often, within
/// four standard errors of both.
#[test]
fn the_threshold_is_exceeded_as_often_as_it_says() {
    let design = Design::of(&experiment(7), "foam").unwrap();
    let curves = curves(&design);
    let noise = noise::estimate(&design, &curves, None).unwrap();
    let whitening = Whitening::new(&design, &curves, &noise).unwrap();
    let used = vec![true; whitening.residuals()];
    let twins = evidence::twins(&whitening, &noise, &[], &used, 5000);
    let (known, fresh) = (twins.columns(0, 1000).into_owned(), twins.columns(1000, 4000).into_owned());
    let patterns = DMatrix::from_fn(whitening.residuals(), 20, |i, j| f64::from(u8::from(i % 20 == j)));
    let gauge = Gauge::new(&Panel::of(patterns, &known), &DMatrix::zeros(whitening.residuals(), 0), &known);
    let above =
        fresh.column_iter().filter(|c| gauge.read(&c.into_owned()).iter().any(|r| r.abs() > gauge.threshold)).count();
    assert!(above < 4000 / 200 + 45, "{above}");
}

/// What comes new to a sensor's noise with one sample, ten times as large as usual, is a spike of its run; the rest of that run, which it shifts, is as good as ever.
/// What every repeat has at the same place is none, nor is anything where a hundredth of all is that far off.
#[test]
fn a_spike_is_a_single_accident() {
    const AT: usize = 12;
    let design = Design::of(&experiment(8), "foam").unwrap();
    let curves = curves(&design);
    let noise = noise::estimate(&design, &curves, None).unwrap();
    let whitening = Whitening::new(&design, &curves, &noise).unwrap();
    let knocked = |knocks: &[(usize, usize)]| {
        let mut values = DVector::zeros(whitening.residuals());
        for &(series, node) in knocks {
            let lower = noise.sensor.factor(&design.series[series].nodes, &curves[series].force_n).unwrap().lower();
            let mut own = values.rows_mut(whitening.first(series), lower.nrows());
            own.axpy(10.0, &lower.column(node), 1.0);
        }
        values
    };
    let white = |whitening: &Whitening, values: &DVector<f64>| {
        let mut values = values.clone();
        whitening.apply(&mut values);
        values
    };
    let once = knocked(&[(0, AT)]);
    let spikes = spike::of(&design, &whitening, &white(&whitening, &once));
    let [spike] = spikes[..] else { panic!("{spikes:?}") };
    assert!((spike.series, spike.node) == (0, AT) && (8.0..=10.0).contains(&spike.size), "{spike:?}");
    let spared = Whitening::but_for(&spikes, &design, &curves, &noise).unwrap();
    let left = white(&spared, &once);
    assert!((0.8..1.3).contains(&left[whitening.first(0) + AT]), "{left}");
    assert!(left.norm_squared() < 2.0, "{}", left.norm_squared());
    let repeats = |k: &usize| design.series[*k].condition == design.series[0].condition;
    let everywhere: Vec<(usize, usize)> = (0..design.series.len()).filter(repeats).map(|k| (k, AT)).collect();
    assert!(everywhere.len() > 2);
    let many: Vec<(usize, usize)> = (0..4).map(|k| (0, 4 + 8 * k)).collect();
    for none in [everywhere, many] {
        assert_eq!(spike::of(&design, &whitening, &white(&whitening, &knocked(&none))), [], "{none:?}");
    }
}

/// Eight short ramps know the correlation of the noise to some ten percent: the weights are spread over several, the largest on what it is near, and twins of a longer
/// correlation have neighbours that are alike.
#[test]
fn what_else_the_noise_may_be_is_in_the_twins() {
    let design = Design::of(&experiment(9), "foam").unwrap();
    let curves = curves(&design);
    let noise = noise::estimate(&design, &curves, None).unwrap();
    let plausible = noise::plausible(&design, &curves, &noise);
    let weights: f64 = plausible.iter().map(|p| p.0).sum();
    let mean_s = plausible.iter().map(|p| p.0 * p.1.correlation_s).sum::<f64>();
    let scatter_s = plausible.iter().map(|p| p.0 * (p.1.correlation_s - mean_s).powi(2)).sum::<f64>().sqrt();
    assert!((weights - 1.0).abs() < 1e-12 && plausible.len() > 2, "{plausible:?}");
    assert!((mean_s - TAU_S).abs() < 3.0 * scatter_s, "{mean_s} {scatter_s}");
    assert!((0.02..0.6).contains(&(scatter_s / TAU_S)), "{scatter_s}");
    let whitening = Whitening::new(&design, &curves, &noise).unwrap();
    let same = whitening.colours(&design, &curves, &noise.sensor).unwrap();
    assert!(same.iter().all(|c| (c - DMatrix::identity(c.nrows(), c.ncols())).amax() < 1e-9));
    let slower = SensorNoise { correlation_s: 2.0 * noise.sensor.correlation_s, ..noise.sensor };
    let slower = vec![(1.0, whitening.colours(&design, &curves, &slower).unwrap())];
    let used = vec![true; whitening.residuals()];
    // what neighbours have in common
    let shared = |plausible: &[(f64, Vec<DMatrix<f64>>)]| {
        let twins = evidence::twins(&whitening, &noise, plausible, &used, 500);
        let each = twins.column_iter().map(|c| c.as_slice().windows(2).map(|w| w[0] * w[1]).sum::<f64>());
        each.sum::<f64>() / 500.0 / design.series.iter().map(|s| s.nodes.len()).sum::<usize>() as f64
    };
    let (known, other) = (shared(&[]), shared(&slower));
    assert!(known.abs() < 0.05 && other > known + 0.1, "{known} {other}");
}

/// Spots of which each is six percent stiffer than the one before are told, those that differ by a percent are not.
#[test]
fn spots_that_differ_too_much_are_told() {
    let told = |more: f64| {
        let mut all = experiment(11);
        for (at, run) in all.runs.iter_mut().enumerate() {
            let gain = 1.0 + more * (at as f64 - 3.5);
            run.recording.force_n.iter_mut().for_each(|f| *f *= gain);
        }
        let design = Design::of(&all, "foam").unwrap();
        verdict::unevenness(&noise::estimate(&design, &curves(&design), None).unwrap())
    };
    assert_eq!(told(0.0), None);
    assert!(told(0.06).is_some_and(|gain| (0.05..0.2).contains(&gain)), "{:?}", told(0.06));
}

/// An experiment whose spots lie on two lines, each run's gain off by `more` a millimetre along the first and as much back along the second.
fn placed(seed: u64, more: f64) -> Experiment {
    let mut all = experiment(seed);
    for (at, run) in all.runs.iter_mut().enumerate() {
        let [x, y] = [4.0 * (at % SPOTS) as f64, 3.0 * (at % 2) as f64];
        run.place_mm = Some([x, y]);
        run.recording.force_n.iter_mut().for_each(|f| *f *= 1.0 + more * (x - y));
    }
    all
}

fn gradients(all: &Experiment) -> Vec<gradient::Gradient> {
    let design = Design::of(all, "foam").unwrap();
    noise::estimate(&design, &curves(&design), None).unwrap().posterior.gradients
}

/// Half a percent a millimetre beside a scatter of a percent, along both directions; where one run has no place, or all of a condition have one, there is no slope to tell.
#[test]
fn a_gain_that_goes_with_the_place_is_told() {
    let all = placed(11, 0.005);
    let design = Design::of(&all, "foam").unwrap();
    let noise = noise::estimate(&design, &curves(&design), None).unwrap();
    let told = verdict::gradient(&noise).unwrap();
    // eight spots, two slopes: each to 0.0009 and 0.0027
    assert!((told.per_mm[0] - 0.005).abs() < 0.003 && (told.per_mm[1] + 0.005).abs() < 0.008, "{told:?}");
    let said = |per_mm: [f64; 2], chance: f64| {
        verdict::slope(&gradient::Gradient { specimen: 0, per_mm, chance }, &all).unwrap()
    };
    let text = "on foam the force grows by 0.50 % a millimetre towards [0.80, -0.60], 3.9 % over the 8 mm that its spots span there, which scatter between spots does once in 800: ";
    assert!(said([0.004, -0.003], 1.0 / 800.0).starts_with(text), "{}", said([0.004, -0.003], 1.0 / 800.0));
    let text = "on foam the force grows by 0.40 % a millimetre towards -x, 4.8 % over the 12 mm that its spots span there, which scatter between spots does less than once in a million: ";
    assert!(said([-0.004, 0.0], 1e-9).starts_with(text), "{}", said([-0.004, 0.0], 1e-9));
    let mut unknown = all.clone();
    unknown.runs.iter_mut().step_by(SPOTS).for_each(|run| run.place_mm = None);
    assert_eq!(gradients(&unknown), []);
    let mut together = all;
    together.runs.iter_mut().for_each(|run| run.place_mm = Some([3.0, 4.0]));
    assert_eq!(gradients(&together), []);
}

/// Of 200 experiments without one: chances are even, so that below a tenth lie 20 with a deviation of 4, and below a hundredth 2.
#[test]
fn a_gradient_by_chance_is_as_seldom_as_it_says() {
    let chances: Vec<f64> = (0..200).map(|seed| gradients(&placed(500 + seed, 0.0))[0].chance).collect();
    let below = |level: f64| chances.iter().filter(|chance| **chance < level).count();
    assert!((8..=32).contains(&below(0.1)) && below(0.01) <= 7, "{} {}", below(0.1), below(0.01));
}

/// The same experiment with a wave in every run whose phase is another one each time; of time (s) and depth (mm).
fn with_wave(seed: u64, wave: fn(f64, f64) -> f64) -> Experiment {
    let mut chance = Pcg64::seed_from_u64(1000 + seed);
    with_waves(seed, wave, || 3.0 * normal(&mut chance))
}

/// The same with phases of one's own.
fn with_waves(seed: u64, wave: fn(f64, f64) -> f64, phase: impl FnMut() -> f64) -> Experiment {
    shaped(seed, |turns| 3.0 * SIGMA_N * (std::f64::consts::TAU * turns).sin(), wave, phase)
}

/// The same in a shape (N over the turns of the wave); phases in radians.
fn shaped(
    seed: u64,
    shape: impl Fn(f64) -> f64,
    wave: fn(f64, f64) -> f64,
    mut phase: impl FnMut() -> f64,
) -> Experiment {
    let mut experiment = experiment(seed);
    for run in &mut experiment.runs {
        let phase = phase() / std::f64::consts::TAU;
        let Recording { time_s, depth_mm, force_n, .. } = &mut run.recording;
        for ((f, t), d) in force_n.iter_mut().zip(time_s).zip(depth_mm) {
            *f += shape(wave(*t, *d) + phase);
        }
    }
    experiment
}

fn ripple(experiment: &Experiment) -> Option<ripple::Ripple> {
    ripple_if(true, experiment)
}

fn ripple_if(adequate: bool, experiment: &Experiment) -> Option<ripple::Ripple> {
    let design = Design::of(experiment, "foam").unwrap();
    let curves = curves(&design);
    let noise = noise::estimate(&design, &curves, None).unwrap();
    ripple::of(experiment, &design, &curves, &noise.sensor, adequate)
}

/// One in a thousand clean experiments would show one by chance.
#[test]
fn noise_has_no_slow_ripple() {
    for seed in 200..240 {
        let found = ripple(&experiment(seed));
        assert!(found.is_none(), "{seed}: {found:?}");
    }
}

/// Two and a half periods of a hum in the slow ramps, six tenths of one in the fast ones; four periods of stick and slip in all.
#[test]
fn slow_ripples_are_found_with_what_they_are_regular_over() {
    for seed in 0..4 {
        let hum = ripple(&with_wave(seed, |t, _| 0.42 * t)).unwrap();
        assert!(hum.over == ripple::Over::Time && (hum.frequency - 0.42).abs() < 0.08, "{hum:?}");
        let slip = ripple(&with_wave(seed, |_, d| 1.35 * d)).unwrap();
        assert!(slip.over == ripple::Over::Depth && (slip.frequency - 1.35).abs() < 0.12, "{slip:?}");
        // amplitudes are tried in steps of 1.6, and eight phases of a sine scatter
        assert!((0.5..2.0).contains(&(slip.amplitude_n / (3.0 * SIGMA_N))), "{slip:?}");
    }
}

/// What sticks and slips builds up and falls at once; its period is that of the falls, not of a harmonic.
#[test]
fn what_sticks_and_slips_is_found_with_its_period() {
    for seed in 0..4 {
        let mut chance = Pcg64::seed_from_u64(1000 + seed);
        let saw = |turns: f64| 4.0 * SIGMA_N * (0.5 - turns.rem_euclid(1.0));
        let slip = ripple(&shaped(seed, saw, |_, d| 1.5 * d, || 3.0 * normal(&mut chance))).unwrap();
        assert!(slip.over == ripple::Over::Depth && (slip.frequency - 1.5).abs() < 0.12, "{slip:?}");
    }
}

/// A screw that turns as the ball goes down ripples alike in all repeats: what they differ by knows nothing of it, what they share does.
#[test]
fn a_ripple_that_all_repeats_share_shows_where_the_model_is_adequate() {
    for seed in 0..4 {
        let screw = with_waves(seed, |_, d| 1.35 * d, || 0.4);
        let shared = ripple_if(true, &screw).unwrap();
        assert!(shared.over == ripple::Over::Depth && (shared.frequency - 1.35).abs() < 0.12, "{shared:?}");
        assert!(ripple_if(false, &screw).is_none(), "{seed}");
    }
}

#[test]
fn without_replicates_and_stated_noise_it_is_refused_with_the_reason() {
    let mut experiment = experiment(3);
    experiment.runs.retain(|run| run.file.ends_with("-0"));
    let found = diagnose(&experiment, &Models::default(), &|_, _, _| {}).unwrap().remove(0);
    assert_eq!(found.verdict, Verdict::Refused);
    let reason = found.refusal.unwrap().to_string();
    assert!(reason.contains("no two runs repeat a condition") && reason.contains("[sensor] noise_N"), "{reason}");
    assert!(found.findings.is_empty());
}

/// One run in three may have an accident, two in five are something that slips; two drops of one run are one accident.
#[test]
fn many_drops_of_the_force_are_no_accident() {
    let drop = |run: usize| fault::Fault::ForceDrop { run: format!("{run}.csv"), event: "falls".to_owned() };
    let faults: Vec<fault::Fault> = (0..4).map(drop).collect();
    assert_eq!((fault::slipping(&faults, 10), fault::slipping(&faults, 12)), (Some(4), None));
    assert_eq!(fault::slipping(&[drop(0), drop(0), drop(1)], 2), None);
    let restarted = fault::Fault::Restarted { run: "0.csv".to_owned(), event: "stands".to_owned() };
    assert_eq!(fault::slipping(&vec![restarted; 6], 6), None);
}

#[test]
fn a_dead_sensor_is_said_to_be_dead() {
    let mut experiment = experiment(4);
    let mut chance = Pcg64::seed_from_u64(9);
    experiment.runs[2].recording.force_n.iter_mut().for_each(|f| *f = 1e-3 * normal(&mut chance));
    let found = diagnose(&experiment, &Models::default(), &|_, _, _| {}).unwrap().remove(0);
    assert_eq!((found.verdict, found.faults[0].code()), (Verdict::Refused, "dead-sensor"));
    let reason = found.refusal.unwrap().to_string();
    assert_eq!(reason, "v0.5-2: the force sensor shows nothing while the ball goes down: a dead sensor, or no contact");
}
