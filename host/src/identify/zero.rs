//! The zero of the force: read from the approach where one is recorded, free within a prior where none is.

use crate::experiment::signal::{averaged, extent, median, noise_of};

use super::noise::correlated_samples;

/// Fewest readings before contact that show the zero, and fewest that show a slope.
const LEAST: usize = 6;
const LEAST_FOR_SLOPE: usize = 20;
/// A zero or a slope that differs from nothing by this many standard errors is there.
const SIGNIFICANT: f64 = 5.0;
/// A zero below this share of the largest force changes nothing that matters.
const LEAST_SHARE: f64 = 1e-3;
/// The contact is looked for where the force has risen by less than this share, or this many times its noise: farther up no force
/// is a power of depth.
const RISEN: f64 = 0.1;
const RISEN_SIGMA: f64 = 10.0;
/// Readings count as before contact this share of that way above it.
const MARGIN: f64 = 0.1;
/// Readings that a search for the contact takes, and places that it tries.
const SEARCHED: usize = 1500;
const PLACES: usize = 60;
/// Standard deviation of a zero that nothing shows, as a share of the largest force: machines tare at a preload of a few percent.
pub const PRIOR_SHARE: f64 = 0.05;
/// A force counts as tared at the beginning below this share of the largest.
const TARED_SHARE: f64 = 0.01;
/// Readings at the beginning that say where the force begins.
const FIRST: usize = 3;

/// What the sensor reads before contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Approach {
    /// Force in the middle of the approach, N, and its standard error.
    pub offset_n: (f64, f64),
    /// Slope, N/mm, and its standard error; nothing where none is seen.
    pub slope_n_per_mm: Option<(f64, f64)>,
    /// Depth in the middle of the approach, mm.
    pub middle_mm: f64,
    /// Readings before contact.
    pub readings: usize,
}

impl Approach {
    /// Reads the zero of a run that begins before contact: depths and forces from its beginning to its deepest, and the exponent
    /// with which force begins over depth. None where fewer than six readings lie before contact.
    #[must_use]
    pub fn of(depth_mm: &[f64], force_n: &[f64], exponent: f64) -> Option<Self> {
        let first = median(force_n.get(..LEAST)?.iter().copied());
        let highest = force_n.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let least = (RISEN * (highest - first)).max(RISEN_SIGMA * noise_of(force_n));
        let risen = force_n.iter().position(|force| force - first > least)?;
        let stride = risen.div_ceil(SEARCHED).max(1);
        let thinned = |values: &[f64]| -> Vec<f64> { values[..risen].iter().step_by(stride).copied().collect() };
        let (depths, forces) = (thinned(depth_mm), thinned(force_n));
        let above = |contact: f64| contact - MARGIN * (depth_mm[risen] - contact);
        let plain = Self::with(depth_mm, force_n, above(contact(&depths, &forces, exponent, false)?))?;
        let sloped = match plain.slope_n_per_mm {
            Some(_) => Self::with(depth_mm, force_n, above(contact(&depths, &forces, exponent, true)?)),
            None => None,
        };
        Some(sloped.unwrap_or(plain))
    }

    /// From the readings before a contact, mm.
    fn with(depth_mm: &[f64], force_n: &[f64], contact_mm: f64) -> Option<Self> {
        let readings = depth_mm.iter().position(|depth| *depth > contact_mm)?;
        if readings < LEAST {
            return None;
        }
        let together = readings.div_ceil(SEARCHED);
        let (x, y) = (averaged(&depth_mm[..readings], together), averaged(&force_n[..readings], together));
        let count = x.len() as f64;
        let mean = |values: &[f64]| values.iter().sum::<f64>() / count;
        let (middle_mm, offset) = (mean(&x), mean(&y));
        let sxx: f64 = x.iter().map(|x| (x - middle_mm).powi(2)).sum();
        let sxy: f64 = x.iter().zip(&y).map(|(x, y)| (x - middle_mm) * (y - offset)).sum();
        let slope = if sxx > 0.0 { sxy / sxx } else { 0.0 };
        let error = |slope: f64| {
            let left: Vec<f64> = x.iter().zip(&y).map(|(x, y)| y - offset - slope * (x - middle_mm)).collect();
            let variance = left.iter().map(|r| r * r).sum::<f64>() / (count - 2.0);
            (variance * correlated_samples(&[left], 1.0)).sqrt()
        };
        let with_slope = error(slope);
        let slope_error = with_slope / sxx.sqrt();
        let is_sloped = readings >= LEAST_FOR_SLOPE && slope.abs() > SIGNIFICANT * slope_error;
        let sigma = if is_sloped { with_slope } else { error(0.0) };
        Some(Self {
            offset_n: (offset, sigma / count.sqrt()),
            slope_n_per_mm: is_sloped.then_some((slope, slope_error)),
            middle_mm,
            readings,
        })
    }

