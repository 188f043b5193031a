//! How well a model explains data, all of its parameters and the size of its discrepancy
//! integrated: the logarithm of its marginal likelihood.
//!
//! ```text
//! r = J d + K b + sum_g a_g Z_g c_g + e,     b, c, e ~ N(0, I)
//! ```
//! `K b` is error of known size; `Z_g c_g` are smooth discrepancies whose sizes `a_g` have a prior
//! that allows for none at all. Parameters have flat or heavy-tailed priors. The integral over
//! parameters is Laplace's, at the point that the linearised model puts them at once the
//! discrepancy is allowed for. Sizes are those of the highest posterior on a grid, again for each
//! model.

use nalgebra::{DMatrix, DVector};

use super::covariance::Factor;
use super::product::inner;

/// What is known of a parameter before the data.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Prior {
    /// Nothing, and the same in all models that are compared.
    Flat,
    /// A Cauchy distribution about a null value with this scale: mostly small, and once in a while
    /// large.
    Cauchy {
        /// The null value.
        null: f64,
        /// Half of all amounts are smaller.
        scale: f64,
    },
    /// A normal distribution.
    Normal {
        /// Its mean.
        mean: f64,
        /// Its standard deviation.
        deviation: f64,
    },
}

impl Prior {
    /// Logarithm of its density; 0 where it is flat.
    #[must_use]
    pub fn log_density(&self, x: f64) -> f64 {
        use std::f64::consts::{PI, TAU};
        match *self {
            Prior::Flat => 0.0,
            Prior::Cauchy { null, scale } => -(PI * scale).ln() - ((x - null) / scale).powi(2).ln_1p(),
            Prior::Normal { mean, deviation } => -0.5 * (TAU.ln() + ((x - mean) / deviation).powi(2)) - deviation.ln(),
        }
    }

    /// Centre and weight of the square that touches `-2 ln p` at a point and is nowhere below it.
    fn square(&self, x: f64) -> (f64, f64) {
        match *self {
            Prior::Flat => (x, 0.0),
            Prior::Cauchy { null, scale } => (null, 2.0 / (scale * scale + (x - null).powi(2))),
            Prior::Normal { mean, deviation } => (mean, deviation.powi(-2)),
        }
    }
}

/// A parameter of a model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// Where the model is linearised.
    pub x: f64,
    /// Least and largest value.
    pub bounds: (f64, f64),
    /// What is known of it.
    pub prior: Prior,
}

/// A model linearised at a point. Rows are whitened by the noise.
#[derive(Debug, Clone)]
pub struct Linearised<'a> {
    /// Measured less predicted.
    pub residual: &'a DVector<f64>,
    /// Derivative of the prediction, a column for each parameter.
    pub jacobian: &'a DMatrix<f64>,
    /// Parameters.
    pub parameters: Vec<Parameter>,
    /// Columns of errors of known size, of unit deviation.
    pub known: &'a DMatrix<f64>,
}

/// Sizes that a discrepancy may have, with their prior probabilities. The first is none.
#[derive(Debug, Clone, PartialEq)]
pub struct Sizes(Vec<(f64, f64)>);

/// Probability that a discrepancy of a group is none.
const NONE: f64 = 0.5;

impl Sizes {
    /// None with even chances, else about `median` (log-normal) with a factor `e^spread` to either
    /// side; seven sizes, up to three such factors above.
    #[must_use]
    pub fn about(median: f64, spread: f64) -> Self {
        let steps = [-1.5, -0.75, 0.0, 0.75, 1.5, 2.25, 3.0];
        let weights = steps.map(|z: f64| (-0.5 * z * z).exp());
        let sum: f64 = weights.iter().sum();
        let sizes = steps.iter().zip(weights).map(|(z, w)| (median * (spread * z).exp(), (1.0 - NONE) * w / sum));
        Self(std::iter::once((0.0, NONE)).chain(sizes).collect())
    }
}

/// Discrepancies: whitened columns a group, for a size of one.
#[derive(Debug, Clone)]
pub struct Discrepancy<'a> {
    /// Columns of every group.
    pub groups: &'a [DMatrix<f64>],
    /// What sizes they may have.
    pub sizes: &'a Sizes,
}

/// What a model comes to.
#[derive(Debug, Clone, PartialEq)]
pub struct Evidence {
    /// Logarithm of the marginal likelihood, up to what all models of the same rows and base share.
    pub log: f64,
    /// Size of every group of discrepancies.
    pub sizes: Vec<f64>,
    /// Where the parameters are with these allowed for.
    pub x: Vec<f64>,
}

