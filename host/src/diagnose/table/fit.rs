//! Least squares of a table's readings over base and effects.

use nalgebra::{DMatrix, DVector};

use super::effect::Effect;
use super::readings::{Reading, Table};
use crate::infer::descent::{Region, Residuals, Rule, minimise};
use crate::infer::evidence::{Linearised, Prior};
use crate::infer::quantity::{Coordinate, Quantity};
use crate::infer::sets::Fitted;

/// A set of effects of a table, fitted, with its evidence.
pub type Weighed = crate::infer::sets::Weighed<Fit>;

/// What is believed of a table; effects by their codes.
pub type Judged = crate::infer::sets::Judged<&'static str>;

/// The base of a table with effects: a line, or a simulation with a zero of its own.
#[derive(Debug, Clone, PartialEq)]
pub struct Law {
    /// Zero, in the unit of y, and the line's slope where nothing is simulated.
    pub base: Vec<f64>,
    /// Effects with their parameters.
    pub settings: Vec<(&'static Effect, Vec<f64>)>,
}

/// A fit.
#[derive(Debug, Clone)]
pub struct Fit {
    /// Law with its parameters.
    pub law: Law,
    /// Its effects.
    pub effects: Vec<&'static Effect>,
    /// What was searched.
    pub coordinates: Vec<Coordinate>,
    /// Where it ended.
    pub x: DVector<f64>,
    /// Measured less predicted, in standard deviations.
    pub residual: DVector<f64>,
    /// Derivative of the prediction, the same.
    pub jacobian: DMatrix<f64>,
    /// Sum of squares.
    pub square: f64,
    /// A parameter of an effect ended at a bound that is not its null.
    pub at_bound: bool,
}

/// Readings with their noise.
#[derive(Debug, Clone)]
pub struct Problem<'a> {
    /// The table.
    pub table: &'a Table,
    /// Standard deviation of a reading.
    pub sigma: f64,
    /// Readings that are fitted; the others are 0 in every residual.
    pub used: Vec<bool>,
}

const RULE: Rule = Rule { most_steps: 30, settled: 1e-6, settled_share: 1e-9, rival: None };
/// Spans of the table that a zero may be off, and spans over range that a slope may be.
const FAR: f64 = 100.0;

impl Law {
    /// What is predicted for a reading.
    #[must_use]
    pub fn predict(&self, table: &Table, r: &Reading) -> f64 {
        let line = r.simulated.unwrap_or_else(|| self.base.get(1).copied().unwrap_or(0.0) * r.x);
        let added: f64 = self.settings.iter().map(|(effect, values)| (effect.adds)(r, values)).sum();
        self.base[0] + line + table.span * added
    }

    /// The same without its effects.
    #[must_use]
    pub fn bare(&self) -> Self {
        Self { base: self.base.clone(), settings: Vec::new() }
    }

    /// The same with one more effect.
    #[must_use]
    pub fn with(&self, effect: &'static Effect, values: Vec<f64>) -> Self {
        let mut more = self.clone();
        more.settings.push((effect, values));
        more
    }
}

impl Table {
    /// The base as a fit begins with it.
    #[must_use]
    pub fn nominal(&self) -> Law {
        Law { base: vec![0.0; if self.is_simulated { 1 } else { 2 }], settings: Vec::new() }
    }
}

