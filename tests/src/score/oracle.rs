//! What could be seen, and what an oracle that is told the effect would gain: both without the diagnosis' verdict.

use lut_gen::chain::{Chain, Model};
use nalgebra::{DMatrix, DVector};
use palpate::diagnose::coordinate::Candidate;
use palpate::diagnose::design::{Branch, Design, Series};
use palpate::diagnose::evidence::{basis, rest_of};
use palpate::diagnose::fit::{Fit, Problem, predicted};
use palpate::diagnose::jitter::Posterior;
use palpate::diagnose::noise::{Jitter, Noise, SensorNoise, Source};
use palpate::diagnose::search::Explanation;
use palpate::diagnose::whiten::Whitening;
use palpate::diagnose::{Diagnosis, Evidence, Models, Prepared, Verdict};
use palpate::experiment::Experiment;
use palpate::simulate::{Effect, SimulateError, SimulatedExperiment, SimulatedRun, Solver, Spec, simulate};
use rayon::prelude::*;

use crate::hidden::Truth;

/// Standard deviations of one direction that noise exceeds in one of two hundred.
const LEVEL: f64 = 2.8;
/// Standard deviations more, with which what is there exceeds that in nine cases of ten.
const POWER: f64 = 1.28;

/// An effect shows when it moves the data by this many standard deviations of the noise, along itself and after the base
/// parameters and the other effects have taken up what they can: an oracle that knows the effect's shape then finds it at the level of one
/// in two hundred (2.8) in nine cases of ten (1.28 more).
pub const SEEN: f64 = LEVEL + POWER;

/// Root mean square errors on left-out conditions, N.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gain {
    /// With the base.
    pub before_n: f64,
    /// With what was found; the base where nothing was.
    pub found_n: f64,
    /// With the effects that are true, fitted.
    pub oracle_n: f64,
}

impl Gain {
    /// Share of the oracle's fall of the error; `None` where the oracle gains less than a twentieth.
    #[must_use]
    pub fn share(&self) -> Option<f64> {
        let whole = self.before_n - self.oracle_n;
        (whole > 0.05 * self.before_n).then(|| (self.before_n - self.found_n) / whole)
    }
}

/// The noise that the data truly have, as a diagnosis would write it down.
fn true_noise(spec: &Spec, session_s: f64) -> Noise {
    let n = &spec.noise;
    // rounding to steps of q is an error of variance q^2 / 12
    let rounding = n.quantum_n.powi(2) / 12.0;
    let whole = n.sensor_n.powi(2) + rounding;
    let jitter = Jitter {
        contact_mm: n.contact_jitter_mm,
        gain: n.gain_jitter,
        // a random walk of the zero, taken as independent from run to run, of its mean variance over the session
        zero_n: n.drift_n_per_h * (0.5 * session_s / 3600.0).sqrt(),
    };
    Noise {
        source: Source::Stated,
        sensor: SensorNoise {
            sigma_n: whole.sqrt(),
            white: if whole > 0.0 { rounding / whole } else { 0.0 },
            correlation_s: n.correlation_s.max(1e-3),
            relative: n.proportional,
        },
        jitter,
        posterior: Posterior::stated(jitter, 1e3),
        sensor_freedom: 1e3,
    }
}