/// Products of all columns: what an evaluation needs of the rows.
struct Products {
    /// Of `[J r]` among themselves.
    own: DMatrix<f64>,
    /// Of `[K Z]` with `[J r]`.
    across: DMatrix<f64>,
    /// Of `[K Z]` among themselves.
    errors: DMatrix<f64>,
    /// Group of every column of `[K Z]`; none for `K`.
    group: Vec<Option<usize>>,
}

/// Rounds over the groups in which their sizes follow each other.
const SWEEPS: usize = 3;
/// Steps in which parameters and their priors' squares follow each other.
const STEPS: usize = 8;

impl Products {
    fn of(model: &Linearised<'_>, groups: &[DMatrix<f64>]) -> Self {
        let rows = model.residual.len();
        let beside = |parts: &[&DMatrix<f64>]| {
            let mut all = DMatrix::zeros(rows, parts.iter().map(|p| p.ncols()).sum());
            let mut at = 0;
            for part in parts {
                all.columns_mut(at, part.ncols()).copy_from(*part);
                at += part.ncols();
            }
            all
        };
        let residual = DMatrix::from_column_slice(rows, 1, model.residual.as_slice());
        let told = beside(&[model.jacobian, &residual]);
        let errors: Vec<&DMatrix<f64>> = std::iter::once(model.known).chain(groups).collect();
        let errors = beside(&errors);
        let known = std::iter::repeat_n(None, model.known.ncols());
        let of_groups = groups.iter().enumerate().flat_map(|(at, z)| std::iter::repeat_n(Some(at), z.ncols()));
        Self {
            own: inner(&told, &told),
            across: inner(&errors, &told),
            errors: inner(&errors, &errors),
            group: known.chain(of_groups).collect(),
        }
    }

    /// `[J r]' C^-1 [J r]` and `ln det C` at some sizes; `None` where a number is none.
    fn at(&self, sizes: &[f64]) -> Option<(DMatrix<f64>, f64)> {
        let size = |at: usize| self.group[at].map_or(1.0, |group| sizes[group]);
        let there: Vec<usize> = (0..self.group.len()).filter(|at| size(*at) > 0.0).collect();
        if there.is_empty() {
            return Some((self.own.clone(), 0.0));
        }
        let n = there.len();
        let unit = |i: usize, j: usize| f64::from(u8::from(i == j));
        let whole = DMatrix::from_fn(n, n, |i, j| {
            unit(i, j) + size(there[i]) * size(there[j]) * self.errors[(there[i], there[j])]
        });
        let across = DMatrix::from_fn(n, self.across.ncols(), |i, j| size(there[i]) * self.across[(there[i], j)]);
        let factor = Factor::of(&whole)?;
        Some((&self.own - across.tr_mul(&factor.solve_all(&across)), factor.log_determinant()))
    }
}

/// Evidence of a model; `None` where a number is none or a parameter with a flat prior is not told
/// of at all.
#[must_use]
pub fn evidence(model: &Linearised<'_>, discrepancy: &Discrepancy<'_>) -> Option<Evidence> {
    let products = Products::of(model, discrepancy.groups);
    let all = &discrepancy.sizes.0;
    let groups = discrepancy.groups.len();
    let value = |chosen: &[usize]| -> Option<(f64, Vec<f64>)> {
        let sizes: Vec<f64> = chosen.iter().map(|at| all[*at].0).collect();
        let prior: f64 = chosen.iter().map(|at| all[*at].1.ln()).sum();
        let (told, determinant) = products.at(&sizes)?;
        let (log, x) = integrated(model, &told)?;
        Some((log + prior - 0.5 * determinant, x))
    };
    let mut chosen = vec![0; groups];
    let mut best = value(&chosen)?;
    for _ in 0..SWEEPS {
        let before = chosen.clone();
        for group in 0..groups {
            for size in 0..all.len() {
                let mut there = chosen.clone();
                there[group] = size;
                if there == chosen {
                    continue;
                }
                if let Some(found) = value(&there).filter(|found| found.0 > best.0) {
                    (best, chosen) = (found, there);
                }
            }
        }
        if chosen == before {
            break;
        }
    }
    let sizes = chosen.iter().map(|at| all[*at].0).collect();
    Some(Evidence { log: best.0, sizes, x: best.1 })
}

