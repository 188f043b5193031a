//! What could be seen, without the diagnosis' verdict.

use std::collections::BTreeSet;

use lut_gen::chain::{Chain, Model};
use lut_gen::solid::law::PronyTerm;
use nalgebra::{DMatrix, DVector};
use palpate::diagnose::design::{Branch, Design, Node, Series};
use palpate::diagnose::evidence::{basis, rest_of};
use palpate::diagnose::fit::{Fit, Problem, predicted};
use palpate::diagnose::jitter::Posterior;
use palpate::diagnose::noise::{Curve, Jitter, Noise, SensorNoise, Source};
use palpate::diagnose::whiten::Whitening;
use palpate::diagnose::{Evidence, Models};
use palpate::simulate::{Effect, SimulateError, SimulatedExperiment, SimulatedRun, Solver, Spec, simulate};

/// Standard deviations of one direction that noise exceeds in one of two hundred.
const LEVEL: f64 = 2.8;
/// Standard deviations more, with which what is there exceeds that in nine cases of ten.
const POWER: f64 = 1.28;

/// An effect shows when it moves the data by this many standard deviations of the noise, along itself and after the base
/// parameters and the other effects have taken up what they can: an oracle that knows the effect's shape then finds it at the level of one
/// in two hundred (2.8) in nine cases of ten (1.28 more).
pub const SEEN: f64 = LEVEL + POWER;

/// `mu` (MPa) and `alpha` that an experiment has: of its first specimen, or usual ones.
pub(super) fn foam(spec: &Spec) -> (f64, f64) {
    spec.specimens.first().map_or((0.1, 8.0), |one| (one.mu_mpa, one.alpha))
}

/// The noise that the data truly have, as a diagnosis would write it down.
pub(super) fn true_noise(spec: &Spec, session_s: f64) -> Noise {
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

/// How far an effect moves the forces, in standard deviations of the noise along it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Strength {
    /// To one who knows the noise.
    pub known: f64,
    /// To one who has to tell from repeats what spots differ by: as seldom seen as `known` is at this strength. What an effect adds to contact and gain of a spot is told from noise
    /// by as many differences as there are spots more than conditions.
    pub told: f64,
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
) -> Result<Vec<Strength>, SimulateError> {
    let every: Vec<usize> = (0..made.truth.effects.len()).collect();
    of_effects(made, &evidence.design, (&every, Some(evidence.base.x.rows(0, 2).into_owned())), (models, solver))
}