/// How far each effect of an experiment moves its forces, in standard deviations of the true noise along the effect, after
/// the base parameters are fitted again and the other effects, in size and in shape, have taken up what they can to first order.
/// A wave has another phase in every run, which nobody can know: its strength is that of what is seen as often and has a known shape.
///
/// # Errors
/// When a finite-element solve of the experiment without one of its effects fails.
pub fn strength(
    made: &SimulatedExperiment,
    evidence: &Evidence,
    models: &Models,
    solver: &Solver,
) -> Result<Vec<f64>, SimulateError> {
    // what runs without the specimen show is not counted: the strength is that of the effect on the specimen's runs
    let design = &Design { checks: Vec::new(), ..evidence.design.clone() };
    let mut shifts = Vec::new();
    for at in 0..made.truth.effects.len() {
        let mut spec = made.truth.clone();
        spec.effects.remove(at);
        let without = simulate(&spec, solver, &|_, _, _| {})?;
        shifts.push(shift(design, made, &without));
    }
    // what an effect is in time, energy or strain is as little known as how large it is
    let mut turned = Vec::new();
    if made.truth.effects.len() > 1 {
        for (at, effect) in made.truth.effects.iter().enumerate() {
            let Some(other) = reshaped(effect) else { continue };
            let mut spec = made.truth.clone();
            spec.effects[at] = other;
            turned.push((at, shift(design, made, &simulate(&spec, solver, &|_, _, _| {})?)));
        }
    }
    let session_s = made.runs.iter().map(|run| run.start_s).fold(0.0, f64::max);
    let noise = true_noise(&made.truth, session_s);
    let base = &evidence.base;
    let Ok(library) = models.of(&design.geometries, &|_, _| {}) else { return Ok(vec![0.0; shifts.len()]) };
    let chain = Chain { library, passages: design.passages() };
    let contacts = vec![0.0; design.series.len()];
    let curves = Problem::curves(design, &chain, &base.model, &contacts);
    let Some(whitening) = Whitening::new(design, &curves, &noise) else { return Ok(vec![0.0; shifts.len()]) };
    let truth = made.truth.specimens.first().map_or((base.model.mu_mpa, base.model.alpha), |s| (s.mu_mpa, s.alpha));
    let clean = predicted(design, &chain, &Model::base(truth.0, truth.1), &contacts);
    let whitened = |mut values: DVector<f64>| {
        whitening.apply(&mut values);
        values
    };
    let own: Vec<DVector<f64>> = shifts.iter().cloned().map(whitened).collect();
    let turned: Vec<(usize, DVector<f64>)> = turned.into_iter().map(|(at, values)| (at, whitened(values))).collect();
    let each = shifts.iter().enumerate().map(|(at, shift)| {
        let data = with_forces(design, &clean, shift);
        let problem = Problem {
            design: &data,
            chain: &chain,
            contacts_mm: contacts.clone(),
            back_n: DVector::zeros(shift.len()),
            whitening: whitening.clone(),
            used: vec![true; shift.len()],
            allowed: None,
            whole: None,
        };
        let starts = [DVector::from_vec(vec![truth.0.ln(), truth.1.ln()]), base.x.rows(0, 2).into_owned()];
        let fits = starts.map(|x| problem.fit(&[], &x));
        let fit = if fits[0].square <= fits[1].square { &fits[0] } else { &fits[1] };
        let others = own.iter().enumerate().filter(|(i, _)| *i != at).map(|(_, s)| s.clone());
        let shapes = turned.iter().filter(|(i, _)| *i != at).map(|(_, s)| s.clone());
        let taken: Vec<DVector<f64>> =
            fit.jacobian.column_iter().map(|c| c.into_owned()).chain(others).chain(shapes).collect();
        let residual = DMatrix::from_columns(std::slice::from_ref(&fit.residual));
        let strength = rest_of(&residual, &basis(&DMatrix::from_columns(&taken))).norm();
        match made.truth.effects[at] {
            Effect::Hum { .. } | Effect::StickSlip { .. } => with_unknown_phases(strength, design.series.len()),
            _ => strength,
        }
    });
    Ok(each.collect())
}

/// The strength of a wave whose phase in each of some runs is unknown, of that with known ones: of two directions a run the sum of the squares is all that there is to look at, and exceeds what noise
/// does in one of two hundred as often as a known shape of this strength does.
///
/// A noncentral chi-square to a power is nearly normal (Sankaran 1963, Biometrika 50, 199).
fn with_unknown_phases(strength: f64, runs: usize) -> f64 {
    /// One in two hundred of a normal distribution lies above.
    const ABOVE: f64 = 2.576;
    let (freedom, moved) = (2.0 * runs as f64, strength * strength);
    // power, and mean and deviation of a square over its own mean to that power
    let normal = |moved: f64| {
        let (one, two, three) = (freedom + moved, freedom + 2.0 * moved, freedom + 3.0 * moved);
        let h = 1.0 - 2.0 / 3.0 * one * three / (two * two);
        let (p, m) = (two / (one * one), (h - 1.0) * (1.0 - 3.0 * h));
        let mean = 1.0 + h * p * (h - 1.0 - 0.5 * (2.0 - h) * m * p);
        (h, mean, h * (2.0 * p).sqrt() * (1.0 + 0.5 * m * p))
    };
    let (h, mean, deviation) = normal(0.0);
    let exceeded = freedom * (mean + ABOVE * deviation).max(0.0).powf(1.0 / h);
    let (h, mean, deviation) = normal(moved);
    let below = ((exceeded / (freedom + moved)).powf(h) - mean) / deviation;
    (LEVEL - below).max(0.0)
}

