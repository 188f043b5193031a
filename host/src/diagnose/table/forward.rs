//! A table as sets of effects see it.

use nalgebra::{DMatrix, DVector};

use super::effect::{CATALOGUE, Effect};
use super::fit::{Fit, Law, Problem, Weighed, at};
use super::readings::Reading;
use crate::infer::evidence::{Parameter, Sizes};
use crate::infer::presence;
use crate::infer::process::Shapes;
use crate::infer::quantity::Quantity;
use crate::infer::sets::{Forward, Group, Groups, Kind, Misfits};

/// Size of a discrepancy, as a share of the span: as often above as below, and a factor of 2.7 to either
/// side. Calibrations by hand are as straight as that.
const SIZE: (f64, f64) = (0.01, 1.0);
/// Correlation length over x.
const OVER_X: f64 = 0.25;
/// Relative error of an effect as the catalogue writes it down.
const FORM_ERROR: f64 = 0.05;
/// Root mean square of a misfit, as a part of the span, below which it shows in no reading.
const SEEN: f64 = 1e-4;

/// What a search among effects needs.
#[derive(Debug)]
pub struct Search<'a> {
    /// Readings.
    pub problem: Problem<'a>,
    /// Effects that the table could show.
    pub effects: Vec<&'static Effect>,
    /// Fit of the base.
    pub base: Fit,
}

impl<'a> Search<'a> {
    /// Of a table's readings.
    #[must_use]
    pub fn new(problem: Problem<'a>) -> Self {
        let effects = CATALOGUE.into_iter().filter(|effect| (effect.is_possible)(problem.table)).collect();
        let base = problem.fit(&problem.table.nominal());
        Self { problem, effects, base }
    }

