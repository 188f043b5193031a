//! What repeats of one condition differ by: sensor noise with its correlation in time, and jitter of contact point, gain
//! and zero.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::check::{Check, Coupon};
use super::correlated::Factor;
use super::design::{Design, Node};
use super::jitter::Posterior;
pub use super::scatter::{Curve, Jitter, SensorNoise};

/// Where the noise was taken from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// Differences between replicates.
    Replicates,
    /// Stated by the user.
    Stated,
}

/// Noise of a data set.
#[derive(Debug, Clone, PartialEq)]
pub struct Noise {
    /// Source.
    pub source: Source,
    /// Of the sensor.
    pub sensor: SensorNoise,
    /// Between spots.
    pub jitter: Jitter,
    /// What else the jitter may be.
    pub posterior: Posterior,
    /// Degrees of freedom behind the sensor noise.
    pub sensor_freedom: f64,
}

/// Jitter when a noise is stated but nothing repeated; the report says so.
const UNREPEATED: Jitter = Jitter { contact_mm: 0.05, gain: 0.01, zero_n: 0.0 };
/// Degrees of freedom that a stated noise is taken for.
const STATED_FREEDOM: f64 = 20.0;

/// Correlation times (s), white shares and relative parts that are tried.
const TIMES_S: [f64; 9] = [0.005, 0.02, 0.04, 0.08, 0.15, 0.3, 0.6, 1.2, 2.5];
const WHITE: [f64; 4] = [0.0, 0.2, 0.5, 0.9];
const RELATIVE: [f64; 4] = [0.0, 0.003, 0.01, 0.03];

/// What repeats of a condition differ by: one of as many orthonormal contrasts as there are runs less one (Helmert's).
#[derive(Debug)]
pub(super) struct Contrast<'a> {
    /// Windows of a run of the condition.
    pub nodes: &'a [Node],
    /// Force there, N.
    pub force_n: Vec<f64>,
    /// N, at its nodes; what the model misses is common to the runs and drops out.
    pub values: DVector<f64>,
    /// What they may differ by besides sensor noise, a column each.
    pub shapes: DMatrix<f64>,
}

/// Estimates the noise from replicates; `None` without any, unless a noise is stated. `curves` is a fit of the base: what it
/// misses is common to the replicates and drops out.
#[must_use]
pub fn estimate(design: &Design, curves: &[Curve], stated_n: Option<f64>) -> Option<Noise> {
    let mut contrasts = contrasts(design, curves);
    if contrasts.is_empty() {
        let sigma_n = stated_n?;
        let sensor = SensorNoise { sigma_n, white: 1.0, correlation_s: TIMES_S[0], relative: 0.0 };
        return Some(Noise {
            source: Source::Stated,
            sensor,
            jitter: UNREPEATED,
            posterior: Posterior::stated(UNREPEATED, STATED_FREEDOM),
            sensor_freedom: STATED_FREEDOM,
        });
    }
    contrasts.extend(of_coupons(design));
    let sensor = most_likely(curves, &contrasts);
    let posterior = Posterior::of(design, curves, &sensor)?;
    let nodes: usize = contrasts.iter().map(|d| d.values.len().saturating_sub(d.shapes.ncols())).sum();
    let sensor_freedom = nodes as f64;
    Some(Noise { source: Source::Replicates, sensor, jitter: posterior.mean(), posterior, sensor_freedom })
}

/// The same where coupons are all that there is.
#[must_use]
pub(super) fn of_coupons_alone(design: &Design, stated_n: Option<f64>) -> Option<Noise> {
    let contrasts = of_coupons(design);
    let posterior = Posterior::stated(UNREPEATED, STATED_FREEDOM);
    let stated = |sigma_n: f64| SensorNoise { sigma_n, white: 1.0, correlation_s: TIMES_S[0], relative: 0.0 };
    let (source, sensor, sensor_freedom) = if contrasts.is_empty() {
        (Source::Stated, stated(stated_n?), STATED_FREEDOM)
    } else {
        let peak_n = contrasts.iter().flat_map(|c| c.force_n.iter().copied()).fold(0.0, f64::max);
        let curve = Curve { force_n: vec![peak_n], slope_n_per_mm: vec![0.0] };
        let freedom: usize = contrasts.iter().map(|c| c.values.len().saturating_sub(c.shapes.ncols())).sum();
        (Source::Replicates, most_likely(&[curve], &contrasts), freedom as f64)
    };
    Some(Noise { source, sensor, jitter: UNREPEATED, posterior, sensor_freedom })
}

