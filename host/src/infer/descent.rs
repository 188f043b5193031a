//! Levenberg-Marquardt inside a box (Marquardt 1963, doi:10.1137/0111030) with a gain ratio (Nielsen 1999, IMM-REP-1999-05) and an active set, on anything
//! that gives a sum of squares with its Gauss-Newton approximation.

use std::cell::OnceCell;

use nalgebra::{DMatrix, DVector};

use super::covariance::Factor;
use super::product::inner;

/// Objective with half its gradient and half its Gauss-Newton Hessian.
#[derive(Debug, Clone, PartialEq)]
pub struct Quadratic {
    /// Weighted sum of squares.
    pub value: f64,
    /// Half the gradient.
    pub gradient: DVector<f64>,
    /// Half the Hessian, without second derivatives of the model.
    pub hessian: DMatrix<f64>,
}

impl Quadratic {
    /// Of whitened residuals (measured less predicted) and the derivative of the prediction.
    #[must_use]
    pub fn of(residual: &DVector<f64>, jacobian: &DMatrix<f64>) -> Self {
        Self {
            value: residual.norm_squared(),
            gradient: -jacobian.tr_mul(residual),
            hessian: inner(jacobian, jacobian),
        }
    }
}

/// A box, and a coordinate that may not move.
#[derive(Debug, Clone, PartialEq)]
pub struct Region {
    /// Lower corner.
    pub low: Vec<f64>,
    /// Upper corner.
    pub high: Vec<f64>,
    /// A coordinate that is held.
    pub held: Option<usize>,
}

impl Region {
    /// From the ends of every coordinate.
    #[must_use]
    pub fn of(ends: impl IntoIterator<Item = (f64, f64)>) -> Self {
        let (low, high) = ends.into_iter().unzip();
        Self { low, high, held: None }
    }

    /// The nearest point inside. An end that is no number holds nothing back.
    #[must_use]
    pub fn inside(&self, x: &[f64]) -> Vec<f64> {
        x.iter().zip(self.low.iter().zip(&self.high)).map(|(x, (low, high))| x.max(*low).min(*high)).collect()
    }

    fn width(&self, axis: usize) -> f64 {
        (self.high[axis] - self.low[axis]).max(f64::MIN_POSITIVE)
    }

    /// True where the coordinate may move at this gradient: it is not held, and does not press against an end.
    fn is_free(&self, axis: usize, x: f64, gradient: f64) -> bool {
        let out_low = x <= self.low[axis] && gradient > 0.0;
        let out_high = x >= self.high[axis] && gradient < 0.0;
        Some(axis) != self.held && !out_low && !out_high && self.high[axis] > self.low[axis]
    }
}

/// A sum of squares, or another loss with a Gauss-Newton approximation.
pub trait Objective {
    /// What an evaluation keeps, so that its slopes cost less.
    type Kept;

    /// The objective at a point. A point that cannot be has an infinite value, or none (NaN).
    fn value(&self, x: &[f64]) -> (f64, Self::Kept);

    /// Half the gradient and half the Gauss-Newton Hessian at a point that was evaluated.
    fn slopes(&self, x: &[f64], kept: &Self::Kept) -> Quadratic;
}

/// An objective whose value and slopes come together.
pub struct Together<F>(pub F);

impl<F: Fn(&[f64]) -> Quadratic> Objective for Together<F> {
    type Kept = Quadratic;

    fn value(&self, x: &[f64]) -> (f64, Quadratic) {
        let all = (self.0)(x);
        (all.value, all)
    }

    fn slopes(&self, _: &[f64], kept: &Quadratic) -> Quadratic {
        kept.clone()
    }
}

/// Whitened residuals (measured less predicted) of a point, and the derivative of the prediction there.
pub struct Residuals<R, J> {
    /// Residuals of a point.
    pub residual: R,
    /// Derivative of the prediction by every coordinate, from a point and its residuals.
    pub jacobian: J,
}

/// Residuals of a point that was evaluated, with their derivative where that was asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Evaluated {
    /// Whitened residuals.
    pub residual: DVector<f64>,
    /// Derivative of the prediction.
    jacobian: OnceCell<DMatrix<f64>>,
}

impl Evaluated {
    /// Residuals, and the derivative of the prediction; that is there wherever a search ended. Without rows where it was never asked for.
    #[must_use]
    pub fn into_parts(self) -> (DVector<f64>, DMatrix<f64>) {
        (self.residual, self.jacobian.into_inner().unwrap_or_else(|| DMatrix::zeros(0, 0)))
    }
}

