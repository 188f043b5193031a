//! How large a residual is against what noise alone would make: thresholds from simulated clean twins of the channel.
//!
//! Twins are drawn where they are looked at: what clean data give a set of directions is normal with a covariance that
//! [`Whitening::response`] knows, so that a twin costs as many numbers as there are directions.

use nalgebra::{DMatrix, DVector};
use rand::SeedableRng;
use rand_distr::{ChiSquared, Distribution, StandardNormal};
use rand_pcg::Pcg64;

use super::fit::Fit;
use super::margin::{Margin, Variable};
use super::noise::Noise;
use super::whiten::Whitening;
use crate::diagnose::evidence::{Space, basis, rest_of, visible};
use crate::diagnose::quantile::exceeded;
use crate::infer::eigen;

/// Clean twins that thresholds are taken from.
const TWINS: usize = 2000;
/// Share of clean twins of a channel whose largest statistic lies above a threshold; two statistics are looked at, in up to four channels.
const LEVEL: f64 = 0.004;
/// Seed of the twins: the same data give the same verdict.
const SEED: u64 = 0x6469_7370;

/// Clean twins of a channel as a set of directions (one a column, whitened) sees them: one twin a column.
fn twins(whitening: &Whitening, noise: &Noise, directions: &DMatrix<f64>) -> DMatrix<f64> {
    let response = whitening.response(directions);
    // without a number nothing is drawn, and every threshold is none
    let nothing = || DMatrix::from_element(directions.ncols(), directions.ncols(), f64::NAN);
    let root = eigen::symmetric(response.white.clone()).map_or_else(nothing, |eigen| {
        &eigen.eigenvectors * DMatrix::from_diagonal(&eigen.eigenvalues.map(|v| v.max(0.0).sqrt()))
    });
    let mut chance = Pcg64::seed_from_u64(SEED);
    let mut out = DMatrix::zeros(directions.ncols(), TWINS);
    for mut column in out.column_iter_mut() {
        let mut factor = |freedom: f64| {
            let drawn = ChiSquared::new(freedom).map_or(freedom, |chi| chi.sample(&mut chance));
            (freedom / drawn.max(0.05 * freedom)).sqrt()
        };
        let (sensor, kinds) = (factor(noise.sensor_freedom), [(); 3].map(|()| factor(noise.freedom)));
        let mut normal = || -> f64 { StandardNormal.sample(&mut chance) };
        let white = DVector::from_fn(root.ncols(), |_, _| sensor * normal());
        let jitter = DVector::from_fn(response.jitter.ncols(), |k, _| kinds[k % 3] * normal());
        let law = DVector::from_fn(response.law.ncols(), |_, _| normal());
        column.copy_from(&(&root * white + &response.jitter * jitter + &response.law * law));
    }
    out
}

/// Margins with the largest reading that noise may give.
#[derive(Debug, Clone)]
pub struct Panel {
    raw: DMatrix<f64>,
    variables: Vec<Variable>,
    /// What the largest reading exceeds in one clean twin of 250.
    pub threshold: f64,
}

/// Whether a fit leaves more than noise in one channel.
pub type Adequacy = crate::diagnose::evidence::Adequacy<Variable>;

/// Directions less what parameters take up, of unit length; zero where nothing is left.
fn orthogonal(raw: &DMatrix<f64>, parameters: &DMatrix<f64>) -> DMatrix<f64> {
    let mut rest = rest_of(raw, &basis(parameters));
    for (j, whole) in raw.column_iter().enumerate() {
        let (own, before) = (rest.column(j).norm(), whole.norm());
        // a direction that the parameters take up whole says nothing
        rest.column_mut(j).scale_mut(if own > 0.03 * before { 1.0 / own } else { 0.0 });
    }
    rest
}