/// Runs of each condition that has any, where all of them have the same places.
fn repeats(design: &Design) -> impl Iterator<Item = Vec<usize>> + '_ {
    let runs = move |condition| -> Vec<usize> {
        (0..design.series.len()).filter(move |s| design.series[*s].condition == condition).collect()
    };
    let places = move |s: &usize| design.series[*s].nodes.len();
    let alike =
        move |runs: &Vec<usize>| runs.first().is_some_and(|first| runs.iter().all(|s| places(s) == places(first)));
    (0..design.conditions).map(runs).filter(alike)
}

/// What was measured in a run beyond a model, N.
fn residual(design: &Design, curves: &[Curve], run: usize) -> DVector<f64> {
    let nodes = &design.series[run].nodes;
    DVector::from_fn(nodes.len(), |k, _| nodes[k].force_n - curves[run].force_n[k])
}

/// All contrasts between repeats on more than one spot.
pub(super) fn contrasts<'a>(design: &'a Design, curves: &[Curve]) -> Vec<Contrast<'a>> {
    let mut list = Vec::new();
    for runs in repeats(design) {
        let mut spots: Vec<usize> = runs.iter().map(|s| design.series[*s].spot).collect();
        spots.sort_unstable();
        spots.dedup();
        if spots.len() < 2 {
            continue;
        }
        let first = runs[0];
        let each = runs.iter().map(|s| residual(design, curves, *s)).collect();
        let like = |values: DVector<f64>| Contrast {
            nodes: &design.series[first].nodes,
            force_n: curves[first].force_n.clone(),
            values,
            shapes: curves[first].shapes(&curves[first].force_n),
        };
        list.extend(helmert(each).into_iter().map(like));
    }
    list
}

/// Orthonormal contrasts of some vectors (Helmert's): one less than there are.
fn helmert(each: Vec<DVector<f64>>) -> Vec<DVector<f64>> {
    let mut sum: Option<DVector<f64>> = None;
    let mut list = Vec::new();
    for (before, own) in each.into_iter().enumerate() {
        let n = before as f64;
        list.extend(sum.as_ref().map(|sum| (sum - n * &own) / (n * (n + 1.0)).sqrt()));
        sum = Some(sum.map_or_else(|| own.clone(), |sum| sum + &own));
    }
    list
}

/// The same between coupons that were compressed alike: forces are several times larger there, and so is noise in proportion to them.
fn of_coupons(design: &Design) -> Vec<Contrast<'_>> {
    let coupons: Vec<&Coupon> = design.checks.iter().filter_map(Check::coupon).collect();
    let mut list = Vec::new();
    for (at, first) in coupons.iter().enumerate() {
        if coupons[..at].iter().any(|before| first.repeats(before)) {
            continue;
        }
        let alike = coupons[at..].iter().filter(|other| other.repeats(first));
        let each = alike.map(|own| DVector::from_vec(own.measured())).collect();
        let like = |values: DVector<f64>| Contrast {
            nodes: first.nodes(),
            force_n: first.measured(),
            values,
            shapes: first.shapes(),
        };
        list.extend(helmert(each).into_iter().map(like));
    }
    list
}