impl<R, J> Objective for Residuals<R, J>
where
    R: Fn(&[f64]) -> DVector<f64>,
    J: Fn(&[f64], &DVector<f64>) -> DMatrix<f64>,
{
    type Kept = Evaluated;

    fn value(&self, x: &[f64]) -> (f64, Evaluated) {
        let residual = (self.residual)(x);
        (residual.norm_squared(), Evaluated { residual, jacobian: OnceCell::new() })
    }

    fn slopes(&self, x: &[f64], kept: &Evaluated) -> Quadratic {
        let jacobian = kept.jacobian.get_or_init(|| (self.jacobian)(x, &kept.residual));
        Quadratic::of(&kept.residual, jacobian)
    }
}

/// When a search ends.
#[derive(Debug, Clone, PartialEq)]
pub struct Rule {
    /// Most steps that are tried.
    pub most_steps: usize,
    /// Gain of an accepted step below which the search has settled, in units of the objective.
    pub settled: f64,
    /// The same as a share of the objective.
    pub settled_share: f64,
    /// Value that another search has come to: one that steps like the last would not bring there is left.
    pub rival: Option<f64>,
}

impl Default for Rule {
    /// To the end: chi-squared to a ten-billionth of itself.
    fn default() -> Self {
        Self { most_steps: 100, settled: 0.0, settled_share: 1e-10, rival: None }
    }
}

/// Why a search ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ending {
    /// The projected gradient vanished: a Newton step promises nothing.
    Stationary,
    /// The last step gained less than asked for.
    Settled,
    /// No step gains, however short: the objective is rougher than its slopes say.
    Stalled,
    /// All steps were spent.
    OutOfSteps,
    /// Another search is far ahead.
    Outdone,
    /// The objective has no value at the start.
    Impossible,
}

/// Where a search ended.
#[derive(Debug, Clone, PartialEq)]
pub struct Descent<K> {
    /// The point.
    pub x: Vec<f64>,
    /// Objective there.
    pub value: f64,
    /// What its evaluation kept.
    pub kept: K,
    /// Its Gauss-Newton approximation there.
    pub at: Quadratic,
    /// Steps that were tried.
    pub steps: usize,
    /// Why it ended.
    pub ending: Ending,
    /// What a Newton step over the coordinates that are free promises to gain, in units of the objective: the length of the projected gradient.
    pub promised: f64,
}

/// Where a search ended, without what its evaluation kept.
#[derive(Debug, Clone, PartialEq)]
pub struct Minimum {
    /// The point.
    pub x: Vec<f64>,
    /// Objective and its model there.
    pub at: Quadratic,
    /// Steps tried.
    pub steps: usize,
    /// Why it ended.
    pub ending: Ending,
    /// What a Newton step promises to gain, in units of the objective.
    pub promised: f64,
}

impl<K> From<Descent<K>> for Minimum {
    fn from(end: Descent<K>) -> Self {
        Self { x: end.x, at: end.at, steps: end.steps, ending: end.ending, promised: end.promised }
    }
}

const FIRST_DAMPING: f64 = 1e-3;
const LEAST_DAMPING: f64 = 1e-12;
const MOST_DAMPING: f64 = 1e10;
/// A step shorter than this share of every range is none.
const STILL: f64 = 1e-12;
/// A promise below this share of the objective, or below this in its units, is rounding.
const STATIONARY_SHARE: f64 = 1e-11;
const STATIONARY: f64 = 1e-12;
/// A search is left after so many gains, where so many like the last would not bring it to its rival.
const TRIED: usize = 4;
const AHEAD: f64 = 20.0;

