//! Fits of the base model with effects to whitened residuals.

use std::cell::OnceCell;
use std::sync::Arc;

use lut_gen::chain::{Chain, Model, Whole};
use lut_gen::effect::{Quantity, Spread, relaxation, second_term};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::check::Check;
use super::coordinate::{Candidate, Coordinate, coordinates, model};
use super::design::Design;
use super::quantile::exceeded;
use super::scatter::Curve;
use super::whiten::Whitening;
use crate::infer::covariance::{Z95, covariance};
use crate::infer::descent::{Objective, Quadratic, Region, Rule, minimise};
use crate::infer::lowrank::Fold;
use crate::infer::presence::CHARGE;
use crate::infer::product::inner;
use crate::infer::unseen::Widening;

/// Data, model and noise: what is fitted.
#[derive(Debug, Clone)]
pub struct Problem<'a> {
    /// The data.
    pub design: &'a Design,
    /// The model.
    pub chain: &'a Chain,
    /// Contact point of every run, mm, as the base fit sees it.
    pub contacts_mm: Vec<f64>,
    /// What a first-order step back to contact 0 adds to the prediction, N.
    pub back_n: DVector<f64>,
    /// Noise.
    pub whitening: Whitening,
    /// Entries that are fitted; the others are 0 in every residual, and [`Whitening::for_rows`] takes them for none.
    pub used: Vec<bool>,
    /// What finite elements of whole paths add to the chain near the point where a fit begins.
    pub whole: Option<Arc<Whole>>,
}

/// A fit.
#[derive(Debug, Clone)]
pub struct Fit {
    /// Effects that were added to the base.
    pub candidates: Vec<Candidate>,
    /// Parameters.
    pub coordinates: Vec<Coordinate>,
    /// Their values, logarithms where they are searched so.
    pub x: DVector<f64>,
    /// The model.
    pub model: Model,
    /// Sum of the squares of the whitened residuals.
    pub square: f64,
    /// The same with what the effects may be wrong by discounted and paid for: twice the negative logarithm of a marginal likelihood.
    pub discounted: f64,
    /// The part of it that was paid for freedom.
    pub price: f64,
    /// Information on the parameters, errors of the effects allowed for.
    pub information: DMatrix<f64>,
    /// Whitened residuals.
    pub residual: DVector<f64>,
    /// Derivative of the whitened prediction by every parameter.
    pub jacobian: DMatrix<f64>,
    /// Standard errors on either side of every parameter that hold the truth in 95 cases of 100: more than 1.96 where the noise was itself estimated from little.
    pub reach: Vec<f64>,
    /// True when a quantity of an effect lies at a bound that is not its null value, or the modulus, the exponent or the contact at one; of two terms the exponents may. Also where more relaxes than can.
    pub at_bound: bool,
    /// More solves from here would be the same again.
    pub settled: bool,
    /// What effects that are not in it do to the errors of its parameters, once that is asked for.
    pub unseen: Option<Widening>,
}

/// A fit has ended when a step changes the sum of squares by less than this.
const SETTLED: f64 = 0.02;
/// Information on a parameter that nothing tells of.
const UNTOLD: f64 = 1e-300;
const RULE: Rule = Rule { most_steps: 30, settled: SETTLED, settled_share: 0.0, rival: None };

/// Part of the stress that relaxes in the end, of all terms together.
fn relaxing_part(model: &Model) -> f64 {
    model.relaxing().iter().map(|(part, _)| part).sum()
}

/// Forces (N) at the nodes of every run.
#[must_use]
pub fn predicted(design: &Design, chain: &Chain, model: &Model, contacts_mm: &[f64]) -> Vec<Vec<f64>> {
    let paths = chain.predict(model, contacts_mm);
    design.series.iter().zip(paths).map(|(s, force_n)| s.at.iter().map(|at| force_n[*at]).collect()).collect()
}

/// What noise alone leaves of a fit, as a sum of squares: rows that count less its parameters.
pub(super) fn freedom(used: &[bool], fit: &Fit) -> f64 {
    used.iter().filter(|used| **used).count().saturating_sub(fit.x.len()) as f64
}

