//! The problem all rivals are given: least squares over ln mu, alpha and the contact point of every run, in a unit cube.

use std::cell::RefCell;

use nalgebra::{DMatrix, DVector};

use crate::identify::data::{Height, LoadingCurve, Selection};
use crate::identify::model::{ForwardModel, Shape, UnitCurve};
use crate::infer::descent::Quadratic;

/// Nodes over ln alpha: the cubic between them is within 1e-8 of the force of the interpolated model.
const NODES: usize = 97;
/// Step of a difference quotient in the unit cube: the square root of the rounding error of the objective.
const QUOTIENT: f64 = 1e-7;
/// The modulus is searched this factor beyond what single exponents ask for, as MultiStart does.
const MODULUS_FACTOR: f64 = 3.0;

/// What rivals search: differences over a unit cube.
pub trait Ground: Sync {
    /// Number of coordinates.
    fn dimension(&self) -> usize;
    /// Number of samples.
    fn samples(&self) -> usize;
    /// Forward problems: what one evaluation would cost in finite-element solves.
    fn conditions(&self) -> usize;
    /// What the coordinates are.
    fn coordinates_in_words(&self) -> &'static str;
    /// Parameters of a point of the cube, with their names.
    fn named(&self, u: &[f64]) -> Vec<(String, f64)>;
    /// Differences of all samples, each relative to the largest force of its run; coordinates outside the cube are moved to its wall.
    fn residuals(&self, u: &[f64]) -> Vec<f64>;
}

/// Recordings seen through a table of unit curves.
pub struct Landscape {
    runs: Vec<LoadingCurve>,
    /// Largest force of each run, N: differences count relative to it.
    peaks_n: Vec<f64>,
    ln_alpha: (f64, f64),
    /// `curves[pairing][node]`.
    curves: Vec<Vec<UnitCurve>>,
    low: Vec<f64>,
    high: Vec<f64>,
}

/// Position of the coordinates; contact points follow.
const LN_MU: usize = 0;
const ALPHA: usize = 1;
const FIRST_CONTACT: usize = 2;

impl Landscape {
    /// Tabulates a model for the fitted curves of a selection; `None` if no material pushes back like these data. All heights must
    /// be known: a free one is taken as the middle of its range.
    #[must_use]
    pub fn new(selection: &Selection, model: &dyn ForwardModel) -> Option<Self> {
        let runs: Vec<LoadingCurve> = selection.curves.iter().filter(|curve| !curve.hold_out).cloned().collect();
        let (alpha_low, alpha_high) = model.alpha_bounds();
        let ln_alpha = (alpha_low.ln(), alpha_high.ln());
        let height_mm = |height: Height| match height {
            Height::Known(mm) => mm,
            Height::Free(at) => 0.5 * (selection.heights[at].low_mm + selection.heights[at].high_mm),
        };
        let node = |i: usize| (ln_alpha.0 + (ln_alpha.1 - ln_alpha.0) * i as f64 / (NODES - 1) as f64).exp();
        let curves: Vec<Vec<UnitCurve>> = selection
            .pairings
            .iter()
            .enumerate()
            .map(|(at, pairing)| {
                let shape = |i: usize| Shape {
                    alpha: node(i).clamp(alpha_low, alpha_high),
                    height_mm: height_mm(pairing.height),
                };
                (0..NODES).map(|i| model.curve(at, shape(i))).collect()
            })
            .collect();
        let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
        for i in [0, NODES / 4, NODES / 2, NODES - 1] {
            let of_node: Vec<UnitCurve> = curves.iter().map(|nodes| nodes[i].clone()).collect();
            if let Some(mu) = best_mu(selection, &of_node) {
                (least, most) = (least.min(mu), most.max(mu));
            }
        }
        if runs.is_empty() || most <= 0.0 {
            return None;
        }
        let mut low = vec![(least / MODULUS_FACTOR).ln(), alpha_low];
        let mut high = vec![(most * MODULUS_FACTOR).ln(), alpha_high];
        low.extend(runs.iter().map(|run| run.contact.low_mm));
        high.extend(runs.iter().map(|run| run.contact.high_mm));
        let peak = |run: &LoadingCurve| run.force_n.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        let peaks_n = runs.iter().map(peak).collect();
        Some(Self { runs, peaks_n, ln_alpha, curves, low, high })
    }