/// What the repeats of each condition have in common beyond the model: their sums, scaled to the noise of one run, so that with their contrasts they hold all that was measured. Only where the
/// model leaves no more than noise is it noise; what it may still miss smoothly over the depth is free, as jitter is, and so is what has lifted.
pub(super) fn means<'a>(design: &'a Design, curves: &[Curve]) -> Vec<Contrast<'a>> {
    let of = |runs: Vec<usize>| {
        let series = runs[0];
        let (own, curve) = (&design.series[series], &curves[series]);
        let deepest_mm = own.nodes.iter().map(|n| n.depth_mm).fold(f64::MIN_POSITIVE, f64::max);
        let jitter = curve.shapes(&curve.force_n);
        let smooth = |k: usize, power: i32| curve.force_n[k] * (own.nodes[k].depth_mm / deepest_mm).powi(power);
        let lifted: Vec<usize> = (0..own.nodes.len()).filter(|k| own.nodes[*k].lifted).collect();
        let shapes = DMatrix::from_fn(own.nodes.len(), jitter.ncols() + 2 + lifted.len(), |k, j| {
            match j.checked_sub(jitter.ncols()) {
                None => jitter[(k, j)],
                Some(power @ 0..2) => smooth(k, power as i32 + 1),
                Some(other) => f64::from(u8::from(lifted[other - 2] == k)),
            }
        });
        let sum: DVector<f64> = runs.iter().map(|s| residual(design, curves, *s)).sum();
        Contrast { nodes: &own.nodes, force_n: curve.force_n.clone(), values: sum / (runs.len() as f64).sqrt(), shapes }
    };
    repeats(design).map(of).collect()
}

