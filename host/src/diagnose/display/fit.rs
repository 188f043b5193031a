//! Least squares of whitened residuals over the parameters of the base law and of effects.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::design::Design;
use super::effect::Effect;
use super::law::{Law, Setting};
use super::whiten::Whitening;
use crate::infer::covariance::standard_errors;
use crate::infer::descent::{Region, Residuals, Rule, minimise};
use crate::infer::product::inner;

/// Data with their whitening.
#[derive(Debug, Clone)]
pub struct Problem<'a> {
    /// Data.
    pub design: &'a Design,
    /// Noise.
    pub whitening: Whitening,
    /// Runs that are fitted; the others are 0 in every residual, and [`Whitening::for_runs`] takes them for none.
    pub used: Vec<bool>,
}

/// A searched parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coordinate {
    /// Name, with its unit.
    pub name: &'static str,
    /// Bounds of the value.
    pub bounds: (f64, f64),
    /// Searched in its logarithm.
    pub logarithmic: bool,
    /// Size of a change that matters little, as a coordinate.
    step: f64,
    /// A base parameter.
    pub base: bool,
    /// Value without the effect.
    null: Option<f64>,
}

impl Coordinate {
    /// The coordinate of a value.
    #[must_use]
    pub fn of(&self, value: f64) -> f64 {
        if self.logarithmic { value.max(f64::MIN_POSITIVE).ln() } else { value }
    }

    /// The value of a coordinate.
    #[must_use]
    pub fn value(&self, x: f64) -> f64 {
        if self.logarithmic { x.exp() } else { x }
    }

    fn limits(&self) -> (f64, f64) {
        (self.of(self.bounds.0), self.of(self.bounds.1))
    }
}

/// A fit.
#[derive(Debug, Clone)]
pub struct Fit {
    /// Law with its parameters.
    pub law: Law,
    /// What was searched.
    pub coordinates: Vec<Coordinate>,
    /// Where it ended.
    pub x: DVector<f64>,
    /// Whitened measured less predicted.
    pub residual: DVector<f64>,
    /// Derivative of the prediction, whitened.
    pub jacobian: DMatrix<f64>,
    /// Sum of squares.
    pub square: f64,
    /// An effect's parameter ended at a bound that is not its null.
    pub at_bound: bool,
}