    /// What the law may be wrong by without a name: smooth over x beside a simulation, and over x on the way
    /// back. What bends a calibration smoothly is a nonlinearity, and what changes smoothly with the order a
    /// drift, whatever their forms.
    #[must_use]
    pub fn groups(&self) -> Groups {
        let table = self.problem.table;
        type Place = fn(&Reading) -> Option<f64>;
        // two ways are one where they turn, at the largest x
        let varied: [(&'static str, Option<f64>, Place); 2] =
            [("x", None, |r| Some(r.level)), ("way", Some(1.0), |r| (r.way < 0.0).then_some(r.level))];
        let made = |(over, from, place): (&'static str, Option<f64>, Place)| {
            let shapes = Shapes::new(OVER_X);
            let readings = DMatrix::from_fn(table.readings.len(), shapes.len(), |row, shape| {
                let used = place(&table.readings[row]).filter(|_| self.problem.used[row]);
                let before = from.map_or(0.0, |from| shapes.at(shape, from));
                used.map_or(0.0, |u| table.span * (shapes.at(shape, u) - before))
            });
            Group { over, kind: Kind::Misfit, columns: &readings / self.problem.sigma, readings }
        };
        let varied = varied.into_iter().filter(|(over, ..)| table.is_simulated || *over != "x");
        let each = varied.map(made).filter(|group| group.columns.amax() > 0.0).collect();
        Groups::new(table.readings.len(), each, Sizes::about(SIZE.0, SIZE.1))
    }
}

impl Forward for Search<'_> {
    type Fit = Fit;
    type Name = &'static str;

    fn base(&self) -> &Fit {
        &self.base
    }

    fn effects(&self) -> &[&'static Effect] {
        &self.effects
    }

    fn name(&self, effect: &&'static Effect) -> &'static str {
        effect.code
    }

    fn is_form_of(&self, one: &&'static Effect, other: &&'static Effect) -> bool {
        one.code == other.code
    }

    fn may_join(&self, set: &[&'static Effect], effect: &&'static Effect) -> bool {
        set.iter().all(|own| own.code != effect.code)
    }

    fn log_odds(&self, effect: &&'static Effect) -> f64 {
        let alike = self.effects.iter().filter(|other| other.code == effect.code).count();
        presence::log_odds(alike, effect.quantities.iter().filter(|q| q.is_one_sided()).count())
    }

    fn extended(&self, from: &Fit, effect: &&'static Effect) -> Option<Fit> {
        let starts = Quantity::combined(effect.quantities, |q| q.starts.to_vec());
        let fits = starts.into_iter().map(|values| self.problem.fit(&from.law.with(effect, values)));
        fits.min_by(|a, b| a.square.total_cmp(&b.square))
    }

    fn again(&self, fit: &Fit) -> Fit {
        self.problem.fit(&fit.law)
    }

    /// What the effects add, a small share of it.
    fn form_error(&self, fit: &Fit) -> DMatrix<f64> {
        let added = (self.problem.plain(&fit.law.bare()) - self.problem.plain(&fit.law)) / self.problem.sigma;
        if fit.effects.is_empty() {
            return DMatrix::zeros(added.len(), 0);
        }
        let shaped = |shape: usize| {
            let readings = self.problem.table.readings.iter();
            let own = added.iter().zip(readings).map(|(n, r)| {
                let x = 2.0 * r.level - 1.0;
                FORM_ERROR * n * [1.0, x, 1.5 * x * x - 0.5][shape]
            });
            DVector::from_iterator(added.len(), own)
        };
        DMatrix::from_columns(&[shaped(0), shaped(1), shaped(2)])
    }

    fn signature(&self, at: &Fit, effect: &&'static Effect) -> (DMatrix<f64>, Parameter) {
        let shapes = Quantity::combined(effect.quantities, Quantity::plausible_values);
        let here = self.problem.plain(&at.law);
        let change = |values| (&here - self.problem.plain(&at.law.with(effect, values))) / self.problem.sigma;
        let columns: Vec<DVector<f64>> = shapes.into_iter().map(change).collect();
        (DMatrix::from_columns(&columns), Quantity::in_plausible_ones(effect.quantities))
    }
}

impl Misfits for Search<'_> {
    type Model = Law;

    fn readings(&self) -> usize {
        self.problem.table.readings.len()
    }

    fn model(&self, set: &Weighed, columns: &DMatrix<f64>, amounts: Option<&DVector<f64>>) -> (Law, DVector<f64>) {
        let x = DVector::from_column_slice(&set.evidence.x);
        let beside = amounts.map_or_else(|| DVector::zeros(columns.nrows()), |amounts| columns * amounts);
        (at(&set.fit.law, &set.fit.coordinates, &x), beside)
    }

    fn left(&self, law: &Law, is_kept: &dyn Fn(usize) -> bool, beside: &DVector<f64>) -> f64 {
        let kept = law.settings.iter().enumerate().filter(|(at, _)| is_kept(*at));
        let shown = Law { base: law.base.clone(), settings: kept.map(|(_, setting)| setting.clone()).collect() };
        self.plainly(&shown, beside, &law.bare())
    }

    /// As a share of the span of the readings.
    fn left_share(&self, law: &Law, beside: &DVector<f64>) -> f64 {
        self.plainly(law, beside, law) / self.problem.table.span
    }

    fn seen(&self) -> f64 {
        SEEN * self.problem.table.span
    }

    fn explained(&self, _: &Fit) -> Option<f64> {
        None
    }
}

impl Search<'_> {
    /// Root mean square of what a plain fit of the base's parameters of a law leaves of readings as another
    /// law has them, with something beside these.
    fn plainly(&self, shown: &Law, beside: &DVector<f64>, from: &Law) -> f64 {
        let mut table = self.problem.table.clone();
        let values: Vec<f64> = table.readings.iter().map(|r| shown.predict(&table, r)).collect();
        let rows = table.readings.iter_mut().zip(values.iter().zip(beside.iter()));
        rows.for_each(|(r, (y, more))| r.y = y + more);
        let plain = Problem { table: &table, sigma: 1.0, used: self.problem.used.clone() };
        let count = plain.used.iter().filter(|used| **used).count().max(1);
        (plain.fit_base(from).square / count as f64).sqrt()
    }
}