/// Laplace's integral over the parameters, `told` being `[J r]' C^-1 [J r]`: its logarithm, and
/// where the parameters are.
fn integrated(model: &Linearised<'_>, told: &DMatrix<f64>) -> Option<(f64, Vec<f64>)> {
    let n = model.parameters.len();
    let information = told.view((0, 0), (n, n)).into_owned();
    let said = told.view((0, n), (n, 1)).column(0).into_owned();
    let mut step = DVector::zeros(n);
    let mut hessian = information.clone();
    for _ in 0..STEPS {
        let squares: Vec<(f64, f64)> =
            model.parameters.iter().zip(step.iter()).map(|(p, d)| p.prior.square(p.x + d)).collect();
        hessian = information.clone();
        let mut right = said.clone();
        for (i, (parameter, (centre, weight))) in model.parameters.iter().zip(&squares).enumerate() {
            hessian[(i, i)] += weight;
            right[i] += weight * (centre - parameter.x);
        }
        let next = bounded(&model.parameters, &hessian, &right)?;
        let moved = (&next - &step).amax();
        step = next;
        if moved < 1e-9 {
            break;
        }
    }
    let left = told[(n, n)] - 2.0 * said.dot(&step) + step.dot(&(&information * &step));
    let x: Vec<f64> = model.parameters.iter().zip(step.iter()).map(|(p, d)| p.x + d).collect();
    let prior: f64 = model.parameters.iter().zip(&x).map(|(p, x)| p.prior.log_density(*x)).sum();
    let volume = n as f64 * std::f64::consts::TAU.ln() - Factor::of(&hessian)?.log_determinant();
    let log = -0.5 * left + prior + 0.5 * volume;
    log.is_finite().then_some((log, x))
}

