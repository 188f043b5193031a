//! How large a residual is against what noise alone would make: thresholds from simulated clean twins of the data set.

use nalgebra::{DMatrix, DVector};
use rand::Rng;
use rand_distr::{ChiSquared, Distribution, StandardNormal};
use rand_pcg::Pcg64;
use rayon::prelude::*;

use super::fit::Fit;
use super::margin::{Margin, Variable};
use super::noise::{Jitter, Noise};
use super::quantile::exceeded;
use super::spike::{self, SPIKE};
use super::whiten::Whitening;
use crate::infer::product::inner;

/// Clean twins that thresholds are taken from.
pub const TWINS: usize = 1000;
/// Share of clean twins whose largest statistic lies above a threshold; two statistics are looked at.
const LEVEL: f64 = 0.005;
/// Share of the worst reading from which on a variable is told.
const SHADOW: f64 = 0.4;
/// State that every twin's chance begins at, each on a stream of its own: the same data give the same verdict, on any number of cores.
const SEED: u128 = 0x7061_6c70;

/// Directions made orthogonal to parameters, with what they measure in clean twins.
#[derive(Debug)]
pub struct Gauge {
    /// One column a direction, unit length, orthogonal to the parameters.
    directions: DMatrix<f64>,
    /// Standard deviation of each over clean twins.
    scatter: Vec<f64>,
    /// What the largest of their magnitudes, in units of its scatter, exceeds in one clean twin of a hundred.
    pub threshold: f64,
}

/// Draws of whitened residuals of clean twins, with the uncertainty of the noise estimate. `plausible` is what else the noise of the sensor may be: weights, of sum 1, and
/// [`Whitening::colours`]; where there is none it is what it was estimated to be.
#[must_use]
pub fn twins(
    whitening: &Whitening,
    noise: &Noise,
    plausible: &[(f64, Vec<DMatrix<f64>>)],
    used: &[bool],
    count: usize,
) -> DMatrix<f64> {
    let factor = |freedom: f64, chance: &mut Pcg64| {
        ChiSquared::new(freedom).map_or(1.0, |chi| (freedom / chi.sample(chance).max(0.05 * freedom)).sqrt())
    };
    let twin = |j: usize| {
        let mut chance = Pcg64::new(SEED, j as u128);
        let sensor = factor(noise.sensor_freedom, &mut chance);
        let there = noise.posterior.at(chance.random()).unwrap_or(&noise.jitter);
        let ratio = |of: fn(&Jitter) -> f64| if of(&noise.jitter) > 0.0 { of(there) / of(&noise.jitter) } else { 0.0 };
        let jitter = [ratio(|j| j.contact_mm), ratio(|j| j.gain), ratio(|j| j.zero_n)];
        let place = chance.random::<f64>();
        let mut sum = 0.0;
        let colours = plausible.iter().find(|(weight, _)| {
            sum += weight;
            sum >= place
        });
        let colours = colours.or(plausible.last()).map_or(&[][..], |(_, colours)| colours);
        let mut draw = whitening.draw(colours, sensor, jitter, || StandardNormal.sample(&mut chance));
        draw.iter_mut().zip(used).filter(|(_, used)| !**used).for_each(|(value, _)| *value = 0.0);
        draw
    };
    let twins: Vec<DVector<f64>> = (0..count).into_par_iter().map(twin).collect();
    if twins.is_empty() { DMatrix::zeros(whitening.residuals(), 0) } else { DMatrix::from_columns(&twins) }
}

/// An orthonormal basis of some columns.
#[must_use]
pub fn basis(columns: &DMatrix<f64>) -> DMatrix<f64> {
    let mut kept: Vec<DVector<f64>> = Vec::new();
    for column in columns.column_iter() {
        let length = column.norm();
        if length <= 0.0 || !length.is_finite() {
            continue;
        }
        let mut v = column / length;
        for _ in 0..2 {
            for q in &kept {
                v.axpy(-q.dot(&v), q, 1.0);
            }
        }
        let rest = v.norm();
        // what is left of a column that the others explain is rounding
        if rest > 1e-6 {
            kept.push(v / rest);
        }
    }
    if kept.is_empty() { DMatrix::zeros(columns.nrows(), 0) } else { DMatrix::from_columns(&kept) }
}

/// Takes off a matrix what a basis explains.
#[must_use]
pub fn rest_of(columns: &DMatrix<f64>, basis: &DMatrix<f64>) -> DMatrix<f64> {
    columns - basis * inner(basis, columns)
}

/// Directions with what they measure in clean twins before any parameter is taken off.
#[derive(Debug, Clone)]
pub struct Panel {
    raw: DMatrix<f64>,
    of_twins: DMatrix<f64>,
}

impl Panel {
    /// Of margins.
    #[must_use]
    pub fn new(margins: &[Margin], twins: &DMatrix<f64>) -> Self {
        let raw: Vec<DVector<f64>> = margins.iter().map(|m| m.direction.clone()).collect();
        Self::of(if raw.is_empty() { DMatrix::zeros(twins.nrows(), 0) } else { DMatrix::from_columns(&raw) }, twins)
    }