impl Panel {
    /// Of margins, with the threshold after a fit of the base.
    #[must_use]
    pub fn new(margins: &[Margin], base: &Fit, whitening: &Whitening, noise: &Noise) -> Self {
        let columns: Vec<DVector<f64>> = margins.iter().map(|m| m.direction.clone()).collect();
        let raw =
            if columns.is_empty() { DMatrix::zeros(whitening.residuals(), 0) } else { DMatrix::from_columns(&columns) };
        let directions = orthogonal(&raw, &base.jacobian);
        let drawn = twins(whitening, noise, &directions);
        let scatter: Vec<f64> = whitening.response(&directions).variances().iter().map(|v| v.sqrt()).collect();
        let largest = drawn.column_iter().map(|twin| {
            let each = twin.iter().zip(&scatter).filter(|(_, s)| **s > 0.0);
            each.map(|(v, s)| v.abs() / s).fold(0.0, f64::max)
        });
        Self {
            raw,
            variables: margins.iter().map(|m| m.variable).collect(),
            threshold: exceeded(largest.collect(), LEVEL),
        }
    }

    /// What a fit leaves. `errors`: what its effects may be wrong by, one unit of variance a column, whitened.
    #[must_use]
    pub fn read(&self, fit: &Fit, whitening: &Whitening, errors: &DMatrix<f64>) -> Adequacy {
        let directions = orthogonal(&self.raw, &fit.jacobian);
        let values = directions.tr_mul(&fit.residual);
        let variances = whitening.response(&directions).variances();
        let along = if errors.ncols() == 0 { DMatrix::zeros(values.len(), 0) } else { directions.tr_mul(errors) };
        let readings: Vec<f64> = (0..values.len())
            .map(|j| {
                let variance = variances[j] + along.row(j).norm_squared();
                if variances[j] > 0.0 { values[j] / variance.sqrt() } else { 0.0 }
            })
            .collect();
        Adequacy::told(readings, self.threshold, self.variables.iter().copied())
    }
}

/// Subspaces, each of which an effect could move the data in, with what they hold of clean twins.
#[derive(Debug, Clone)]
pub struct Spaces {
    each: Vec<Space>,
    /// What the largest reading exceeds in one clean twin of 250.
    pub threshold: f64,
}

impl Spaces {
    /// One space a candidate: its signatures less what the parameters take up.
    #[must_use]
    pub fn new(signatures: &[DMatrix<f64>], base: &Fit, whitening: &Whitening, noise: &Noise) -> Self {
        let explained = basis(&base.jacobian);
        let bases: Vec<DMatrix<f64>> =
            signatures.iter().map(|signature| basis(&visible(signature, &rest_of(signature, &explained)))).collect();
        let columns: Vec<DVector<f64>> =
            bases.iter().flat_map(|b| b.column_iter().map(|c| c.into_owned()).collect::<Vec<_>>()).collect();
        if columns.is_empty() {
            return Self {
                each: bases.into_iter().map(|basis| Space { basis, mean: 0.0 }).collect(),
                threshold: f64::INFINITY,
            };
        }
        let drawn = twins(whitening, noise, &DMatrix::from_columns(&columns));
        let (mut each, mut largest, mut row) = (Vec::new(), vec![f64::NEG_INFINITY; drawn.ncols()], 0);
        for basis in bases {
            let own = drawn.rows(row, basis.ncols());
            row += basis.ncols();
            let squares: Vec<f64> = own.column_iter().map(|c| c.norm_squared()).collect();
            let mean = squares.iter().sum::<f64>() / squares.len() as f64;
            let space = Space { basis, mean };
            for (most, square) in largest.iter_mut().zip(&squares) {
                *most = most.max(space.standard(*square));
            }
            each.push(space);
        }
        Self { each, threshold: exceeded(largest, LEVEL) }
    }

    /// Reading of a residual in one space: about unit normal for a clean one.
    #[must_use]
    pub fn read(&self, at: usize, residual: &DVector<f64>) -> f64 {
        self.each[at].read(residual)
    }

    /// The reading that an improvement of the sum of squares corresponds to.
    #[must_use]
    pub fn of_gain(&self, at: usize, gain: f64) -> f64 {
        self.each[at].standard(gain)
    }
}