/// An effect of the same size and a slightly different shape; none where it has one shape.
fn reshaped(effect: &Effect) -> Option<Effect> {
    const BY: f64 = 1.05;
    match effect {
        Effect::Relaxation(terms) => {
            Some(Effect::Relaxation(terms.iter().map(|(g, tau_s)| (*g, BY * tau_s)).collect()))
        }
        Effect::SecondTerm { mu2_ratio, alpha2 } => {
            Some(Effect::SecondTerm { mu2_ratio: *mu2_ratio, alpha2: BY * alpha2 })
        }
        Effect::Softening { r, m_mpa, beta } => Some(Effect::Softening { r: *r, m_mpa: BY * m_mpa, beta: *beta }),
        Effect::SensorCreep { amplitude, tau_s } => {
            Some(Effect::SensorCreep { amplitude: *amplitude, tau_s: BY * tau_s })
        }
        _ => None,
    }
}

/// The design with the forces of a clean specimen and a shift, both in N.
fn with_forces(design: &Design, clean: &[Vec<f64>], shift: &DVector<f64>) -> Design {
    let mut data = design.clone();
    data.zero_is_contact = true;
    let mut at = 0;
    for (series, forces) in data.series.iter_mut().zip(clean) {
        for (node, force_n) in series.nodes.iter_mut().zip(forces) {
            node.force_n = force_n + shift[at];
            at += 1;
        }
    }
    data
}

/// Difference of two simulations of the same runs without noise, N, over the windows of a design.
fn shift(design: &Design, with: &SimulatedExperiment, without: &SimulatedExperiment) -> DVector<f64> {
    let each = design.series.iter().flat_map(|series| {
        let (run, other) = (&with.runs[series.run], &without.runs[series.run]);
        let difference: Vec<f64> = run.exact_n.iter().zip(&other.exact_n).map(|(a, b)| a - b).collect();
        let start_s = start_s(design, series, run);
        let over = move |node: &palpate::diagnose::design::Node| {
            let near = |t: &f64| (t - start_s - node.time_s).abs() <= 0.5 * node.length_s;
            let own = run.time_s.iter().zip(&difference).filter(|(t, _)| near(t)).map(|(_, d)| *d);
            let (count, sum) = own.fold((0.0, 0.0), |(count, sum), d| (count + 1.0, sum + d));
            if count > 0.0 { sum / count } else { 0.0 }
        };
        series.nodes.iter().map(over).collect::<Vec<f64>>()
    });
    DVector::from_vec(each.collect())
}

/// Time of a run at which its windows begin, s: found from the depth of the first window on the straight way down.
fn start_s(design: &Design, series: &Series, run: &SimulatedRun) -> f64 {
    let Some(first) = series.nodes.iter().find(|n| n.branch == Branch::Loading) else { return 0.0 };
    let depth_mm = first.depth_mm + design.zero_mm;
    let past = run.depth_mm.iter().position(|d| *d >= depth_mm).unwrap_or(0);
    let before = past.saturating_sub(1);
    let (low, high) = (run.depth_mm[before], run.depth_mm[past]);
    let share = if high > low { ((depth_mm - low) / (high - low)).clamp(0.0, 1.0) } else { 0.0 };
    run.time_s[before] + share * (run.time_s[past] - run.time_s[before]) - first.time_s
}

/// Held-out errors of the base, of what was found, and of an oracle that is told which effects are true (in the form that fits best) and fits
/// their parameters; `None` where nothing shows, or where an effect is not in the catalogue.
#[must_use]
pub fn gain(truth: &Truth, diagnosis: &Diagnosis, experiment: &Experiment, models: &Models) -> Option<Gain> {
    let evidence = diagnosis.evidence.as_deref()?;
    let codes = truth.codes();
    let told: Vec<&Explanation> = codes
        .iter()
        .map(|code| evidence.singles.iter().find(|e| e.fit.candidates.iter().all(|c| c.effect.code == *code)))
        .collect::<Option<_>>()?;
    if told.is_empty() || diagnosis.verdict == Verdict::Clean {
        return None;
    }
    let known = evidence.held_out.as_ref();
    if let ([only], Some(held_out), [alone]) = (told.as_slice(), known, evidence.held.as_slice())
        && alone.fit.candidates == only.fit.candidates
    {
        // the oracle would fit the same
        let after = held_out.rmse_after_n;
        return Some(Gain { before_n: held_out.rmse_before_n, found_n: after, oracle_n: after });
    }
    let library = models.of(&evidence.design.geometries, &|_, _| {}).ok()?;
    let chain = Chain { library, passages: evidence.design.passages() };
    let prepared = Prepared::new(&evidence.design, &chain, experiment.sensor.noise_n)?;
    let (before_n, oracle_n) = left_out(&prepared, &start(&told)?)?;
    let named = matches!(diagnosis.verdict, Verdict::Named | Verdict::Ambiguous);
    let found_n = known.filter(|_| named).map_or(before_n, |h| h.rmse_after_n);
    Some(Gain { before_n, found_n, oracle_n })
}