    fn physical(&self, u: &[f64]) -> Vec<f64> {
        u.iter()
            .zip(self.low.iter().zip(&self.high))
            .map(|(u, (low, high))| low + u.clamp(0.0, 1.0) * (high - low))
            .collect()
    }
}

impl Ground for Landscape {
    fn dimension(&self) -> usize {
        self.low.len()
    }

    fn samples(&self) -> usize {
        self.runs.iter().map(|run| run.force_n.len()).sum()
    }

    fn conditions(&self) -> usize {
        let mut pairings: Vec<usize> = self.runs.iter().map(|run| run.pairing).collect();
        pairings.sort_unstable();
        pairings.dedup();
        pairings.len()
    }

    fn coordinates_in_words(&self) -> &'static str {
        "ln mu, alpha, and the contact point of every run"
    }

    fn named(&self, u: &[f64]) -> Vec<(String, f64)> {
        let x = self.physical(u);
        vec![("mu_MPa".to_owned(), x[LN_MU].exp()), ("alpha".to_owned(), x[ALPHA])]
    }

    fn residuals(&self, u: &[f64]) -> Vec<f64> {
        let x = self.physical(u);
        let mu_mpa = x[LN_MU].exp();
        let place = (x[ALPHA].ln() - self.ln_alpha.0) / (self.ln_alpha.1 - self.ln_alpha.0) * (NODES - 1) as f64;
        let first = (place as usize).saturating_sub(1).min(NODES - 4);
        let t = place - first as f64;
        let (t1, t2, t3) = (t - 1.0, t - 2.0, t - 3.0);
        let weights = [-t1 * t2 * t3 / 6.0, t * t2 * t3 / 2.0, -t * t1 * t3 / 2.0, t * t1 * t2 / 6.0];
        let mut residuals = Vec::with_capacity(self.samples());
        for (at, run) in self.runs.iter().enumerate() {
            let curves = &self.curves[run.pairing][first..first + 4];
            let scale = 1.0 / self.peaks_n[at];
            for (depth, force) in run.depth_mm.iter().zip(&run.force_n) {
                let depth_mm = depth - x[FIRST_CONTACT + at];
                let unit: f64 = curves.iter().zip(weights).map(|(curve, weight)| weight * curve.at(depth_mm)).sum();
                residuals.push((force - mu_mpa * unit) * scale);
            }
        }
        residuals
    }
}

/// The mu with the least sum of absolute differences for given curves and contact points, exactly:
/// the median of force / unit force, weighted by unit force, because mu is linear.
fn best_mu(selection: &Selection, curves: &[UnitCurve]) -> Option<f64> {
    let mut ratios: Vec<(f64, f64)> = Vec::new();
    for data in selection.curves.iter().filter(|curve| !curve.hold_out) {
        for (depth, force) in data.depth_mm.iter().zip(&data.force_n) {
            let unit = curves[data.pairing].at(depth - data.contact.contact_mm);
            if unit > 0.0 {
                ratios.push((force / unit, unit));
            }
        }
    }
    ratios.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = 0.5 * ratios.iter().map(|(_, weight)| weight).sum::<f64>();
    let mut sum = 0.0;
    let at = ratios.iter().position(|(_, weight)| {
        sum += weight;
        sum >= half
    })?;
    Some(ratios[at].0).filter(|mu| *mu > 0.0 && mu.is_finite())
}

/// A landscape that counts what is asked of it.
pub struct Counted<'a> {
    /// The landscape.
    pub landscape: &'a dyn Ground,
    trace: RefCell<Trace>,
}

/// What a search has done so far.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Trace {
    /// Evaluations.
    pub evaluations: usize,
    /// Every improvement: evaluations so far, and the objective.
    pub improvements: Vec<(usize, f64)>,
    /// Best point.
    pub best: Vec<f64>,
}

impl<'a> Counted<'a> {
    /// Nothing asked yet.
    #[must_use]
    pub fn new(landscape: &'a dyn Ground) -> Self {
        Self { landscape, trace: RefCell::default() }
    }