    /// Of any directions, one a column.
    #[must_use]
    pub fn of(raw: DMatrix<f64>, twins: &DMatrix<f64>) -> Self {
        let of_twins = inner(&raw, twins);
        Self { raw, of_twins }
    }
}

impl Gauge {
    /// Of a panel, after the parameters whose columns are given.
    #[must_use]
    pub fn new(panel: &Panel, parameters: &DMatrix<f64>, twins: &DMatrix<f64>) -> Self {
        let explained = basis(parameters);
        let shares = inner(&explained, &panel.raw);
        let mut directions = &panel.raw - &explained * &shares;
        let mut values = &panel.of_twins - inner(&shares, &inner(&explained, twins));
        for (j, whole) in panel.raw.column_iter().enumerate() {
            let (own, before) = (directions.column(j).norm(), whole.norm());
            // a direction that the parameters take up whole says nothing
            let scale = if own > 1e-3 * before { 1.0 / own } else { 0.0 };
            directions.column_mut(j).scale_mut(scale);
            values.row_mut(j).scale_mut(scale);
        }
        let count = twins.ncols().max(1) as f64;
        let scatter: Vec<f64> = values.row_iter().map(|row| (row.norm_squared() / count).sqrt()).collect();
        let largest: Vec<f64> = values
            .column_iter()
            .map(|column| {
                let each = column.iter().zip(&scatter).filter(|(_, s)| **s > 0.0);
                each.map(|(v, s)| v.abs() / s).fold(0.0, f64::max)
            })
            .collect();
        let threshold = exceeded(largest, LEVEL);
        Self { directions, scatter, threshold }
    }

    /// Adds to every direction's scatter what errors along some columns, each with unit variance, make of it.
    pub fn widen(&mut self, errors: &DMatrix<f64>) {
        let along = inner(&self.directions, errors);
        for (scatter, row) in self.scatter.iter_mut().zip(along.row_iter()).filter(|(s, _)| **s > 0.0) {
            *scatter = scatter.hypot(row.norm());
        }
    }

    /// Every direction's value in units of its scatter.
    #[must_use]
    pub fn read(&self, residual: &DVector<f64>) -> Vec<f64> {
        let values = self.directions.tr_mul(residual);
        values.iter().zip(&self.scatter).map(|(v, s)| if *s > 0.0 { v / s } else { 0.0 }).collect()
    }
}

/// Whether a fit leaves more than noise.
#[derive(Debug, Clone)]
pub struct Adequacy {
    /// Every margin's mean in units of its scatter.
    pub readings: Vec<f64>,
    /// What the largest may be.
    pub threshold: f64,
    /// Variables whose margins exceed it, the worst first.
    pub shows_in: Vec<Variable>,
}

impl Adequacy {
    /// Of a fit. `twins` are clean twins of the data set.
    #[must_use]
    pub fn of(fit: &Fit, margins: &[Margin], panel: &Panel, form_error: &DMatrix<f64>, twins: &DMatrix<f64>) -> Self {
        let mut gauge = Gauge::new(panel, &fit.jacobian, twins);
        gauge.widen(form_error);
        Self::told(gauge.read(&without_spikes(&fit.residual)), gauge.threshold, margins.iter().map(|m| m.variable))
    }
}

/// A whitened residual of which single spikes are cut off: a sensor's noise has them now and then, and one of ten standard deviations is a margin's mean by itself.
fn without_spikes(residual: &DVector<f64>) -> DVector<f64> {
    if spike::are_many(residual) { residual.clone() } else { residual.map(|r| r.clamp(-SPIKE, SPIKE)) }
}

impl Adequacy {
    /// Of readings, each of the variable at its place.
    fn told(readings: Vec<f64>, threshold: f64, variables: impl Iterator<Item = Variable>) -> Self {
        let mut worst: Vec<(Variable, f64)> = Vec::new();
        for (variable, reading) in variables.zip(&readings).filter(|(_, r)| r.abs() > threshold) {
            match worst.iter_mut().find(|(v, _)| *v == variable) {
                Some((_, size)) => *size = size.max(reading.abs()),
                None => worst.push((variable, reading.abs())),
            }
        }
        worst.sort_by(|a, b| b.1.total_cmp(&a.1));
        // what is far from the worst is its shadow in other variables
        let largest = worst.first().map_or(0.0, |(_, size)| *size);
        worst.retain(|(_, size)| *size >= SHADOW * largest);
        Self { readings, threshold, shows_in: worst.into_iter().map(|(v, _)| v).collect() }
    }

    /// True when nothing shows.
    #[must_use]
    pub fn passes(&self) -> bool {
        self.shows_in.is_empty()
    }

    /// Largest reading over the threshold.
    #[must_use]
    pub fn worst(&self) -> f64 {
        self.readings.iter().map(|r| r.abs()).fold(0.0, f64::max) / self.threshold
    }
}