    /// True where the sensor shows a force before contact, beside the largest of the run, N.
    #[must_use]
    pub fn is_off(&self, largest_n: f64) -> bool {
        let (offset, error) = self.offset_n;
        let least = LEAST_SHARE * largest_n.abs();
        self.slope_n_per_mm.is_some() || offset.abs() > (SIGNIFICANT * error).max(least)
    }

    /// What the sensor reads without a contact at a depth, N.
    #[must_use]
    pub fn at(&self, depth_mm: f64) -> f64 {
        self.offset_n.0 + self.slope_n_per_mm.map_or(0.0, |slope| slope.0 * (depth_mm - self.middle_mm))
    }

    /// What may be left of it over depths: a zero, and a slope where one was seen.
    #[must_use]
    pub fn unsure(&self, depth_mm: &[f64]) -> Unsure {
        let zero = vec![self.offset_n.1; depth_mm.len()];
        let slope = self
            .slope_n_per_mm
            .map(|(_, error)| depth_mm.iter().map(|depth| error * (depth - self.middle_mm)).collect::<Vec<f64>>());
        Unsure::of(std::iter::once(zero).chain(slope).collect())
    }
}

impl std::fmt::Display for Approach {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (offset, error) = self.offset_n;
        write!(
            f,
            "force zero: the sensor reads {offset:.4} N before contact (+- {error:.4}, {} readings",
            self.readings
        )?;
        if let Some((slope, error)) = self.slope_n_per_mm {
            write!(f, ", and {slope:.4} +- {error:.4} N more each mm")?;
        }
        write!(f, "); it is taken off")
    }
}

/// The zero of a run that begins in contact at a force that reads nothing, as machines tare at a preload; nothing where a force begins
/// the run, or its noise is all that it shows.
#[must_use]
pub fn unseen(depth_mm: &[f64], force_n: &[f64]) -> Unsure {
    let largest = force_n.iter().copied().fold(0.0, f64::max);
    let begin = force_n.iter().take(FIRST).sum::<f64>() / force_n.len().clamp(1, FIRST) as f64;
    if begin.abs() > (3.0 * noise_of(force_n)).max(TARED_SHARE * largest) {
        return Unsure::default();
    }
    Unsure::of(vec![vec![PRIOR_SHARE * largest; depth_mm.len()]])
}

/// Smooth errors of the force of a run that a fit knows only by a prior, as orthonormal columns over its samples.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Unsure {
    /// Column, and the variance of its amount, N2.
    columns: Vec<(Vec<f64>, f64)>,
}

impl Unsure {
    /// From columns of one standard deviation each, N.
    fn of(columns: Vec<Vec<f64>>) -> Self {
        let (Some(rows), count) = (columns.first().map(Vec::len), columns.len()) else { return Self::default() };
        let all = nalgebra::DMatrix::from_fn(rows, count, |i, j| columns[j][i]);
        let own = all.clone().svd(true, false);
        let Some(u) = own.u else { return Self::default() };
        let column = |j: usize| (u.column(j).iter().copied().collect(), own.singular_values[j].powi(2));
        Self { columns: (0..own.singular_values.len()).map(column).collect() }
    }