/// Share that a sum of squares has lost of what the base leaves beyond noise (`expected`); none where that is within two standard deviations of noise, a share of which
/// would say nothing.
pub(super) fn explained(base_square: f64, expected: f64, square: f64) -> Option<f64> {
    let excess = base_square - expected;
    (excess > 2.0 * (2.0 * expected).sqrt()).then(|| (base_square - square) / excess)
}

/// What a model predicts for every row of a residual: forces (N) at the nodes of every run, then what runs without a ball on the specimen show.
#[must_use]
pub fn rows(design: &Design, chain: &Chain, model: &Model, contacts_mm: &[f64]) -> DVector<f64> {
    let mut rows: Vec<f64> = predicted(design, chain, model, contacts_mm).concat();
    rows.extend(design.checks.iter().flat_map(|check| check.predicted(model)));
    DVector::from_vec(rows)
}

/// What was recorded there.
fn measured(design: &Design) -> impl Iterator<Item = f64> + '_ {
    let forces = design.series.iter().flat_map(|s| s.nodes.iter().map(|n| n.force_n));
    forces.chain(design.checks.iter().flat_map(Check::measured))
}

impl Problem<'_> {
    /// Largest force of all runs, N.
    #[must_use]
    pub fn largest_n(&self) -> f64 {
        self.design.largest_n()
    }

    /// Rows of a run that a ball on the specimen has no part in.
    #[must_use]
    pub fn rows_of_check(&self, at: usize) -> std::ops::Range<usize> {
        let first = self.whitening.first(self.design.series.len() + at);
        first..first + self.design.checks[at].rows()
    }

    /// Measured less predicted, whitened; entries that are not used are 0.
    #[must_use]
    pub fn residual(&self, model: &Model) -> DVector<f64> {
        let mut residual = self.plain(model);
        self.whitening.apply(&mut residual);
        residual
    }

    /// The same data of which some rows count only; `None` when what is left of a covariance is not positive definite.
    #[must_use]
    pub fn for_rows(&self, used: Vec<bool>) -> Option<Self> {
        Some(Self { whitening: self.whitening.for_rows(&used)?, used, ..self.clone() })
    }

    /// Measured less predicted, N (mm where depths are compared), moved back to contact 0 to first order.
    #[must_use]
    pub fn plain(&self, model: &Model) -> DVector<f64> {
        let mut residual = rows(self.design, self.chain, model, &self.contacts_mm);
        let own = residual.iter_mut().zip(measured(self.design)).zip(self.used.iter().zip(self.back_n.iter()));
        own.for_each(|((r, measured), (used, back_n))| *r = if *used { measured - *r - back_n } else { 0.0 });
        residual
    }

    /// The model of a point, with what finite elements add.
    #[must_use]
    pub fn model(&self, coordinates: &[Coordinate], candidates: &[Candidate], x: &DVector<f64>) -> Model {
        Model { whole: self.whole.clone(), ..model(coordinates, candidates, x) }
    }

    /// Fits the base with candidates from a point.
    #[must_use]
    pub fn fit(&self, candidates: &[Candidate], start: &DVector<f64>) -> Fit {
        let searched = Searched::new(self, candidates, Clone::clone);
        self.told(candidates, searched.descended(start, &RULE))
    }

    /// The best fit from some points, the first of equals; none without a point.
    #[must_use]
    pub fn best_of(&self, candidates: &[Candidate], starts: &[DVector<f64>]) -> Option<Fit> {
        let searched = Searched::new(self, candidates, Clone::clone);
        let mut best: Option<End> = None;
        for start in starts {
            let rival = best.as_ref().map(|best| best.value);
            let end = searched.descended(start, &Rule { rival, ..RULE });
            if best.as_ref().is_none_or(|best| best.value.is_nan() || end.value < best.value) {
                best = Some(end);
            }
        }
        best.map(|end| self.told(candidates, end))
    }

    /// A point as if it were a fit, errors of the effects allowed for.
    #[must_use]
    pub fn at(&self, candidates: &[Candidate], x: &DVector<f64>, allowed: &Fold) -> Fit {
        let searched = Searched::new(self, candidates, Clone::clone);
        let (value, residual) = searched.value(x.as_slice());
        let jacobian = self.jacobian(&searched.coordinates, candidates, x, &residual.residual);
        self.told(candidates, End { x: x.clone(), value, residual: residual.residual, jacobian }).beside(allowed)
    }

    /// A fit that ended at a point.
    fn told(&self, candidates: &[Candidate], end: End) -> Fit {
        let End { x, residual, jacobian, .. } = end;
        let coordinates = coordinates(self.design, candidates);
        let square = residual.norm_squared();
        // exponents end where force models do: of two terms, either of which may be the second, a law that goes on beyond is still two terms
        let open = |at: usize| candidates[at].effect.code == second_term::EFFECT.code;
        let ends = coordinates.iter().zip(&x).any(|(c, x)| match c {
            Coordinate::Of(at, q) if q.spread == Spread::Logarithmic && open(*at) => false,
            Coordinate::LnAlpha | Coordinate::LnAlphaAlone if (0..candidates.len()).any(open) => false,
            _ => c.is_at_bound(*x),
        });
        let model = self.model(&coordinates, candidates, &x);
        let at_bound = ends || relaxing_part(&model) > relaxation::MOST;
        let information = inner(&jacobian, &jacobian);
        let candidates = candidates.to_vec();
        let discounted = square;
        let price = 0.0;
        let reach = vec![Z95; coordinates.len()];
        Fit {
            candidates,
            coordinates,
            x,
            model,
            square,
            discounted,
            price,
            information,
            residual,
            jacobian,
            reach,
            at_bound,
            settled: false,
            unseen: None,
        }
    }

    /// The fit found again with errors of its effects allowed for, and told without that allowance.
    #[must_use]
    pub fn refit(&self, fit: &Fit, allowed: &Fold) -> Fit {
        let own = Problem { whole: fit.model.whole.clone(), ..self.clone() };
        let searched = Searched::new(&own, &fit.candidates, |of: &DMatrix<f64>| allowed.all_taken_off(of.clone()));
        let mut found = own.told(&fit.candidates, searched.descended(&fit.x, &RULE)).beside(allowed);
        let tolerated = allowed.all_taken_off(found.jacobian.clone());
        found.information = inner(&tolerated, &tolerated);
        found
    }

    /// Derivative of the whitened prediction by difference quotients.
    fn jacobian(
        &self,
        coordinates: &[Coordinate],
        candidates: &[Candidate],
        x: &DVector<f64>,
        residual: &DVector<f64>,
    ) -> DMatrix<f64> {
        let step = |j: usize, coordinate: &Coordinate| {
            let forth = coordinate.step();
            if x[j] + forth > coordinate.bounds().1 { -forth } else { forth }
        };
        let steps: Vec<f64> = coordinates.iter().enumerate().map(|(j, coordinate)| step(j, coordinate)).collect();
        let column = |(j, step): (usize, &f64)| {
            let mut moved = x.clone();
            moved[j] += step;
            self.plain(&self.model(coordinates, candidates, &moved))
        };
        let columns: Vec<DVector<f64>> = steps.par_iter().enumerate().map(column).collect();
        let mut out = DMatrix::from_columns(&columns);
        self.whitening.apply_to(&mut out);
        for (mut column, step) in out.column_iter_mut().zip(steps) {
            column.zip_apply(residual, |there, here| *there = (here - *there) / step);
        }
        out
    }

    /// Prediction and slope of every run at a model.
    #[must_use]
    pub fn curves(design: &Design, chain: &Chain, model: &Model, contacts_mm: &[f64]) -> Vec<Curve> {
        const STEP_MM: f64 = 1e-3;
        let moved = |by: f64| -> Vec<f64> { contacts_mm.iter().map(|c| c + by).collect() };
        let here = predicted(design, chain, model, contacts_mm);
        let deeper = predicted(design, chain, model, &moved(-STEP_MM));
        let shallower = predicted(design, chain, model, &moved(STEP_MM));
        here.into_iter()
            .zip(deeper.into_iter().zip(shallower))
            .map(|(force_n, (a, b))| {
                let slope_n_per_mm = a.iter().zip(&b).map(|(a, b)| (a - b) / (2.0 * STEP_MM)).collect();
                Curve { force_n, slope_n_per_mm }
            })
            .collect()
    }
}