    /// What was asked.
    #[must_use]
    pub fn into_trace(self) -> Trace {
        self.trace.into_inner()
    }

    /// Evaluations so far.
    #[must_use]
    pub fn evaluations(&self) -> usize {
        self.trace.borrow().evaluations
    }

    /// Mean square of the differences; one evaluation.
    pub fn value(&self, u: &[f64]) -> f64 {
        mean_square(&self.counted(u))
    }

    fn counted(&self, u: &[f64]) -> Vec<f64> {
        let residuals = self.landscape.residuals(u);
        let value = mean_square(&residuals);
        let mut trace = self.trace.borrow_mut();
        trace.evaluations += 1;
        if trace.improvements.last().is_none_or(|(_, best)| value < *best) {
            let at = trace.evaluations;
            trace.improvements.push((at, value));
            trace.best = u.iter().map(|u| u.clamp(0.0, 1.0)).collect();
        }
        residuals
    }

    /// As [`Counted::value`], with points outside the cube mirrored at its walls: for methods that know no bounds.
    pub fn mirrored(&self, u: &[f64]) -> f64 {
        self.value(&inside(u))
    }

    /// Gradient by forward quotients, one evaluation a coordinate, of which `value` is the foot.
    pub fn gradient(&self, u: &[f64], value: f64) -> Vec<f64> {
        self.shifted(u, &|point, step| (self.value(point) - value) / step)
    }

    /// Gradient of [`Counted::mirrored`], its foot included in the count.
    pub fn mirrored_gradient(&self, u: &[f64]) -> Vec<f64> {
        let value = self.mirrored(u);
        let moved = |axis: usize| {
            let mut point = u.to_vec();
            point[axis] += QUOTIENT;
            (self.mirrored(&point) - value) / QUOTIENT
        };
        (0..u.len()).map(moved).collect()
    }

    fn shifted<T>(&self, u: &[f64], of: &dyn Fn(&[f64], f64) -> T) -> Vec<T> {
        let one = |axis: usize| {
            let mut point = u.to_vec();
            // Inward at the upper wall.
            let step = if point[axis] + QUOTIENT <= 1.0 { QUOTIENT } else { -QUOTIENT };
            point[axis] += step;
            of(&point, step)
        };
        (0..u.len()).map(one).collect()
    }

    /// The Gauss-Newton model. With sensitivities the slopes come with the value; otherwise each costs an evaluation, and none is
    /// spent at a point that is worse than `best`, because no step starts there.
    pub fn quadratic(&self, u: &[f64], sensitivities: bool, best: f64) -> Quadratic {
        let count = u.len();
        let residuals = self.counted(u);
        let value = mean_square(&residuals);
        let mut model = Quadratic { value, gradient: DVector::zeros(count), hessian: DMatrix::zeros(count, count) };
        if !sensitivities && value > best {
            return model;
        }
        let columns = self.shifted(u, &|point, step| {
            let moved = if sensitivities { self.landscape.residuals(point) } else { self.counted(point) };
            DVector::from_iterator(moved.len(), moved.iter().zip(&residuals).map(|(m, r)| (m - r) / step))
        });
        let jacobian = DMatrix::from_columns(&columns);
        let scale = 1.0 / residuals.len() as f64;
        model.gradient = jacobian.tr_mul(&DVector::from_vec(residuals)) * scale;
        model.hessian = jacobian.tr_mul(&jacobian) * scale;
        model
    }
}

fn mean_square(residuals: &[f64]) -> f64 {
    residuals.iter().map(|r| r * r).sum::<f64>() / residuals.len().max(1) as f64
}

/// Mirrors a point at the walls of the unit cube.
#[must_use]
pub fn inside(u: &[f64]) -> Vec<f64> {
    u.iter()
        .map(|u| {
            let folded = u.rem_euclid(2.0);
            // A search that has run off to infinity is brought to a wall.
            if !folded.is_finite() {
                0.0
            } else if folded > 1.0 {
                2.0 - folded
            } else {
                folded
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::inside;

    #[test]
    fn walls_mirror() {
        let folded = inside(&[0.25, 1.25, -0.25, 2.25, f64::INFINITY]);
        assert_eq!(folded, [0.25, 0.75, 0.25, 0.25, 0.0]);
    }
}
