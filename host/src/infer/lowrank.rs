//! Gaussian errors along a few columns: `F a` with `a ~ N(0, S)`. Jitter, tare, form errors and unseen effects are all of this shape.
//!
//! Once whitened by the rest of the noise, such a term turns the covariance `I` into `I + Z Z'`, and what whitens that is
//! `(I + Z Z')^(-1/2) = I - Z K Z'` (Woodbury).

use nalgebra::{DMatrix, DVector};

use super::covariance::Factor;
use super::eigen;
use super::product::inner;

/// Columns of an error with the standard deviation of each amount.
#[derive(Debug, Clone, PartialEq)]
pub struct LowRank {
    /// A column for each amount of one.
    columns: DMatrix<f64>,
    /// Prior standard deviation of each amount.
    deviations: Vec<f64>,
    /// What each amount is, for reports: the same word for amounts that belong together.
    meanings: Vec<&'static str>,
}

impl LowRank {
    /// No error.
    #[must_use]
    pub fn none(rows: usize) -> Self {
        Self { columns: DMatrix::zeros(rows, 0), deviations: Vec::new(), meanings: Vec::new() }
    }

    /// Columns with one meaning. Columns beyond the number of deviations have none and are dropped.
    #[must_use]
    pub fn new(columns: DMatrix<f64>, deviations: Vec<f64>, meaning: &'static str) -> Self {
        let count = columns.ncols().min(deviations.len());
        let columns = if count < columns.ncols() { columns.columns(0, count).into_owned() } else { columns };
        let deviations: Vec<f64> = deviations.into_iter().take(count).collect();
        Self { columns, meanings: vec![meaning; count], deviations }
    }

    /// Columns that are scaled to unit deviation already.
    #[must_use]
    pub fn unit(columns: DMatrix<f64>, meaning: &'static str) -> Self {
        let count = columns.ncols();
        Self::new(columns, vec![1.0; count], meaning)
    }

    /// Both errors, independent of each other.
    ///
    /// # Panics
    /// When the numbers of rows differ.
    #[must_use]
    pub fn and(&self, other: &Self) -> Self {
        let (own, more) = (self.columns.ncols(), other.columns.ncols());
        let mut columns = DMatrix::zeros(self.columns.nrows(), own + more);
        columns.columns_mut(0, own).copy_from(&self.columns);
        columns.columns_mut(own, more).copy_from(&other.columns);
        Self {
            columns,
            deviations: [self.deviations.as_slice(), &other.deviations].concat(),
            meanings: [self.meanings.as_slice(), &other.meanings].concat(),
        }
    }

    /// The same with columns that something was done to, such as a whitening.
    #[must_use]
    pub fn mapped(self, of: impl FnOnce(DMatrix<f64>) -> DMatrix<f64>) -> Self {
        Self { columns: of(self.columns), ..self }
    }

    /// Number of amounts.
    #[must_use]
    pub fn len(&self) -> usize {
        self.deviations.len()
    }

    /// True without an amount.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.deviations.is_empty()
    }

    /// What each amount is.
    #[must_use]
    pub fn meanings(&self) -> &[&'static str] {
        &self.meanings
    }

    /// Columns of unit prior deviation.
    #[must_use]
    pub fn scaled(&self) -> DMatrix<f64> {
        let mut out = self.columns.clone();
        for (mut column, deviation) in out.column_iter_mut().zip(&self.deviations) {
            column *= *deviation;
        }
        out
    }
}

/// Whitened columns of unit deviation, with what takes their error off residuals.
#[derive(Debug, Clone, PartialEq)]
pub struct Fold {
    columns: DMatrix<f64>,
    /// `K` of `(I + Z Z')^(-1/2) = I - Z K Z'`.
    kernel: DMatrix<f64>,
    /// Logarithm of the determinant of `I + Z'Z`: what the freedom costs in a likelihood.
    price: f64,
}

impl Fold {
    /// Nothing to take off.
    #[must_use]
    pub fn none() -> Self {
        Self { columns: DMatrix::zeros(0, 0), kernel: DMatrix::zeros(0, 0), price: 0.0 }
    }