/// What is searched: whitened residuals over the parameters, less what `off` takes off them, a column each.
struct Searched<'a, 'b, F> {
    problem: &'a Problem<'b>,
    candidates: &'a [Candidate],
    coordinates: Vec<Coordinate>,
    off: F,
}

/// Whitened residuals of a point, with their derivative where that was asked for. Nothing is taken off either.
struct Evaluated {
    residual: DVector<f64>,
    jacobian: OnceCell<DMatrix<f64>>,
}

/// Where a search ended. Nothing is taken off residuals and derivative.
struct End {
    x: DVector<f64>,
    /// What was searched for.
    value: f64,
    residual: DVector<f64>,
    jacobian: DMatrix<f64>,
}

impl<'a, 'b, F: Fn(&DMatrix<f64>) -> DMatrix<f64>> Searched<'a, 'b, F> {
    fn new(problem: &'a Problem<'b>, candidates: &'a [Candidate], off: F) -> Self {
        Self { problem, candidates, coordinates: coordinates(problem.design, candidates), off }
    }

    /// Where the sum of squares is least near a point.
    fn descended(&self, start: &DVector<f64>, rule: &Rule) -> End {
        let region = Region::of(self.coordinates.iter().map(Coordinate::bounds));
        let end = minimise(self, &region, start.as_slice(), rule);
        let jacobian = self.derivative(&end.x, &end.kept).clone();
        End { x: DVector::from_vec(end.x), value: end.value, residual: end.kept.residual, jacobian }
    }

