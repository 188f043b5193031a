//! Scatter of contact point, gain and zero between spots and runs: its posterior, from what repeats of one condition differ by.
//!
//! Every run's difference from the model is reduced to the amounts of three shapes that fit it best (a shifted contact, a gain, a zero), with
//! their covariance under sensor noise; what the model misses is common to repeats and goes with their means. The amounts that are left
//! are normal with a covariance that is linear in the three variances, which makes their likelihood exact (REML).

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

use super::design::Design;
use super::gradient::{Gradient, Seen, Slopes};
use super::scatter::{Curve, Jitter, SensorNoise};

/// What jitter is expected before anything is measured, with the weight of one degree of freedom: a contact is found to a
/// hundredth of a millimetre, a foam is uniform to a percent from spot to spot.
pub const EXPECTED: Jitter = Jitter { contact_mm: 0.01, gain: 0.007, zero_n: 0.0 };
const EXPECTED_FREEDOM: f64 = 1.0;
/// Standard deviations that are tried: of a contact (mm) and of a gain, each 1.45 times the one before; of a zero, in parts of the sensor noise.
const CONTACTS_MM: (f64, usize) = (0.001, 17);
const GAINS: (f64, usize) = (0.0007, 15);
const STEP: f64 = 1.45;
const ZEROS: [f64; 7] = [0.0, 0.05, 0.1, 0.2, 0.4, 0.8, 1.6];
/// Where the gain stands among the three amounts.
const GAIN: usize = 1;
/// Runs of one group of spots that are looked at, at most: a hundred repeats say no more about a variance than is needed.
const MOST_RUNS: usize = 24;

/// A posterior over a grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Posterior {
    /// Weight, falling, of sum 1, and standard deviations.
    pub grid: Vec<(f64, Jitter)>,
    /// Differences between spots that it rests on, with those that the prior counts for.
    pub freedom: f64,
    /// How the gain goes with the place on each specimen, where places are known.
    pub gradients: Vec<Gradient>,
}

/// Amounts of the three shapes in one run.
struct Amounts {
    series: usize,
    found: Vector3<f64>,
    variance: Matrix3<f64>,
}

/// Differences between repeats of one group of spots, and what each variance contributes to their covariance.
struct Group {
    values: DVector<f64>,
    sensor: DMatrix<f64>,
    of: [DMatrix<f64>; 3],
    /// What a gain that grows by one a millimetre along either direction of the specimen adds to the values; nothing where a place is unknown.
    places: DMatrix<f64>,
    specimen: usize,
    spots: usize,
}

impl Posterior {
    /// From replicates; none without any.
    #[must_use]
    pub fn of(design: &Design, curves: &[Curve], sensor: &SensorNoise) -> Option<Self> {
        Self::expecting(&EXPECTED, design, curves, sensor)
    }

    /// The same where another jitter of contact and gain is expected beforehand.
    #[must_use]
    pub fn expecting(before: &Jitter, design: &Design, curves: &[Curve], sensor: &SensorNoise) -> Option<Self> {
        let groups = groups(design, curves, sensor);
        if groups.is_empty() {
            return None;
        }
        let ladder = |(first, count): (f64, usize)| (0..count).map(move |k| first * STEP.powi(k as i32));
        let mut grid = Vec::new();
        let mut slopes = Slopes::of(groups.iter().map(|group| (group.specimen, &group.places)));
        for contact_mm in ladder(CONTACTS_MM) {
            for gain in ladder(GAINS) {
                for part in ZEROS {
                    let jitter = Jitter { contact_mm, gain, zero_n: part * sensor.sigma_n };
                    let expected = expectation(contact_mm, before.contact_mm) + expectation(gain, before.gain);
                    let seen: Option<Vec<Seen>> = groups.iter().map(|group| group.seen(&jitter)).collect();
                    let Some(seen) = seen else { continue };
                    let log = expected + seen.iter().map(|one| one.log_likelihood).sum::<f64>();
                    grid.push((log, jitter));
                    slopes.weigh(log, &seen);
                }
            }
        }
        let freedom = groups.iter().map(|group| group.spots as f64 - 1.0).sum::<f64>() + EXPECTED_FREEDOM;
        let gradients = slopes.gradients();
        normalized(grid).map(|grid| Self { grid, freedom, gradients })
    }