impl Problem<'_> {
    /// Measured less predicted, in the unit of y; 0 where nothing is fitted.
    #[must_use]
    pub fn plain(&self, law: &Law) -> DVector<f64> {
        let each = self.table.readings.iter().zip(&self.used);
        let left = each.map(|(r, used)| if *used { r.y - law.predict(self.table, r) } else { 0.0 });
        DVector::from_iterator(self.table.readings.len(), left)
    }

    /// Coordinates of a law.
    #[must_use]
    pub fn coordinates(&self, law: &Law) -> Vec<Coordinate> {
        let span = self.table.span;
        let base = [("zero", span), ("slope", span / self.table.range)].into_iter().take(law.base.len());
        let base = base.map(|(name, unit)| Coordinate {
            name,
            ends: (-FAR * unit, FAR * unit),
            logarithmic: false,
            prior: Prior::Flat,
            null: None,
            step: 1e-3 * unit,
        });
        let of = |q: &Quantity| Coordinate::of_quantity(q, 1e-4);
        base.chain(law.settings.iter().flat_map(|(effect, _)| effect.quantities).map(of)).collect()
    }

    fn residual(&self, law: &Law) -> DVector<f64> {
        self.plain(law) / self.sigma
    }

    /// Derivative of the prediction about a fit of other readings.
    pub(super) fn jacobian_of(&self, fit: &Fit) -> DMatrix<f64> {
        self.jacobian(&fit.law, &fit.coordinates, &fit.x)
    }

    fn jacobian(&self, from: &Law, list: &[Coordinate], x: &DVector<f64>) -> DMatrix<f64> {
        let column = |j: usize| {
            let moved = |by: f64| {
                let mut there = x.clone();
                there[j] = (x[j] + by).clamp(list[j].ends.0, list[j].ends.1);
                there
            };
            let (up, down) = (moved(list[j].step), moved(-list[j].step));
            let span = (up[j] - down[j]).max(f64::MIN_POSITIVE);
            (self.residual(&at(from, list, &down)) - self.residual(&at(from, list, &up))) / span
        };
        DMatrix::from_columns(&(0..list.len()).map(column).collect::<Vec<_>>())
    }

    /// Fits all parameters of a law, beginning where they are.
    #[must_use]
    pub fn fit(&self, from: &Law) -> Fit {
        self.fit_of(from, self.coordinates(from))
    }

    /// The same of the base's parameters only.
    #[must_use]
    pub fn fit_base(&self, from: &Law) -> Fit {
        let mut list = self.coordinates(from);
        list.truncate(from.base.len());
        self.fit_of(from, list)
    }

    fn fit_of(&self, from: &Law, list: Vec<Coordinate>) -> Fit {
        let objective = Residuals {
            residual: |x: &[f64]| self.residual(&at(from, &list, &DVector::from_column_slice(x))),
            jacobian: |x: &[f64], _: &DVector<f64>| self.jacobian(from, &list, &DVector::from_column_slice(x)),
        };
        let region = Region::of(list.iter().map(|c| c.ends));
        let start = point(from, &list);
        let end = minimise(&objective, &region, start.as_slice(), &RULE);
        let (x, (residual, jacobian)) = (DVector::from_vec(end.x), end.kept.into_parts());
        let at_bound = list.iter().zip(x.iter()).skip(from.base.len()).any(|(c, x)| c.is_at_bound(*x));
        let effects = from.settings.iter().map(|(effect, _)| *effect).collect();
        let square = residual.norm_squared();
        Fit { law: at(from, &list, &x), effects, coordinates: list, x, residual, jacobian, square, at_bound }
    }
}

/// A law at a point of some of its first parameters.
pub(super) fn at(law: &Law, list: &[Coordinate], x: &DVector<f64>) -> Law {
    let mut out = law.clone();
    let slots = out.base.iter_mut().chain(out.settings.iter_mut().flat_map(|(_, values)| values));
    for ((slot, c), x) in slots.zip(list).zip(x.iter()) {
        *slot = c.value(*x);
    }
    out
}

fn point(law: &Law, list: &[Coordinate]) -> DVector<f64> {
    let values = law.base.iter().chain(law.settings.iter().flat_map(|(_, values)| values));
    DVector::from_iterator(list.len(), values.zip(list).map(|(value, c)| c.of(*value)))
}

impl Fitted for Fit {
    type Effect = &'static Effect;

    fn effects(&self) -> &[&'static Effect] {
        &self.effects
    }

    fn linearised<'a>(&'a self, known: &'a DMatrix<f64>) -> Linearised<'a> {
        let own = self.coordinates.iter().zip(self.x.iter());
        let parameters = own.map(|(c, x)| c.at(*x));
        Linearised { residual: &self.residual, jacobian: &self.jacobian, parameters: parameters.collect(), known }
    }
}