    fn derivative<'c>(&self, x: &[f64], at: &'c Evaluated) -> &'c DMatrix<f64> {
        let x = DVector::from_column_slice(x);
        at.jacobian.get_or_init(|| self.problem.jacobian(&self.coordinates, self.candidates, &x, &at.residual))
    }

    /// A residual less what is taken off.
    fn left(&self, residual: &DVector<f64>) -> DVector<f64> {
        let left = (self.off)(&DMatrix::from_column_slice(residual.len(), 1, residual.as_slice()));
        DVector::from_vec(left.data.into())
    }
}

impl<F: Fn(&DMatrix<f64>) -> DMatrix<f64>> Objective for Searched<'_, '_, F> {
    type Kept = Evaluated;

    fn value(&self, x: &[f64]) -> (f64, Evaluated) {
        let x = DVector::from_column_slice(x);
        let residual = self.problem.residual(&self.problem.model(&self.coordinates, self.candidates, &x));
        (self.left(&residual).norm_squared(), Evaluated { residual, jacobian: OnceCell::new() })
    }

    fn slopes(&self, x: &[f64], kept: &Evaluated) -> Quadratic {
        Quadratic::of(&self.left(&kept.residual), &(self.off)(self.derivative(x, kept)))
    }
}

impl Fit {
    /// Sum of squares with the charge for its parameters. What the effects may be wrong by is allowed for and paid for where that is likelier: an effect that is written down exactly needs
    /// no such freedom.
    #[must_use]
    pub fn score(&self) -> f64 {
        self.discounted.min(self.square) + CHARGE * self.coordinates.len() as f64
    }