/// The same of some of the effects of an experiment, by their places among them, in a design of its data: the others are there, and take up nothing. `start` is
/// a point (logarithms of `mu` and `alpha`) where the base may be fitted from, beside the truth.
///
/// # Errors
/// As [`strength`].
pub fn of_effects(
    made: &SimulatedExperiment,
    design: &Design,
    (wanted, start): (&[usize], Option<DVector<f64>>),
    (models, solver): (&Models, &Solver),
) -> Result<Vec<Strength>, SimulateError> {
    // what runs without the specimen show is not counted: the strength is that of the effect on the specimen's runs
    let design = &Design { checks: Vec::new(), ..design.clone() };
    let mut shifts = Vec::new();
    for &at in wanted {
        let mut spec = made.truth.clone();
        spec.effects.remove(at);
        let without = simulate(&spec, solver, &|_, _, _| {})?;
        shifts.push(shift(design, made, &without));
    }
    // what an effect is in time, energy or strain is as little known as how large it is
    let mut turned = Vec::new();
    if wanted.len() > 1 {
        for (at, &place) in wanted.iter().enumerate() {
            let Some(other) = reshaped(&made.truth.effects[place]) else { continue };
            let mut spec = made.truth.clone();
            spec.effects[place] = other;
            turned.push((at, shift(design, made, &simulate(&spec, solver, &|_, _, _| {})?)));
        }
    }
    let session_s = made.runs.iter().map(|run| run.start_s).fold(0.0, f64::max);
    let noise = true_noise(&made.truth, session_s);
    let Ok(library) = models.of(&design.geometries, &|_, _| {}) else {
        return Ok(vec![Strength { known: 0.0, told: 0.0 }; shifts.len()]);
    };
    let chain = Chain { library, passages: design.passages() };
    let contacts = vec![0.0; design.series.len()];
    let curves = true_curves(design, made, solver)?;
    let Some(whitening) = Whitening::new(design, &curves, &noise) else {
        return Ok(vec![Strength { known: 0.0, told: 0.0 }; shifts.len()]);
    };
    let truth = foam(&made.truth);
    let clean = predicted(design, &chain, &Model::base(truth.0, truth.1), &contacts);
    let used = compared(design);
    let whitened = |values: DVector<f64>| whitened(values, &used, &whitening);
    let own: Vec<DVector<f64>> = shifts.iter().cloned().map(whitened).collect();
    let spots: Vec<DVector<f64>> = of_spots(design, &curves).into_iter().map(whitened).collect();
    let turned: Vec<(usize, DVector<f64>)> = turned.into_iter().map(|(at, values)| (at, whitened(values))).collect();
    let each = shifts.iter().enumerate().map(|(at, shift)| {
        let data = with_forces(design, &clean, shift);
        let problem = Problem {
            design: &data,
            chain: &chain,
            contacts_mm: contacts.clone(),
            back_n: DVector::zeros(shift.len()),
            whitening: whitening.clone(),
            used: used.clone(),
            whole: None,
        };
        let starts = std::iter::once(DVector::from_vec(vec![truth.0.ln(), truth.1.ln()])).chain(start.clone());
        let fits: Vec<Fit> = starts.map(|x| problem.fit(&[], &x)).collect();
        let Some(fit) = fits.iter().min_by(|a, b| a.square.total_cmp(&b.square)) else {
            return Strength { known: 0.0, told: 0.0 };
        };
        let others = own.iter().enumerate().filter(|(i, _)| *i != at).map(|(_, s)| s.clone());
        let shapes = turned.iter().filter(|(i, _)| *i != at).map(|(_, s)| s.clone());
        let taken: Vec<DVector<f64>> =
            fit.jacobian.column_iter().map(|c| c.into_owned()).chain(others).chain(shapes).collect();
        let residual = DMatrix::from_columns(std::slice::from_ref(&fit.residual));
        let known = rest_of(&residual, &basis(&DMatrix::from_columns(&taken))).norm();
        let taken: Vec<DVector<f64>> = taken.into_iter().chain(spots.iter().cloned()).collect();
        let beside = rest_of(&residual, &basis(&DMatrix::from_columns(&taken))).norm();
        let along = (known * known - beside * beside).max(0.0).sqrt();
        match made.truth.effects[wanted[at]] {
            Effect::Hum { .. } | Effect::StickSlip { .. } => {
                let waved = with_unknown_phases(known, design.series.len());
                Strength { known: waved, told: waved }
            }
            _ => Strength { known, told: beside.hypot(along * of_unknown_noise(differences(design))) },
        }
    });
    Ok(each.collect())
}

/// Forces without noise, with all that the experiment hides, and what a deeper contact does to them: contact and gain of a spot differ by these, whatever a base predicts. Taken from a base that
/// knows nothing of a relaxation of 140 standard deviations, a wrong radius beside that seemed to move the data by 16 of them, which does so by 7.
fn true_curves(design: &Design, made: &SimulatedExperiment, solver: &Solver) -> Result<Vec<Curve>, SimulateError> {
    const DEEPER_MM: f64 = 0.02;
    let mut spec = made.truth.clone();
    // a zero that drifts is no force on the ball
    spec.effects.retain(|effect| !matches!(effect, Effect::Drift { .. }));
    let here = simulate(&spec, solver, &|_, _, _| {})?;
    spec.effects.push(Effect::ContactOffset { offset_mm: DEEPER_MM });
    let deeper = simulate(&spec, solver, &|_, _, _| {})?;
    let curve = |series: &Series| {
        let (run, moved) = (&here.runs[series.run], &deeper.runs[series.run]);
        let force_n = over_windows(design, series, run, &run.exact_n);
        let moved_n = over_windows(design, series, run, &moved.exact_n);
        let slope_n_per_mm = moved_n.iter().zip(&force_n).map(|(moved, here)| (moved - here) / DEEPER_MM).collect();
        Curve { force_n, slope_n_per_mm }
    };
    Ok(design.series.iter().map(curve).collect())
}