/// The effects together, at the parameters that each has alone.
fn start(told: &[&Explanation]) -> Option<(Vec<Candidate>, DVector<f64>)> {
    let first: &Fit = &told.first()?.fit;
    let mut candidates = first.candidates.clone();
    let mut x: Vec<f64> = first.x.iter().copied().collect();
    for other in &told[1..] {
        let own: usize = other.fit.candidates.iter().map(|c| c.effect.quantities.len()).sum();
        candidates.extend_from_slice(&other.fit.candidates);
        x.extend(other.fit.x.iter().skip(other.fit.x.len() - own));
    }
    Some((candidates, DVector::from_vec(x)))
}

/// Root mean square errors, N, of base and told effects over groups of conditions, each left out in turn.
fn left_out(prepared: &Prepared<'_>, told: &(Vec<Candidate>, DVector<f64>)) -> Option<(f64, f64)> {
    let whole = &prepared.problem;
    let design = whole.design;
    if design.groups < 2 {
        return None;
    }
    let each: Vec<[f64; 3]> = (0..design.groups)
        .into_par_iter()
        .map(|group| {
            let used = design.series.iter().flat_map(|s| vec![s.group != group; s.nodes.len()]).collect();
            let problem = Problem { used, ..whole.clone() };
            let fits = [problem.fit(&[], &prepared.base.x), problem.fit(&told.0, &told.1)];
            let [before, after] = fits.map(|fit| miss(whole, &fit, group));
            [before.0, after.0, before.1]
        })
        .collect();
    let sum = |at: usize| each.iter().map(|e| e[at]).sum::<f64>();
    Some(((sum(0) / sum(2)).sqrt(), (sum(1) / sum(2)).sqrt()))
}

/// Sum of squares, N^2, over a group, and its number of windows.
fn miss(problem: &Problem<'_>, fit: &Fit, group: usize) -> (f64, f64) {
    let curves = predicted(problem.design, problem.chain, &fit.model, &problem.contacts_mm);
    let own = problem.design.series.iter().zip(&curves).filter(|(s, _)| s.group == group);
    let pairs = own.flat_map(|(s, curve)| s.nodes.iter().zip(curve));
    pairs.fold((0.0, 0.0), |(sum, count), (node, force_n)| (sum + (node.force_n - force_n).powi(2), count + 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{Rng, SeedableRng};
    use rand_distr::StandardNormal;
    use rand_pcg::Pcg64;

    /// Against drawn squares: what one in two hundred of 40,000 without a wave exceeds, 20,000 with one exceed in a share that is known to 0.012, the level's own error in it.
    #[test]
    fn a_wave_is_seen_as_often_as_its_strength_says() {
        let mut chance = Pcg64::seed_from_u64(7);
        for runs in [6, 36] {
            let mut squares = |moved: f64, count: usize| -> Vec<f64> {
                let along = (moved / (2.0 * runs as f64)).sqrt();
                let mut one = || (along + chance.sample::<f64, _>(StandardNormal)).powi(2);
                (0..count).map(|_| (0..2 * runs).map(|_| one()).sum()).collect()
            };
            let mut noise = squares(0.0, 40_000);
            noise.sort_by(f64::total_cmp);
            let level = noise[noise.len() - 200];
            for strength in [5.0, 7.5, 9.0] {
                let above = squares(strength * strength, 20_000).into_iter().filter(|s| *s > level).count();
                let share = above as f64 / 20_000.0;
                // the normal distribution to 0.0002 (Bowling and others 2009, J. Ind. Eng. Manag. 2, 114)
                let x = with_unknown_phases(strength, runs) - LEVEL;
                let expected = 1.0 / (1.0 + (-(0.07056 * x.powi(3) + 1.5976 * x)).exp());
                assert!((share - expected).abs() < 0.03, "{runs} runs, {strength}: {share} {expected}");
            }
        }
        assert!(with_unknown_phases(0.0, 12) < 0.3 && with_unknown_phases(100.0, 12) > 20.0);
    }

    /// The same size in another shape, where there is more than one.
    #[test]
    fn a_reshaped_effect_is_as_large_as_before() {
        assert_eq!(reshaped(&Effect::Relaxation(vec![(0.2, 2.0)])), Some(Effect::Relaxation(vec![(0.2, 2.1)])));
        let creep = reshaped(&Effect::SensorCreep { amplitude: 0.1, tau_s: 4.0 });
        assert_eq!(creep, Some(Effect::SensorCreep { amplitude: 0.1, tau_s: 4.2 }));
        assert_eq!(reshaped(&Effect::Compliance { mm_per_n: 0.1 }), None);
    }
}