/// The least of `d' H d - 2 b' d` in the bounds: what passes one stays on it, the others follow.
fn bounded(parameters: &[Parameter], hessian: &DMatrix<f64>, right: &DVector<f64>) -> Option<DVector<f64>> {
    let n = parameters.len();
    let mut held: Vec<Option<f64>> = vec![None; n];
    loop {
        let free: Vec<usize> = (0..n).filter(|i| held[*i].is_none()).collect();
        let mut step = DVector::from_fn(n, |i, _| held[i].unwrap_or(0.0));
        if !free.is_empty() {
            let part = DMatrix::from_fn(free.len(), free.len(), |i, j| hessian[(free[i], free[j])]);
            let pulled = hessian * &step;
            let own = DVector::from_fn(free.len(), |i, _| right[free[i]] - pulled[free[i]]);
            let solved = Factor::of(&part)?.solve(&own);
            free.iter().zip(solved.iter()).for_each(|(at, value)| step[*at] = *value);
        }
        let beyond = |i: &usize| {
            let Parameter { x, bounds: (low, high), .. } = parameters[*i];
            let there = x + step[*i];
            if there < low {
                Some((low - there, low - x))
            } else if there > high {
                Some((there - high, high - x))
            } else {
                None
            }
        };
        let scale = |i: usize| hessian[(i, i)].sqrt();
        let worst = free.iter().filter_map(|i| beyond(i).map(|(by, to)| (by * scale(*i), *i, to)));
        match worst.max_by(|a, b| a.0.total_cmp(&b.0)) {
            Some((_, i, to)) => held[i] = Some(to),
            None => return Some(step),
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    const ROWS: usize = 12;

    fn column(wave: f64) -> DVector<f64> {
        DVector::from_fn(ROWS, |i, _| (wave * i as f64 / (ROWS - 1) as f64).cos())
    }

    /// ln of the normal density of `r` in `I + a^2 Z Z'`, without the constant.
    fn density(residual: &DVector<f64>, z: &DMatrix<f64>, size: f64) -> f64 {
        let factor = (DMatrix::identity(ROWS, ROWS) + size * size * z * z.transpose()).cholesky().unwrap();
        let determinant: f64 = factor.l().diagonal().iter().map(|v| 2.0 * v.ln()).sum();
        -0.5 * (residual.dot(&factor.solve(residual)) + determinant)
    }

    /// Against the integral over a grid of both parameters, for amounts well seen, hardly seen and
    /// none.
    #[test]
    fn the_integral_is_that_of_nested_quadrature() {
        let (base, shape) = (column(1.0), 3.0 * column(4.0));
        let z = DMatrix::from_columns(&[column(2.5), column(6.0)]);
        let jacobian = DMatrix::from_columns(&[20.0 * &base, shape.clone()]);
        for amount in [0.0, 0.4, 3.0] {
            let residual = amount * &shape + DVector::from_fn(ROWS, |i, _| (7.3 * i as f64).sin());
            let prior = Prior::Cauchy { null: 0.0, scale: 0.3 };
            let flat = Parameter { x: 0.0, bounds: (-1e9, 1e9), prior: Prior::Flat };
            let own = Parameter { x: 0.0, bounds: (-1e9, 1e9), prior };
            let none = DMatrix::zeros(ROWS, 0);
            let model =
                Linearised { residual: &residual, jacobian: &jacobian, parameters: vec![flat, own], known: &none };
            let sizes = Sizes(vec![(0.7, 1.0)]);
            let groups = [z.clone()];
            let found = evidence(&model, &Discrepancy { groups: &groups, sizes: &sizes }).unwrap();
            let (wide, fine) = ((0.8, 0.002), (6.0, 0.02));
            let mut sum = 0.0;
            let grid = |(reach, step): (f64, f64), around: f64| {
                let count = (2.0 * reach / step) as usize;
                (0..=count).map(move |i| around - reach + step * i as f64)
            };
            for a in grid(wide, found.x[0]) {
                for b in grid(fine, found.x[1]) {
                    let left = &residual - &jacobian * DVector::from_vec(vec![a, b]);
                    sum += (density(&left, &z, 0.7) + prior.log_density(b)).exp() * wide.1 * fine.1;
                }
            }
            // Laplace's error of a Cauchy prior that is as wide as the likelihood: a third of the
            // evidence at most.
            assert!((found.log - sum.ln()).abs() < 0.3, "{amount}: {} {}", found.log, sum.ln());
        }
    }

    /// A discrepancy along the effect's own shape takes the evidence for it away; along another it
    /// does not.
    #[test]
    fn what_a_discrepancy_may_be_is_no_evidence() {
        let shape = 10.0 * column(4.0);
        let residual = &shape + DVector::from_fn(ROWS, |i, _| 0.5 * (7.3 * i as f64).sin());
        let base = DMatrix::from_columns(&[20.0 * column(1.0)]);
        let both = DMatrix::from_columns(&[20.0 * column(1.0), shape.clone()]);
        let none = DMatrix::zeros(ROWS, 0);
        let flat = Parameter { x: 0.0, bounds: (-1e9, 1e9), prior: Prior::Flat };
        let own = Parameter { prior: Prior::Cauchy { null: 0.0, scale: 0.3 }, ..flat };
        let sizes = Sizes::about(1.0, 1.0);
        let gain = |z: DMatrix<f64>| {
            let groups = [z];
            let discrepancy = Discrepancy { groups: &groups, sizes: &sizes };
            let of = |jacobian, parameters| {
                evidence(&Linearised { residual: &residual, jacobian, parameters, known: &none }, &discrepancy).unwrap()
            };
            of(&both, vec![flat, own]).log - of(&base, vec![flat]).log
        };
        assert!(gain(DMatrix::from_columns(std::slice::from_ref(&shape))) < 3.0);
        assert!(gain(DMatrix::from_columns(&[10.0 * column(9.0)])) > 50.0);
    }

    #[test]
    fn a_parameter_stays_in_its_bounds_and_the_others_follow() {
        let hessian = DMatrix::from_row_slice(2, 2, &[2.0, 1.0, 1.0, 2.0]);
        let own = |low: f64| Parameter { x: 0.0, bounds: (low, 10.0), prior: Prior::Flat };
        let right = DVector::from_vec(vec![-2.0, 0.0]);
        let step = bounded(&[own(0.0), own(-10.0)], &hessian, &right).unwrap();
        assert_eq!(step.as_slice(), [0.0, 0.0]);
        let step = bounded(&[own(-0.5), own(-10.0)], &hessian, &right).unwrap();
        assert!((step - DVector::from_vec(vec![-0.5, 0.25])).amax() < 1e-15);
    }

    #[test]
    fn sizes_are_a_distribution_with_none_in_it() {
        let sizes = Sizes::about(0.01, 1.0);
        assert_eq!(sizes.0[0].0, 0.0);
        assert!((sizes.0.iter().map(|(_, w)| w).sum::<f64>() - 1.0).abs() < 1e-12);
    }
}