/// True for windows that are compared at all: not where the contact has lifted.
pub(super) fn compared(design: &Design) -> Vec<bool> {
    design.series.iter().flat_map(|s| s.nodes.iter().map(|node| !node.lifted)).collect()
}

/// What a diagnosis sees of forces (N).
fn whitened(mut values: DVector<f64>, compared: &[bool], whitening: &Whitening) -> DVector<f64> {
    values.iter_mut().zip(compared).filter(|(_, compared)| !**compared).for_each(|(value, _)| *value = 0.0);
    whitening.apply(&mut values);
    values
}

/// Changes of the contact and of the gain of every spot, N.
fn of_spots(design: &Design, curves: &[Curve]) -> Vec<DVector<f64>> {
    let of = |spot: usize, shape: fn(&Curve) -> &[f64]| {
        let runs = design.series.iter().zip(curves);
        DVector::from_vec(
            runs.flat_map(|(s, curve)| {
                let here = if s.spot == spot { 1.0 } else { 0.0 };
                shape(curve).iter().map(move |v| here * v)
            })
            .collect(),
        )
    };
    (0..design.spots).flat_map(|spot| [of(spot, |c| &c.force_n), of(spot, |c| &c.slope_n_per_mm)]).collect()
}

/// Differences between repeats that tell what spots differ by: spots beyond the first of every condition.
fn differences(design: &Design) -> usize {
    let groups: BTreeSet<usize> = design.series.iter().map(|s| s.group).collect();
    design.spots.saturating_sub(groups.len())
}