/// Minimises from a start, which is moved into the region.
pub fn minimise<O: Objective + ?Sized>(objective: &O, region: &Region, start: &[f64], rule: &Rule) -> Descent<O::Kept> {
    let mut x = region.inside(start);
    let (mut value, mut kept) = objective.value(&x);
    let mut at = objective.slopes(&x, &kept);
    let mut ending = if value.is_finite() { Ending::OutOfSteps } else { Ending::Impossible };
    let (mut damping, mut growth, mut gains, mut steps) = (FIRST_DAMPING, 2.0, 0, 0);
    while steps < rule.most_steps && value.is_finite() {
        if promised(&x, &at, region) <= STATIONARY.max(STATIONARY_SHARE * value.abs()) {
            ending = Ending::Stationary;
            break;
        }
        steps += 1;
        let tried = step(&x, &at, region, damping).map(|next| {
            let (there, its) = objective.value(&next);
            (next, there, its)
        });
        let ratio = tried.as_ref().map_or(f64::NEG_INFINITY, |(next, there, _)| {
            let model = expected(&x, next, &at);
            if there.is_finite() && model > 0.0 { (value - there) / model } else { f64::NEG_INFINITY }
        });
        match tried {
            Some((next, there, its)) if ratio > 0.0 && there < value => {
                let gain = value - there;
                (x, value, kept) = (next, there, its);
                gains += 1;
                damping = (damping * (1.0 - (2.0 * ratio - 1.0).powi(3)).clamp(0.1, 1.0)).max(LEAST_DAMPING);
                growth = 2.0;
                at = objective.slopes(&x, &kept);
                if gain <= rule.settled.max(rule.settled_share * value) {
                    ending = Ending::Settled;
                    break;
                }
                if gains >= TRIED && rule.rival.is_some_and(|rival| AHEAD * gain < value - rival) {
                    ending = Ending::Outdone;
                    break;
                }
            }
            tried => {
                let moved = tried.map_or(f64::INFINITY, |(next, ..)| length(&x, &next, region));
                if moved < STILL || damping > MOST_DAMPING {
                    ending = Ending::Stalled;
                    break;
                }
                damping *= growth;
                growth *= 2.0;
            }
        }
    }
    let promised = promised(&x, &at, region);
    Descent { x, value, kept, at, steps, ending, promised }
}

/// What the model of the objective says a step gains.
fn expected(from: &[f64], to: &[f64], at: &Quadratic) -> f64 {
    let step = DVector::from_fn(from.len(), |i, _| to[i] - from[i]);
    -2.0 * at.gradient.dot(&step) - step.dot(&(&at.hessian * &step))
}

/// Longest part of a step, as a share of its range.
fn length(from: &[f64], to: &[f64], region: &Region) -> f64 {
    from.iter().zip(to).enumerate().map(|(i, (a, b))| (a - b).abs() / region.width(i)).fold(0.0, f64::max)
}

/// What a Newton step over the free coordinates promises to gain: `g' H^-1 g`, the projected gradient in units of the objective. Where the Hessian is singular
/// the gradient along each coordinate alone stands for it.
#[must_use]
pub fn promised(x: &[f64], at: &Quadratic, region: &Region) -> f64 {
    let free: Vec<usize> = (0..x.len()).filter(|&i| region.is_free(i, x[i], at.gradient[i])).collect();
    let gradient = DVector::from_fn(free.len(), |i, _| at.gradient[free[i]]);
    let hessian = DMatrix::from_fn(free.len(), free.len(), |i, j| at.hessian[(free[i], free[j])]);
    if free.is_empty() {
        return 0.0;
    }
    match Factor::of(&hessian) {
        Some(factor) => gradient.dot(&factor.solve(&gradient)),
        None => free
            .iter()
            .map(|&i| at.gradient[i].powi(2) / at.hessian[(i, i)].max(f64::MIN_POSITIVE))
            .filter(|promise| promise.is_finite())
            .sum(),
    }
}