/// A parameter with its 95 % interval.
pub type Estimate = (&'static str, f64, (f64, f64));

/// When a fit has ended: its sum of squares is that of a chi-square.
const RULE: Rule = Rule { most_steps: 25, settled: 1e-4, settled_share: 1e-7, rival: None };

/// Coordinates of a law.
#[must_use]
pub fn coordinates(law: &Law) -> Vec<Coordinate> {
    let base = law.channel.base().iter().map(|p| Coordinate {
        name: p.name,
        bounds: p.bounds,
        logarithmic: p.logarithmic,
        step: if p.logarithmic { 1e-4 } else { 1e-5 * (p.bounds.1 - p.bounds.0).min(1.0) },
        base: true,
        null: None,
    });
    let effects = law.settings.iter().flat_map(|s| s.effect.quantities).map(|q| Coordinate {
        name: q.name,
        bounds: q.bounds,
        logarithmic: q.logarithmic,
        step: if q.logarithmic { 1e-3 } else { 0.01 * (q.plausible - q.null.unwrap_or(0.0)).abs() },
        base: false,
        null: q.null,
    });
    base.chain(effects).collect()
}

fn point(law: &Law, list: &[Coordinate]) -> DVector<f64> {
    let values = law.base.iter().chain(law.settings.iter().flat_map(|s| &s.values));
    DVector::from_iterator(list.len(), values.zip(list).map(|(value, c)| c.of(*value)))
}

fn at(law: &Law, list: &[Coordinate], x: &DVector<f64>) -> Law {
    let mut out = law.clone();
    let slots = out.base.iter_mut().chain(out.settings.iter_mut().flat_map(|s| &mut s.values));
    for ((slot, c), x) in slots.zip(list).zip(x.iter()) {
        *slot = c.value(*x);
    }
    out
}

impl Problem<'_> {
    /// Measured less predicted in the channel's unit, 0 where nothing is compared or fitted.
    #[must_use]
    pub fn plain(&self, law: &Law) -> DVector<f64> {
        let mut out = DVector::zeros(self.design.samples());
        for (s, series) in self.design.series.iter().enumerate().filter(|(s, _)| self.used[*s]) {
            let first = self.design.first(s);
            for (k, y) in law.predict(series).into_iter().enumerate().filter(|(k, _)| series.compared[*k]) {
                out[first + k] = series.output[k] - y;
            }
        }
        out
    }

    /// The same data of which some runs count only.
    #[must_use]
    pub fn for_runs(&self, used: Vec<bool>) -> Self {
        Self { whitening: self.whitening.for_runs(&used), used, ..self.clone() }
    }

    /// The same, whitened.
    #[must_use]
    pub fn residual(&self, law: &Law) -> DVector<f64> {
        let mut out = self.plain(law);
        self.whitening.apply(&mut out);
        out
    }

    pub(super) fn jacobian(&self, law: &Law, list: &[Coordinate], x: &DVector<f64>) -> DMatrix<f64> {
        let columns: Vec<DVector<f64>> = (0..list.len())
            .into_par_iter()
            .map(|j| {
                let (low, high) = list[j].limits();
                let (mut up, mut down) = (x.clone(), x.clone());
                up[j] = (x[j] + list[j].step).min(high);
                down[j] = (x[j] - list[j].step).max(low);
                let span = (up[j] - down[j]).max(f64::MIN_POSITIVE);
                let mut column = (self.plain(&at(law, list, &down)) - self.plain(&at(law, list, &up))) / span;
                self.whitening.apply(&mut column);
                column
            })
            .collect();
        DMatrix::from_columns(&columns)
    }

    /// Fits all parameters of a law, beginning where they are (Levenberg and Marquardt, inside the bounds).
    #[must_use]
    pub fn fit(&self, from: &Law) -> Fit {
        let list = coordinates(from);
        let objective = Residuals {
            residual: |x: &[f64]| self.residual(&at(from, &list, &DVector::from_column_slice(x))),
            jacobian: |x: &[f64], _: &DVector<f64>| self.jacobian(from, &list, &DVector::from_column_slice(x)),
        };
        let region = Region::of(list.iter().map(Coordinate::limits));
        let end = minimise(&objective, &region, point(from, &list).as_slice(), &RULE);
        let (x, (residual, jacobian)) = (DVector::from_vec(end.x), end.kept.into_parts());
        let at_bound = list.iter().zip(x.iter()).filter(|(c, _)| !c.base).any(|(c, x)| {
            let (low, high) = c.limits();
            let near = 1e-3 * (high - low);
            let is_null = |limit: f64| c.null.is_some_and(|null| (c.of(null) - limit).abs() < near);
            (x - low < near && !is_null(low)) || (high - x < near && !is_null(high))
        });
        Fit {
            law: at(from, &list, &x),
            square: residual.norm_squared(),
            coordinates: list,
            x,
            residual,
            jacobian,
            at_bound,
        }
    }
}

impl Fit {
    /// Effects of the law.
    #[must_use]
    pub fn effects(&self) -> Vec<&'static Effect> {
        self.law.settings.iter().map(|s: &Setting| s.effect).collect()
    }

    /// Half widths of the coordinates at `z` standard deviations.
    fn widths(&self, z: f64) -> Vec<f64> {
        let mut normal = inner(&self.jacobian, &self.jacobian);
        for (j, c) in self.coordinates.iter().enumerate() {
            // what the data do not show is known to its bounds
            let (low, high) = c.limits();
            normal[(j, j)] += 4.0 / (high - low).powi(2);
        }
        standard_errors(&normal).into_iter().map(|error| z * error).collect()
    }

    /// Parameters with intervals of `z` standard deviations: of the base, or of its `effect`-th effect.
    #[must_use]
    pub fn estimates(&self, effect: Option<usize>, z: f64) -> Vec<Estimate> {
        let base = self.law.base.len();
        let range = match effect {
            None => 0..base,
            Some(at) => {
                let start = base + self.law.settings[..at].iter().map(|s| s.values.len()).sum::<usize>();
                start..start + self.law.settings[at].values.len()
            }
        };
        let widths = self.widths(z);
        let each = range.map(|j| {
            let c = &self.coordinates[j];
            let (low, high) = c.limits();
            let interval = ((self.x[j] - widths[j]).max(low), (self.x[j] + widths[j]).min(high));
            (c.name, c.value(self.x[j]), (c.value(interval.0), c.value(interval.1)))
        });
        each.collect()
    }
}