/// Part of a strength in noise of unknown size that is left where the noise is told from so many differences: Student's t in place of a normal deviate has to exceed its own one in two hundred, nine
/// times in ten. 0 without differences.
///
/// The quantile by Cornish and Fisher's expansion (Abramowitz and Stegun 26.7.5), the power by the normal approximation of a noncentral t (there 26.7.10).
fn of_unknown_noise(differences: usize) -> f64 {
    if differences == 0 {
        return 0.0;
    }
    let (z, n) = (LEVEL, differences as f64);
    let powers = |c: [f64; 5]| c.iter().rev().fold(0.0, |sum, c| sum * z * z + c) * z;
    let exceeded = z
        + powers([1.0, 1.0, 0.0, 0.0, 0.0]) / (4.0 * n)
        + powers([3.0, 16.0, 5.0, 0.0, 0.0]) / (96.0 * n.powi(2))
        + powers([-15.0, 17.0, 19.0, 3.0, 0.0]) / (384.0 * n.powi(3))
        + powers([-945.0, -1920.0, 1482.0, 776.0, 79.0]) / (92160.0 * n.powi(4));
    let needed = exceeded * (1.0 - 0.25 / n) + POWER * (1.0 + exceeded * exceeded / (2.0 * n)).sqrt();
    SEEN / needed
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
            Some(Effect::Relaxation(terms.iter().map(|t| PronyTerm { tau_s: BY * t.tau_s, ..*t }).collect()))
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
pub(super) fn with_forces(design: &Design, clean: &[Vec<f64>], shift: &DVector<f64>) -> Design {
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
pub(super) fn shift(design: &Design, with: &SimulatedExperiment, without: &SimulatedExperiment) -> DVector<f64> {
    let each = design.series.iter().flat_map(|series| {
        let (run, other) = (&with.runs[series.run], &without.runs[series.run]);
        let difference: Vec<f64> = run.exact_n.iter().zip(&other.exact_n).map(|(a, b)| a - b).collect();
        over_windows(design, series, run, &difference)
    });
    DVector::from_vec(each.collect())
}

/// Means of values at the samples of a run over the windows of a design; 0 where a window has none.
fn over_windows(design: &Design, series: &Series, run: &SimulatedRun, values: &[f64]) -> Vec<f64> {
    let start_s = start_s(design, series, run);
    let over = |node: &Node| {
        let near = |t: &f64| (t - start_s - node.time_s).abs() <= 0.5 * node.length_s;
        let own = run.time_s.iter().zip(values).filter(|(t, _)| near(t)).map(|(_, v)| *v);
        let (count, sum) = own.fold((0.0, 0.0), |(count, sum), v| (count + 1.0, sum + v));
        if count > 0.0 { sum / count } else { 0.0 }
    };
    series.nodes.iter().map(over).collect()
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hidden::{Case, Design as HiddenDesign, What};
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

    /// Against drawn t: a shape at the strength that `known` is seen at is found nine times in ten where the noise is known, and as often a larger one by the factor where it is told from
    /// differences (90,000 draws; the level from 200,000 without a shape).
    #[test]
    fn noise_that_is_told_from_repeats_hides_more() {
        let mut chance = Pcg64::seed_from_u64(11);
        for differences in [4, 6, 12, 40] {
            let mut t = |moved: f64, count: usize| -> Vec<f64> {
                let mut normal = || chance.sample::<f64, _>(StandardNormal);
                let mut one = || {
                    let square: f64 = (0..differences).map(|_| normal().powi(2)).sum();
                    (normal() + moved) / (square / f64::from(differences)).sqrt()
                };
                (0..count).map(|_| one()).collect()
            };
            let mut noise: Vec<f64> = t(0.0, 200_000).into_iter().map(f64::abs).collect();
            noise.sort_by(f64::total_cmp);
            let level = noise[noise.len() - 1000];
            let needed = SEEN / of_unknown_noise(differences as usize);
            let found = t(needed, 90_000).into_iter().filter(|t| *t > level).count() as f64 / 90_000.0;
            assert!((found - 0.9).abs() < 0.02, "{differences}: {needed} {found}");
        }
        assert!(of_unknown_noise(0) == 0.0 && (of_unknown_noise(100_000) - 1.0).abs() < 1e-3);
    }

    /// A spot that differs by one deviation in gain, or in contact, is at most one deviation of the noise, and not much less, since little else looks like it: also beside a relaxation that takes a third of the
    /// force. The contact moves back by ten deviations, where what it does was found with a fiftieth of a millimetre forth: a tenth of curvature.
    #[test]
    fn a_spot_that_differs_is_noise_whatever_is_hidden() -> Result<(), Box<dyn std::error::Error>> {
        let solver = Solver::new();
        let case = Case::new(HiddenDesign::D36, 40).hiding(What::Catalogue("relaxation", 4));
        let made = case.make(&solver)?;
        let design = &Design::of(&made.experiment(), "specimen")?;
        let curves = true_curves(design, &made, &solver)?;
        let noise = true_noise(&made.truth, 0.0);
        let whitening = Whitening::new(design, &curves, &noise).ok_or("no whitening")?;
        let seen = |values| whitened(values, &compared(design), &whitening).norm();
        let gain = seen(of_spots(design, &curves)[0].clone() * noise.jitter.gain);
        let back_mm = -10.0 * noise.jitter.contact_mm;
        let mut spec = made.truth.clone();
        spec.effects.push(Effect::ContactOffset { offset_mm: back_mm });
        let moved = shift(design, &simulate(&spec, &solver, &|_, _, _| {})?, &made) / 10.0;
        let mut at = 0;
        let of_first = design.series.iter().flat_map(|s| {
            at += s.nodes.len();
            let here = if s.spot == 0 { 1.0 } else { 0.0 };
            moved.rows(at - s.nodes.len(), s.nodes.len()).iter().map(move |v| here * v).collect::<Vec<f64>>()
        });
        let contact = seen(DVector::from_vec(of_first.collect()));
        assert!((0.8..=1.0).contains(&gain) && (0.8..=1.1).contains(&contact), "{gain} {contact}");
        Ok(())
    }

    /// The same size in another shape, where there is more than one.
    #[test]
    fn a_reshaped_effect_is_as_large_as_before() {
        let relaxes = |tau_s| Effect::Relaxation(vec![PronyTerm::alike(0.2, tau_s)]);
        assert_eq!(reshaped(&relaxes(2.0)), Some(relaxes(2.1)));
        let creep = reshaped(&Effect::SensorCreep { amplitude: 0.1, tau_s: 4.0 });
        assert_eq!(creep, Some(Effect::SensorCreep { amplitude: 0.1, tau_s: 4.2 }));
        assert_eq!(reshaped(&Effect::Compliance { mm_per_n: 0.1 }), None);
    }
}