    /// A quantity of an effect that lies at a bound which is not its null value; none where all lie within.
    #[must_use]
    pub fn end_of_effect(&self) -> Option<&'static str> {
        let at_end = |(c, x): (&Coordinate, &f64)| match c {
            Coordinate::Of(_, q) if q.spread == Spread::Even && c.is_at_bound(*x) => Some(q.name),
            _ => None,
        };
        self.coordinates.iter().zip(&self.x).find_map(at_end)
    }

    /// Codes of its effects, in their order.
    pub fn codes(&self) -> impl Iterator<Item = &'static str> + '_ {
        self.candidates.iter().map(|c| c.effect.code)
    }

    /// The same with errors of its effects allowed for in what it comes to.
    fn beside(mut self, allowed: &Fold) -> Self {
        self.price = allowed.price();
        self.discounted = allowed.taken_off(&self.residual).norm_squared() + allowed.price();
        self
    }

    /// Covariance of the parameters; that of one which is not told of at all is as good as infinite. None where a number is none.
    #[must_use]
    pub fn covariance(&self) -> Option<DMatrix<f64>> {
        let mut information = self.information.clone();
        for i in 0..information.nrows() {
            // what is not told of at all is unknown, and says nothing of the others; two that are told of together keep a millionth of their scale
            information[(i, i)] = (information[(i, i)] * (1.0 + 1e-12)).max(UNTOLD);
        }
        covariance(&information)
    }

    /// Finds how far the errors of the parameters reach in clean twins, which know that the noise is an estimate.
    pub fn reach_in(&mut self, twins: &DMatrix<f64>) {
        let Some(inverse) = covariance(&inner(&self.jacobian, &self.jacobian)) else { return };
        let errors = &inverse * inner(&self.jacobian, twins);
        for (i, reach) in self.reach.iter_mut().enumerate() {
            let own: Vec<f64> = errors.row(i).iter().map(|e| e.abs() / inverse[(i, i)].sqrt()).collect();
            let found = exceeded(own, 0.05);
            *reach = if found.is_finite() { found.max(Z95) } else { Z95 };
        }
    }

    /// Values of the quantities of one candidate, with 95 % intervals.
    #[must_use]
    pub fn quantities(&self, candidate: usize) -> Vec<(Quantity, f64, (f64, f64))> {
        let covariance = self.covariance();
        let own = self.coordinates.iter().enumerate().filter_map(|(i, c)| match c {
            Coordinate::Of(at, q) if *at == candidate => Some((i, c, q)),
            _ => None,
        });
        own.map(|(i, c, q)| {
            let sigma = covariance.as_ref().map_or(f64::NAN, |v| v[(i, i)].sqrt());
            let (low, high) = self.interval(i, sigma);
            let value = c.value(self.x[i]);
            let interval = (low, value + (high - value).hypot(q.understated * value));
            (*q, c.value(self.x[i]), interval)
        })
        .collect()
    }

    /// `mu` (MPa) and `alpha`, each with its 95 % interval, widened by unseen effects where these were asked for.
    #[must_use]
    pub fn base(&self) -> [(f64, (f64, f64)); 2] {
        let covariance = self.covariance();
        std::array::from_fn(|i| {
            let sigma = covariance.as_ref().map_or(f64::NAN, |v| v[(i, i)].sqrt());
            (self.coordinates[i].value(self.x[i]), self.interval(i, sigma))
        })
    }

    /// The same with the intervals that noise alone makes.
    #[must_use]
    pub fn base_of_noise(&self) -> [(f64, (f64, f64)); 2] {
        let covariance = self.covariance();
        std::array::from_fn(|i| {
            let c = &self.coordinates[i];
            let sigma = covariance.as_ref().map_or(f64::NAN, |v| v[(i, i)].sqrt());
            (c.value(self.x[i]), c.interval(self.x[i], self.reach[i] * sigma))
        })
    }

    /// The 95 % interval of a parameter whose standard deviation from noise is given: it lies where the data put the parameter with unseen effects free, and holds the point itself.
    fn interval(&self, at: usize, sigma: f64) -> (f64, f64) {
        let (c, x, noise) = (&self.coordinates[at], self.x[at], self.reach[at] * sigma);
        let Some(unseen) = &self.unseen else { return c.interval(x, noise) };
        let half = noise.hypot(Z95 * unseen.added[at].sqrt());
        let (least, most) = c.bounds();
        let (low, high) = c.interval((x + unseen.shift[at]).clamp(least, most), half);
        (low.min(c.value(x)), high.max(c.value(x)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Parts of both terms count, times do not, nor do amounts of what does not relax.
    #[test]
    fn parts_that_relax_add_up() {
        let candidates =
            [&relaxation::TWO, &lut_gen::effect::compliance::EFFECT].map(|effect| Candidate { effect, owner: 0 });
        let two = relaxation::TWO.quantities.iter().map(|q| Coordinate::Of(0, *q));
        let one = candidates[1].effect.quantities.iter().map(|q| Coordinate::Of(1, *q));
        let list: Vec<Coordinate> = [Coordinate::LnMu, Coordinate::LnAlpha].into_iter().chain(two).chain(one).collect();
        let values = [0.2, 8.0, 0.156, 0.05, 0.889, 9.5, 0.5];
        let x = DVector::from_fn(list.len(), |i, _| list[i].of(values[i]));
        assert!((relaxing_part(&model(&list, &candidates, &x)) - 1.045).abs() < 1e-12);
        assert!(relaxing_part(&model(&list[..2], &[], &x)).abs() < 1e-12);
    }
}