/// Sensor noise of the largest likelihood over a grid, its level found in closed form, jitter removed as free parameters.
fn most_likely(curves: &[Curve], contrasts: &[Contrast<'_>]) -> SensorNoise {
    // a dozen runs say enough about the shape of a noise
    let few: Vec<&Contrast<'_>> = contrasts.iter().step_by(contrasts.len().div_ceil(12)).collect();
    let peak = curves.iter().flat_map(|c| c.force_n.iter().copied()).fold(0.0, f64::max);
    // at unit level, the relative part in proportion to the noise of a hundredth of the peak
    let unit = |correlation_s, white, part: f64| SensorNoise {
        sigma_n: 1.0,
        white,
        correlation_s,
        relative: part / (0.01 * peak),
    };
    let longest_s = longest_s(contrasts);
    let times = TIMES_S.iter().filter(|time_s| **time_s <= longest_s);
    let grid = times.flat_map(|time_s| {
        WHITE.iter().flat_map(move |white| RELATIVE.iter().map(move |part| unit(*time_s, *white, *part)))
    });
    let grid: Vec<SensorNoise> = grid.collect();
    let unknown = SensorNoise { sigma_n: 1.0, white: 1.0, correlation_s: 0.02, relative: 0.0 };
    refined(contrasts, likeliest(&few, &grid, (f64::INFINITY, unknown)).1)
}

/// Longest correlation time that is told, s: the length of the longest run. Beyond, noise is one random walk whatever its time is, and only how far it has come before the run, which a zero takes away,
/// would tell: of 300 sessions of short runs on three spots each twentieth came out with a time 16 times too long, four times the noise, and effects of 12 standard deviations in it.
fn longest_s(contrasts: &[Contrast<'_>]) -> f64 {
    let of = |nodes: &[Node]| nodes.iter().map(|node| node.length_s).sum::<f64>();
    contrasts.iter().map(|contrast| of(contrast.nodes)).fold(TIMES_S[0], f64::max)
}

/// A noise of the shape of another, at its likeliest level, with twice its negative log-likelihood; the best so far where that is no less likely.
fn likelier(runs: &[&Contrast<'_>], like: &SensorNoise, best: (f64, SensorNoise)) -> (f64, SensorNoise) {
    let unit = SensorNoise { sigma_n: 1.0, relative: like.relative / like.sigma_n, ..*like };
    let found = level(runs, &unit).filter(|(_, deviance)| *deviance < best.0);
    found.map_or(best, |(sigma_n, deviance)| {
        (deviance, SensorNoise { sigma_n, relative: unit.relative * sigma_n, ..unit })
    })
}

/// The likeliest of several; the best so far where none is likelier.
fn likeliest(runs: &[&Contrast<'_>], like: &[SensorNoise], best: (f64, SensorNoise)) -> (f64, SensorNoise) {
    let each: Vec<_> = like.par_iter().map(|noise| likelier(runs, noise, best)).collect();
    each.into_iter().fold(best, |best, own| if own.0 < best.0 { own } else { best })
}

/// The noise between the points of the grid, with all contrasts: a correlation time that is a tenth too long makes a step from one window to the next seem a twentieth too
/// sure, and one that is a third too short a mean over a branch a sixth.
fn refined(contrasts: &[Contrast<'_>], coarse: SensorNoise) -> SensorNoise {
    const STEPS: [f64; 4] = [0.35, 0.18, 0.09, 0.045];
    let all: Vec<&Contrast<'_>> = contrasts.iter().collect();
    let longest_s = longest_s(contrasts);
    let mut best = likelier(&all, &coarse, (f64::INFINITY, coarse));
    if best.0.is_infinite() {
        return coarse;
    }
    for step in STEPS {
        for sign in [1.0, -1.0] {
            let now = best.1;
            let factor = f64::exp(sign * step);
            let tried = [
                SensorNoise { correlation_s: (now.correlation_s * factor).min(longest_s), ..now },
                SensorNoise { relative: now.relative * factor, ..now },
                SensorNoise { white: (now.white + 0.3 * sign * step).clamp(0.0, 1.0), ..now },
            ];
            best = likeliest(&all, &tried, best);
        }
    }
    best.1
}

/// Correlation times, each this factor from the next, and white shares about the likeliest that the noise may have as well: as many on both sides.
const OTHER_TIMES: (f64, i32) = (1.2, 5);
const OTHER_WHITE: (f64, i32) = (0.15, 2);
/// Least weight of one that is kept.
const WEIGHS: f64 = 0.01;

/// What else the noise of the sensor may be, with its weights, of sum 1: a few short runs know its correlation to a factor of two only. `curves` as in [`estimate`].
#[must_use]
pub fn plausible(design: &Design, curves: &[Curve], noise: &Noise) -> Vec<(f64, SensorNoise)> {
    let likeliest = noise.sensor;
    let mut contrasts = contrasts(design, curves);
    contrasts.extend(of_coupons(design));
    let all: Vec<&Contrast<'_>> = contrasts.iter().collect();
    if noise.source == Source::Stated || all.is_empty() {
        return vec![(1.0, likeliest)];
    }
    let (factor, times) = OTHER_TIMES;
    let (share, shares) = OTHER_WHITE;
    let mut white: Vec<f64> =
        (-shares..=shares).map(|k| (likeliest.white + share * f64::from(k)).clamp(0.0, 1.0)).collect();
    white.dedup();
    let others = (-times..=times).flat_map(|k| white.iter().map(move |white| (k, *white)));
    let others: Vec<SensorNoise> = others
        .map(|(k, white)| SensorNoise { correlation_s: likeliest.correlation_s * factor.powi(k), white, ..likeliest })
        .collect();
    let each: Vec<(f64, SensorNoise)> = others
        .par_iter()
        .map(|other| likelier(&all, other, (f64::INFINITY, *other)))
        .filter(|(deviance, _)| deviance.is_finite())
        .collect();
    let least = each.iter().map(|e| e.0).fold(f64::INFINITY, f64::min);
    let weighed = |floor: f64| {
        let sum: f64 = each.iter().map(|e| f64::exp(0.5 * (least - e.0))).filter(|w| *w >= floor).sum();
        let own = each.iter().map(|e| (f64::exp(0.5 * (least - e.0)), e.1)).filter(|(w, _)| *w >= floor);
        own.map(|(w, noise)| (w / sum, noise)).collect::<Vec<_>>()
    };
    let kept = weighed(WEIGHS);
    if kept.is_empty() { vec![(1.0, likeliest)] } else { kept }
}

/// Level of a noise of given shape, and twice its negative log-likelihood.
fn level(runs: &[&Contrast<'_>], unit: &SensorNoise) -> Option<(f64, f64)> {
    let (mut square, mut log, mut count) = (0.0, 0.0, 0.0);
    for run in runs {
        let factor = unit.factor(run.nodes, &run.force_n)?;
        let (rest, information) = without_shapes(run, &factor)?;
        square += rest;
        log += factor.log_determinant() + information;
        count += run.values.len() as f64 - run.shapes.ncols() as f64;
    }
    let variance = square / count;
    (variance > 0.0).then(|| (variance.sqrt(), log + count * variance.ln()))
}

/// Whitened square of what its shapes leave, and the logarithm of their information.
fn without_shapes(run: &Contrast<'_>, factor: &Factor) -> Option<(f64, f64)> {
    let y = factor.whitened(run.values.clone());
    let x = factor.whitened(run.shapes.clone());
    let normal = crate::infer::covariance::Factor::of(&x.tr_mul(&x))?;
    let right = x.tr_mul(&y);
    let fitted = normal.solve(&right).dot(&right);
    let information = normal.log_determinant();
    Some(((y.norm_squared() - fitted).max(0.0), information))
}

#[cfg(test)]
mod tests {
    use super::super::design::Branch;
    use super::*;
    use rand::{Rng, SeedableRng};
    use rand_pcg::Pcg64;

    /// Differences that are a random walk are as likely with any long memory: none longer than the run is told.
    #[test]
    fn no_memory_is_longer_than_the_longest_run() {
        let node = |k: usize| Node {
            time_s: 0.05 * (k as f64 + 0.5),
            length_s: 0.05,
            samples: 5,
            depth_mm: 0.1 * k as f64,
            force_n: 0.0,
            branch: Branch::Loading,
            held_s: 0.0,
            lifted: false,
        };
        let nodes: Vec<Node> = (0..20).map(node).collect();
        let mut chance = Pcg64::seed_from_u64(7);
        let walk = |chance: &mut Pcg64| {
            let mut at = 0.0;
            let mut step = || {
                at += chance.random_range(-1.0..1.0);
                at
            };
            DVector::from_fn(nodes.len(), |_, _| (0..5).map(|_| step()).sum::<f64>() / 5.0)
        };
        let contrast = |values| Contrast {
            nodes: &nodes,
            force_n: vec![0.0; nodes.len()],
            values,
            shapes: DMatrix::from_element(nodes.len(), 1, 1.0),
        };
        let contrasts: Vec<Contrast<'_>> = (0..6).map(|_| contrast(walk(&mut chance))).collect();
        let curve = Curve { force_n: vec![1.0], slope_n_per_mm: vec![0.0] };
        let told = most_likely(&[curve], &contrasts);
        assert!(told.correlation_s > 0.5 && told.correlation_s <= 1.0, "{told:?}");
        let longer = |factor: f64| SensorNoise { correlation_s: factor * told.correlation_s, ..told };
        let all: Vec<&Contrast<'_>> = contrasts.iter().collect();
        let deviance = |noise: SensorNoise| likelier(&all, &noise, (f64::INFINITY, noise)).0;
        // five times as long is as likely: that is why
        assert!((deviance(longer(5.0)) - deviance(told)).abs() < 4.0, "{} {}", deviance(longer(5.0)), deviance(told));
    }

    /// Of unit vectors: rows of an orthonormal matrix that have nothing of what all share.
    #[test]
    fn contrasts_are_orthonormal_and_know_no_mean() {
        let unit = |at: usize| DVector::from_fn(5, |i, _| f64::from(u8::from(i == at)));
        let found = helmert((0..5).map(unit).collect());
        assert_eq!(found.len(), 4);
        for (i, a) in found.iter().enumerate() {
            assert!(a.sum().abs() < 1e-15);
            for (j, b) in found.iter().enumerate() {
                assert!((a.dot(b) - f64::from(u8::from(i == j))).abs() < 1e-15, "{i} {j}");
            }
        }
        assert!(helmert(vec![unit(0)]).is_empty() && helmert(Vec::new()).is_empty());
    }
}