/// A damped step; coordinates that would leave the region through an end they stand at are held.
fn step(x: &[f64], at: &Quadratic, region: &Region, damping: f64) -> Option<Vec<f64>> {
    let mut free: Vec<usize> = (0..x.len()).filter(|&i| region.is_free(i, x[i], at.gradient[i])).collect();
    // Holding a coordinate at the end that the step runs into changes the step of the others.
    for _ in 0..x.len() {
        if free.is_empty() {
            return None;
        }
        let n = free.len();
        let hessian = DMatrix::from_fn(n, n, |i, j| {
            let h = at.hessian[(free[i], free[j])];
            if i == j { h * (1.0 + damping) + f64::MIN_POSITIVE } else { h }
        });
        let gradient = DVector::from_fn(n, |i, _| at.gradient[free[i]]);
        let move_by = hessian.cholesky()?.solve(&(-gradient));
        let mut next = x.to_vec();
        let mut leaving = Vec::new();
        for (i, &axis) in free.iter().enumerate() {
            next[axis] += move_by[i];
            if next[axis] < region.low[axis] || next[axis] > region.high[axis] {
                next[axis] = next[axis].max(region.low[axis]).min(region.high[axis]);
                leaving.push(axis);
            }
        }
        let stands = |axis: &usize| x[*axis] <= region.low[*axis] || x[*axis] >= region.high[*axis];
        if leaving.iter().any(stands) {
            free.retain(|axis| !(leaving.contains(axis) && stands(axis)));
            continue;
        }
        return next.iter().all(|v| v.is_finite()).then_some(next);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rosenbrock's valley as residuals 10 (y - x^2) and 1 - x.
    fn valley(p: &[f64]) -> Quadratic {
        let r = DVector::from_vec(vec![10.0 * (p[1] - p[0] * p[0]), 1.0 - p[0]]);
        let j = DMatrix::from_row_slice(2, 2, &[-20.0 * p[0], 10.0, -1.0, 0.0]);
        Quadratic { value: r.norm_squared(), gradient: j.transpose() * &r, hessian: j.transpose() * j }
    }

    fn region(low: f64, high: f64) -> Region {
        Region { low: vec![low; 2], high: vec![high; 2], held: None }
    }

    fn ended(region: &Region, start: &[f64]) -> Descent<Quadratic> {
        minimise(&Together(valley), region, start, &Rule::default())
    }

    #[test]
    fn the_valley_is_followed_to_its_end() {
        let end = ended(&region(-3.0, 3.0), &[-1.2, 1.0]);
        // What is promised at the end is below STATIONARY, and so is what is left.
        assert!(end.value < 2.0 * STATIONARY && (end.x[0] - 1.0).abs() < 1e-5, "{end:?}");
        assert_eq!(end.ending, Ending::Stationary);
        assert!(end.steps < 40, "{}", end.steps);
    }

    #[test]
    fn a_wall_and_a_held_coordinate_are_kept() {
        // Inside x <= 0.5 the best is at the wall, y = x^2.
        let end = ended(&region(-3.0, 0.5), &[-1.2, 0.4]);
        assert!((end.x[0] - 0.5).abs() < 1e-9 && (end.x[1] - 0.25).abs() < 1e-6, "{end:?}");
        assert!(end.promised < 1e-9, "{end:?}");
        let held = Region { held: Some(0), ..region(-3.0, 3.0) };
        let end = ended(&held, &[0.7, 2.0]);
        assert!(end.x[0] == 0.7 && (end.x[1] - 0.49).abs() < 1e-6, "{end:?}");
    }

    /// `converged` can be wrong only where the slopes are: a gradient that is left is told.
    #[test]
    fn an_end_that_is_none_says_so() {
        let short = Rule { most_steps: 2, ..Rule::default() };
        let end = minimise(&Together(valley), &region(-3.0, 3.0), &[-1.2, 1.0], &short);
        assert!(end.ending == Ending::OutOfSteps && end.promised > 1e-3, "{end:?}");
        let nowhere = |_: &[f64]| Quadratic { value: f64::NAN, ..valley(&[0.0, 0.0]) };
        let end = minimise(&Together(nowhere), &region(-3.0, 3.0), &[0.0, 0.0], &Rule::default());
        assert_eq!(end.ending, Ending::Impossible);
        // Slopes of another function lead nowhere.
        let wrong = |p: &[f64]| Quadratic { gradient: -valley(p).gradient, ..valley(p) };
        let end = minimise(&Together(wrong), &region(-3.0, 3.0), &[0.3, 0.5], &Rule::default());
        assert!(end.ending == Ending::Stalled && end.promised > 1e-3, "{end:?}");
    }

    #[test]
    fn a_search_far_behind_its_rival_is_left() {
        // A long straight slope whose every step gains the same little.
        let slope = |p: &[f64]| Quadratic {
            value: 1e4 - p[0],
            gradient: DVector::from_element(1, -0.5),
            hessian: DMatrix::from_element(1, 1, 1.0),
        };
        let long = Region { low: vec![0.0], high: vec![1e6], held: None };
        let rule = Rule { rival: Some(0.0), ..Rule::default() };
        let end = minimise(&Together(slope), &long, &[0.0], &rule);
        assert!(end.ending == Ending::Outdone && end.steps == 4, "{end:?}");
    }

    #[test]
    fn residuals_and_their_derivative_are_the_same_objective() {
        let residuals = Residuals {
            residual: |p: &[f64]| DVector::from_vec(vec![10.0 * (p[1] - p[0] * p[0]), 1.0 - p[0]]),
            jacobian: |p: &[f64], _: &DVector<f64>| DMatrix::from_row_slice(2, 2, &[20.0 * p[0], -10.0, 1.0, 0.0]),
        };
        let end = minimise(&residuals, &region(-3.0, 3.0), &[-1.2, 1.0], &Rule::default());
        assert_eq!(end.x, ended(&region(-3.0, 3.0), &[-1.2, 1.0]).x);
        let (residual, jacobian) = end.kept.into_parts();
        assert!((residual.norm_squared() - end.value).abs() < 1e-20);
        assert_eq!(jacobian[(0, 0)], 20.0 * end.x[0]);
    }
}