    /// True where everything is known.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.columns.is_empty()
    }

    /// The columns at some of the samples, each sample standing for `of` around it.
    #[must_use]
    pub fn at(&self, samples: impl Iterator<Item = usize> + Clone, of: usize) -> Self {
        let root = (of as f64).sqrt();
        let thin =
            |(column, variance): &(Vec<f64>, f64)| (samples.clone().map(|at| root * column[at]).collect(), *variance);
        Self { columns: self.columns.iter().map(thin).collect() }
    }

    /// The same with every variance times a factor.
    #[must_use]
    pub fn scaled(mut self, factor: f64) -> Self {
        self.columns.iter_mut().for_each(|(_, variance)| *variance *= factor);
        self
    }

    /// Turns differences into ones that are independent: their square sum, over `variance_n2` each, is that with the best amounts of the
    /// columns and the price of these.
    pub fn whiten(&self, values: &mut [f64], variance_n2: f64) {
        self.apply(values, |its| 1.0 - 1.0 / (1.0 + its / variance_n2).sqrt());
    }

    /// Takes out of the differences what of them is most likely such an error.
    pub fn take_out(&self, values: &mut [f64], variance_n2: f64) {
        self.apply(values, |its| its / (its + variance_n2));
    }

    /// What of the differences is most likely such an error, N.
    #[must_use]
    pub fn likely(&self, values: &[f64], variance_n2: f64) -> Vec<f64> {
        let mut left = values.to_vec();
        self.take_out(&mut left, variance_n2);
        values.iter().zip(left).map(|(value, left)| value - left).collect()
    }

    fn apply(&self, values: &mut [f64], share: impl Fn(f64) -> f64) {
        for (column, its) in &self.columns {
            let along: f64 = column.iter().zip(values.iter()).map(|(q, v)| q * v).sum();
            let off = share(*its) * along;
            column.iter().zip(values.iter_mut()).for_each(|(q, v)| *v -= off * q);
        }
    }
}

/// Where force begins to rise like a power of depth from a constant, or from a line; the least squares over places.
fn contact(depth_mm: &[f64], force_n: &[f64], exponent: f64, sloped: bool) -> Option<f64> {
    let (low, high) = extent(depth_mm.iter().copied());
    if depth_mm.len() < LEAST || high <= low {
        return None;
    }
    let left = |contact: f64| left_over(depth_mm, force_n, contact, exponent, sloped);
    let scan = |from: f64, to: f64| {
        let place = |i: usize| from + (to - from) * i as f64 / PLACES as f64;
        let all = (0..=PLACES).map(place).map(|c| (c, left(c)));
        all.min_by(|a, b| a.1.total_cmp(&b.1)).map(|best| best.0)
    };
    let step = (high - low) / PLACES as f64;
    let coarse = scan(low, high)?;
    scan((coarse - step).max(low), (coarse + step).min(high))
}