    /// Of columns that the rest of the noise has whitened.
    ///
    /// Columns that hold a number that is none make everything infinitely dear: the price is infinite and nothing is taken off.
    #[must_use]
    pub fn of(columns: DMatrix<f64>) -> Self {
        if columns.ncols() == 0 {
            return Self::none();
        }
        let Some(eigen) = eigen::symmetric(inner(&columns, &columns)) else {
            return Self { price: f64::INFINITY, ..Self::none() };
        };
        // (1 - 1/sqrt(1 + x)) / x, its limit 1/2 for x -> 0
        let part = |x: f64| if x < 1e-9 { 0.5 } else { (1.0 - 1.0 / (1.0 + x).sqrt()) / x };
        let scaled = &eigen.eigenvectors * DMatrix::from_diagonal(&eigen.eigenvalues.map(part));
        let price = eigen.eigenvalues.iter().map(|x| x.max(0.0).ln_1p()).sum();
        Self { kernel: scaled * eigen.eigenvectors.transpose(), columns, price }
    }

    /// The whitened columns.
    #[must_use]
    pub fn columns(&self) -> &DMatrix<f64> {
        &self.columns
    }

    /// Number of amounts.
    #[must_use]
    pub fn len(&self) -> usize {
        self.columns.ncols()
    }

    /// True without an amount.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.columns.ncols() == 0
    }

    /// Logarithm of the determinant of `I + Z'Z`.
    #[must_use]
    pub fn price(&self) -> f64 {
        self.price
    }

    /// `(I + Z Z')^(-1/2) r`.
    #[must_use]
    pub fn taken_off(&self, residual: &DVector<f64>) -> DVector<f64> {
        if self.is_empty() {
            return residual.clone();
        }
        residual - &self.columns * (&self.kernel * self.columns.tr_mul(residual))
    }

    /// The same of several residuals, a column each.
    #[must_use]
    pub fn all_taken_off(&self, residuals: DMatrix<f64>) -> DMatrix<f64> {
        if self.is_empty() {
            return residuals;
        }
        let explained = &self.columns * (&self.kernel * inner(&self.columns, &residuals));
        residuals - explained
    }

    /// Posterior mean of the amounts (in prior deviations) that whitened residuals speak for.
    #[must_use]
    pub fn amounts(&self, residual: &DVector<f64>) -> DVector<f64> {
        if self.is_empty() {
            return DVector::zeros(0);
        }
        let mut normal = inner(&self.columns, &self.columns);
        (0..normal.nrows()).for_each(|k| normal[(k, k)] += 1.0);
        let right = self.columns.tr_mul(residual);
        Factor::of(&normal).map_or_else(|| DVector::zeros(right.len()), |factor| factor.solve(&right))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn columns(count: usize) -> DMatrix<f64> {
        DMatrix::from_fn(9, count, |i, j| 2.0 * ((5 * i + 3 * j) as f64).sin())
    }

    /// Against the dense covariance, to rounding.
    #[test]
    fn a_fold_whitens_what_the_columns_add() {
        for count in 0..4 {
            let z = columns(count);
            let fold = Fold::of(z.clone());
            let dense = DMatrix::identity(9, 9) + &z * z.transpose();
            let root = fold.all_taken_off(DMatrix::identity(9, 9));
            assert!((&root * &dense * &root.transpose() - DMatrix::identity(9, 9)).amax() < 1e-11);
            let factor = dense.cholesky().unwrap();
            let exact: f64 = factor.l().diagonal().iter().map(|v| 2.0 * v.ln()).sum();
            assert!((fold.price() - exact).abs() < 1e-11);
            let r = DVector::from_fn(9, |i, _| (i as f64).cos());
            let amounts = fold.amounts(&r);
            assert!(amounts.len() == count && (count == 0 || (amounts - z.tr_mul(&factor.solve(&r))).amax() < 1e-11));
            assert!((fold.taken_off(&r) - &root * &r).amax() < 1e-13);
        }
    }

    #[test]
    fn deviations_scale_the_columns_and_meanings_stay() {
        let error = LowRank::new(columns(2), vec![2.0, 0.5], "gain").and(&LowRank::unit(columns(1), "tare"));
        let scaled = error.scaled();
        assert_eq!((error.len(), error.meanings()), (3, ["gain", "gain", "tare"].as_slice()));
        assert!((scaled.column(0) - 2.0 * columns(2).column(0)).amax() < 1e-15);
        assert!(LowRank::none(9).is_empty());
    }

    #[test]
    fn no_number_gives_no_freedom() {
        let mut z = columns(2);
        z[(3, 1)] = f64::NAN;
        let fold = Fold::of(z);
        let r = DVector::from_element(9, 1.0);
        assert!(fold.price().is_infinite() && fold.taken_off(&r) == r);
    }
}