    /// Where only a noise is stated: a scatter with the uncertainty of some degrees of freedom.
    #[must_use]
    pub fn stated(jitter: Jitter, freedom: f64) -> Self {
        let deviation = (0.5 / freedom).sqrt();
        let grid = (-4..=4).map(|k| {
            let z = 0.5 * f64::from(k);
            let factor = (z * deviation).exp();
            let Jitter { contact_mm, gain, zero_n } = jitter;
            let jitter = Jitter { contact_mm: factor * contact_mm, gain: factor * gain, zero_n: factor * zero_n };
            (-0.5 * z * z, jitter)
        });
        Self { grid: normalized(grid.collect()).unwrap_or_default(), freedom, gradients: Vec::new() }
    }

    /// Standard deviations whose squares are the posterior's means.
    #[must_use]
    pub fn mean(&self) -> Jitter {
        let mean =
            |of: fn(&Jitter) -> f64| self.grid.iter().map(|(w, jitter)| w * of(jitter).powi(2)).sum::<f64>().sqrt();
        Jitter { contact_mm: mean(|j| j.contact_mm), gain: mean(|j| j.gain), zero_n: mean(|j| j.zero_n) }
    }

    /// How likely it is that spots differ in gain by more than this.
    #[must_use]
    pub fn gain_above(&self, gain: f64) -> f64 {
        self.grid.iter().filter(|(_, jitter)| jitter.gain > gain).map(|(weight, _)| weight).sum()
    }

    /// The point of the grid that a number between 0 and 1 falls on.
    #[must_use]
    pub fn at(&self, share: f64) -> Option<&Jitter> {
        let mut sum = 0.0;
        let found = self.grid.iter().find(|(weight, _)| {
            sum += weight;
            sum >= share
        });
        found.or(self.grid.last()).map(|(_, jitter)| jitter)
    }
}

/// Logarithm of the prior's density over the logarithm of a standard deviation: a scaled inverse chi-square.
fn expectation(sigma: f64, expected: f64) -> f64 {
    let ratio = expected / sigma;
    EXPECTED_FREEDOM * (ratio.ln() - 0.5 * ratio * ratio)
}

/// Weights from logarithms, the heaviest first, without what weighs nothing.
fn normalized(mut grid: Vec<(f64, Jitter)>) -> Option<Vec<(f64, Jitter)>> {
    grid.sort_by(|a, b| b.0.total_cmp(&a.0));
    let top = grid.first()?.0;
    grid.iter_mut().for_each(|(log, _)| *log = (*log - top).exp());
    grid.retain(|(weight, _)| *weight > 1e-6);
    let sum: f64 = grid.iter().map(|(weight, _)| weight).sum();
    grid.iter_mut().for_each(|(weight, _)| *weight /= sum);
    Some(grid)
}

fn groups(design: &Design, curves: &[Curve], sensor: &SensorNoise) -> Vec<Group> {
    let amounts = amounts(design, curves, sensor);
    // spots that share a condition belong together
    let mut name: Vec<usize> = (0..design.spots).collect();
    let of = |a: &Amounts| &design.series[a.series];
    for a in &amounts {
        for b in amounts.iter().filter(|b| of(b).condition == of(a).condition) {
            let (from, to) = (name[of(a).spot], name[of(b).spot]);
            name.iter_mut().filter(|n| **n == from).for_each(|n| *n = to);
        }
    }
    let mut names: Vec<usize> = amounts.iter().map(|a| name[of(a).spot]).collect();
    names.sort_unstable();
    names.dedup();
    let members = |group: usize| amounts.iter().filter(|a| name[of(a).spot] == group).collect::<Vec<_>>();
    names.into_iter().filter_map(|group| Group::of(design, &members(group))).collect()
}

/// Amounts of every run that another spot repeats.
fn amounts(design: &Design, curves: &[Curve], sensor: &SensorNoise) -> Vec<Amounts> {
    let repeated = |s: usize| {
        let own = &design.series[s];
        design.series.iter().any(|other| own.is_like(other) && other.spot != own.spot)
    };
    (0..design.series.len()).filter(|s| repeated(*s)).filter_map(|s| Amounts::of(design, curves, sensor, s)).collect()
}