/// Square sum that the best constant (and line) with the best power beyond a contact leaves, N2.
fn left_over(depth_mm: &[f64], force_n: &[f64], contact_mm: f64, exponent: f64, sloped: bool) -> f64 {
    let middle = depth_mm.iter().sum::<f64>() / depth_mm.len().max(1) as f64;
    let row =
        |depth: f64| [1.0, (depth - contact_mm).max(0.0).powf(exponent), if sloped { depth - middle } else { 0.0 }];
    let (mut normal, mut right, mut square) = (nalgebra::Matrix3::zeros(), nalgebra::Vector3::zeros(), 0.0);
    for (depth, force) in depth_mm.iter().zip(force_n) {
        let row = nalgebra::Vector3::from(row(*depth));
        normal += row * row.transpose();
        right += row * *force;
        square += force * force;
    }
    // A column of nothing counts nothing.
    for i in 0..3 {
        if normal[(i, i)] <= 0.0 {
            normal[(i, i)] = 1.0;
        }
    }
    match normal.cholesky() {
        Some(factor) => square - right.dot(&factor.solve(&right)),
        None => f64::INFINITY,
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;
    use rand::{Rng, SeedableRng};
    use rand_pcg::Pcg64;

    /// A ball from 2 mm above to 4 mm, with an offset (N) and a slope (N/mm); noise of 3 mN.
    fn press(seed: u64, from_mm: f64, offset: f64, slope: f64) -> (Vec<f64>, Vec<f64>) {
        let mut chance = Pcg64::seed_from_u64(seed);
        let depth: Vec<f64> = (0..120).map(|i| from_mm + (4.0 - from_mm) * f64::from(i) / 119.0).collect();
        let mut noise = || 0.003 * (0..12).map(|_| chance.random::<f64>() - 0.5).sum::<f64>();
        let force = depth.iter().map(|d| 0.3 * d.max(0.0).powf(1.5) + offset + slope * d + noise()).collect();
        (depth, force)
    }

    /// The zero is found within its own error, and nothing is taken off where nothing is there.
    #[test]
    fn the_approach_shows_the_zero() {
        let (mut inside, mut off) = (0, 0);
        for seed in 0..200 {
            let (depth, force) = press(seed, -2.0, 0.1, 0.0);
            let found = Approach::of(&depth, &force, 1.5).unwrap();
            assert!(found.is_off(2.5) && found.slope_n_per_mm.is_none(), "seed {seed}: {found:?}");
            inside += usize::from((found.offset_n.0 - 0.1).abs() < 2.0 * found.offset_n.1);
            let (depth, force) = press(seed, -2.0, 0.0, 0.0);
            off += usize::from(Approach::of(&depth, &force, 1.5).unwrap().is_off(2.5));
        }
        // 95 % of 200, three standard deviations of its scatter below; five standard errors are one in a million
        assert!(inside >= 180, "{inside}");
        assert_eq!(off, 0);
    }

    #[test]
    fn a_slope_is_followed_and_a_run_that_begins_in_contact_has_no_approach() {
        for seed in 0..50 {
            let (depth, force) = press(seed, -2.0, -0.05, 0.02);
            let found = Approach::of(&depth, &force, 1.5).unwrap();
            let (slope, error) = found.slope_n_per_mm.unwrap();
            assert!((slope - 0.02).abs() < 4.0 * error, "seed {seed}: {found:?}");
            assert!((found.at(4.0) - 0.03).abs() < 0.02, "seed {seed}: {found:?}");
            let (depth, force) = press(seed, 0.3, -0.05, 0.0);
            assert_eq!(Approach::of(&depth, &force, 1.5), None, "seed {seed}");
            assert!(!unseen(&depth, &force).is_empty());
            // begun at a trigger force, tared in the air
            let (depth, force) = press(seed, 0.6, 0.0, 0.0);
            assert!(unseen(&depth, &force).is_empty());
        }
    }

    /// Whitened squares are those of the best amounts with their price.
    #[test]
    fn whitening_is_the_best_amount_with_its_price() {
        let depth: Vec<f64> = (0..50).map(|i| 0.1 * f64::from(i)).collect();
        let unsure = Unsure::of(vec![vec![0.2; 50], depth.iter().map(|d| 0.05 * d).collect()]);
        let values: Vec<f64> = depth.iter().map(|d| 0.3 - 0.1 * d + (7.0 * d).sin()).collect();
        let variance = 0.04;
        let mut white = values.clone();
        unsure.whiten(&mut white, variance);
        let square = white.iter().map(|v| v * v).sum::<f64>() / variance;
        let price = |zero: f64, slope: f64| {
            let left = |(d, v): (&f64, &f64)| (v - 0.2 * zero - 0.05 * slope * d).powi(2);
            depth.iter().zip(&values).map(left).sum::<f64>() / variance + zero * zero + slope * slope
        };
        let likely = unsure.likely(&values, variance);
        let (zero, slope) = (likely[0] / 0.2, (likely[49] - likely[0]) / 4.9 / 0.05);
        assert!((price(zero, slope) / square - 1.0).abs() < 1e-9, "{} {square}", price(zero, slope));
        for (by_zero, by_slope) in [(0.01, 0.0), (-0.01, 0.0), (0.0, 0.01), (0.0, -0.01)] {
            assert!(price(zero + by_zero, slope + by_slope) > square);
        }
    }
}