impl Amounts {
    fn of(design: &Design, curves: &[Curve], sensor: &SensorNoise, series: usize) -> Option<Self> {
        let (nodes, curve) = (&design.series[series].nodes, &curves[series]);
        let factor = sensor.factor(nodes, &curve.force_n)?;
        let residual = DVector::from_fn(nodes.len(), |k, _| nodes[k].force_n - curve.force_n[k]);
        let y = factor.whitened(residual);
        let x = factor.whitened(curve.shapes(&design.smooth_n(series, &curve.force_n)));
        let normal: Matrix3<f64> = x.tr_mul(&x).fixed_view::<3, 3>(0, 0).into_owned();
        let variance = normal.try_inverse()?;
        let right: Vector3<f64> = x.tr_mul(&y).fixed_rows::<3>(0).into_owned();
        Some(Self { series, found: variance * right, variance })
    }
}

impl Group {
    /// Of runs on spots that share conditions; none where nothing repeats.
    fn of(design: &Design, runs: &[&Amounts]) -> Option<Self> {
        let runs: Vec<&Amounts> = runs.iter().copied().step_by(runs.len().div_ceil(MOST_RUNS).max(1)).collect();
        let spot = |i: usize| design.series[runs[i].series].spot;
        let contrasts = contrasts(&runs.iter().map(|a| design.series[a.series].condition).collect::<Vec<_>>());
        if contrasts.ncols() == 0 {
            return None;
        }
        // a difference for every shape: the place of one in all
        let count = contrasts.ncols();
        let mut values = DVector::zeros(3 * count);
        let mut sensor = DMatrix::zeros(3 * count, 3 * count);
        let mut of = [(); 3].map(|()| DMatrix::zeros(3 * count, 3 * count));
        for a in 0..count {
            for k in 0..3 {
                values[3 * a + k] = (0..runs.len()).map(|i| contrasts[(i, a)] * runs[i].found[k]).sum();
            }
            for b in 0..count {
                for (i, run) in runs.iter().enumerate() {
                    let both = contrasts[(i, a)] * contrasts[(i, b)];
                    let mut block = sensor.fixed_view_mut::<3, 3>(3 * a, 3 * b);
                    block += both * run.variance;
                    of[2][(3 * a + 2, 3 * b + 2)] += both;
                    let alike: f64 = (0..runs.len()).filter(|j| spot(*j) == spot(i)).map(|j| contrasts[(j, b)]).sum();
                    for (k, part) in of.iter_mut().take(2).enumerate() {
                        part[(3 * a + k, 3 * b + k)] += contrasts[(i, a)] * alike;
                    }
                }
            }
        }
        let mut places = DMatrix::zeros(3 * count, 2);
        let known: Option<Vec<[f64; 2]>> = runs.iter().map(|run| design.series[run.series].place_mm).collect();
        for (i, place) in known.iter().flatten().enumerate() {
            for a in 0..count {
                (0..2).for_each(|k| places[(3 * a + GAIN, k)] += contrasts[(i, a)] * place[k]);
            }
        }
        let specimen = design.series[runs[0].series].specimen;
        let mut spots: Vec<usize> = (0..runs.len()).map(spot).collect();
        spots.sort_unstable();
        spots.dedup();
        Some(Self { values, sensor, of, places, specimen, spots: spots.len() })
    }

    /// What the values say of a scatter, and of a gain over the place beside it.
    fn seen(&self, jitter: &Jitter) -> Option<Seen> {
        let mut covariance = self.sensor.clone();
        for (part, sigma) in self.of.iter().zip([jitter.contact_mm, jitter.gain, jitter.zero_n]) {
            covariance.zip_apply(part, |sum, one| *sum += sigma * sigma * one);
        }
        let factor = covariance.cholesky()?;
        let lower = factor.l_dirty();
        let white = lower.solve_lower_triangular(&self.values)?;
        let slopes = lower.solve_lower_triangular(&self.places)?;
        Some(Seen::of(&white, &slopes, -lower.diagonal().map(f64::ln).sum()))
    }
}

/// Orthonormal differences (columns) between runs of equal condition.
fn contrasts(conditions: &[usize]) -> DMatrix<f64> {
    let mut columns: Vec<DVector<f64>> = Vec::new();
    for at in 1..conditions.len() {
        let before: Vec<usize> = (0..at).filter(|i| conditions[*i] == conditions[at]).collect();
        if before.is_empty() {
            continue;
        }
        // Helmert: the run less the mean of those before it
        let count = before.len() as f64;
        let scale = (1.0 / (1.0 + 1.0 / count)).sqrt();
        let mut column = DVector::zeros(conditions.len());
        column[at] = scale;
        before.iter().for_each(|i| column[*i] = -scale / count);
        columns.push(column);
    }
    if columns.is_empty() { DMatrix::zeros(conditions.len(), 0) } else { DMatrix::from_columns(&columns) }
}
