//! Gaussian errors along a few columns: `F a` with `a ~ N(0, S)`. Jitter, tare, form errors and unseen effects are all of this shape.
//!
//! Once whitened by the rest of the noise, such a term turns the covariance `I` into `I + Z Z'`, and what whitens that is
//! `(I + Z Z')^(-1/2) = I - Z K Z'` (Woodbury).

use nalgebra::{DMatrix, DVector};

use super::covariance::Factor;
use super::eigen;
use super::product::{beside, inner};

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
        Self {
            columns: beside(self.columns.nrows(), [&self.columns, &other.columns]),
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

/// Standard deviations between predictions, where parameters with some derivative of the predictions are free within what data with
/// another derivative left open of them; 0 where a number is none.
#[must_use]
pub fn apart(difference: &DVector<f64>, jacobian: &DMatrix<f64>, of_data: &DMatrix<f64>) -> f64 {
    let mut known = inner(of_data, of_data);
    for j in 0..known.nrows() {
        known[(j, j)] = known[(j, j)] * (1.0 + 1e-9) + 1e-12;
    }
    Factor::of(&known).map_or(0.0, |known| Fold::of(known.rooted(jacobian)).taken_off(difference).norm())
}

/// Rows of a data set as all its other rows predict them: with independent errors of unit variance in every row and errors along columns that rows share,
/// `C = I + Z Z'`.
///
/// Of all rows only `C^-1 r` is needed (Rasmussen and Williams 2006, Eqs. 5.10-5.12): with `(C^-1)_gg^-1 = I + Y Y'` what the others
/// leave of the rows `g` has the square `|x|^2 + |Y' x|^2` at `x = (C^-1 r)_g`.
#[derive(Debug, Clone, PartialEq)]
pub struct GivenRest {
    rows: Vec<usize>,
    /// `Y = Z_g (I + Z_r' Z_r)^(-1/2)`, `r` being the rest.
    uncertain: DMatrix<f64>,
}

impl GivenRest {
    /// Of whitened columns of unit deviation and groups of rows, each of which is left out by itself; `None` where a number is none.
    ///
    /// # Panics
    /// When the columns have no such row.
    #[must_use]
    pub fn each(columns: &DMatrix<f64>, groups: impl IntoIterator<Item = Vec<usize>>) -> Option<Vec<Self>> {
        let mut whole = inner(columns, columns);
        (0..whole.nrows()).for_each(|k| whole[(k, k)] += 1.0);
        let one = |rows: Vec<usize>| {
            let own = columns.select_rows(&rows);
            let uncertain = if own.ncols() > 0 { Factor::of(&(&whole - inner(&own, &own)))?.rooted(&own) } else { own };
            Some(Self { rows, uncertain })
        };
        groups.into_iter().map(one).collect()
    }

    /// Of `C^-1 R` (all rows, a column for every residual) what the rest leaves of these rows: independent numbers of unit variance, some more than there are rows.
    #[must_use]
    pub fn left(&self, weighed: &DMatrix<f64>) -> DMatrix<f64> {
        let own = weighed.select_rows(&self.rows);
        let more = inner(&self.uncertain, &own);
        let mut out = DMatrix::zeros(own.nrows() + more.nrows(), own.ncols());
        out.rows_mut(0, own.nrows()).copy_from(&own);
        out.rows_mut(own.nrows(), more.nrows()).copy_from(&more);
        out
    }
}

/// What data say of one error of unknown size along some whitened columns: information along directions that are told of independently, and the square
/// of what the data say along each.
#[derive(Debug, Clone, PartialEq)]
pub struct Directions(Vec<(f64, f64)>);

impl Directions {
    /// Of whitened columns, and their products with whitened data. None where a number is none.
    #[must_use]
    pub fn of(columns: &DMatrix<f64>, said: &DVector<f64>) -> Self {
        let Some(eigen) = eigen::symmetric(inner(columns, columns)) else { return Self(Vec::new()) };
        let along = eigen.eigenvectors.tr_mul(said);
        Self(eigen.eigenvalues.iter().zip(along.iter()).map(|(value, said)| (value.max(0.0), said * said)).collect())
    }

    /// What an error of this deviation takes off the square of the data, and what it costs: the logarithm of the determinant of `I + a^2 Z'Z`.
    #[must_use]
    pub fn at(&self, deviation: f64) -> (f64, f64) {
        let variance = deviation * deviation;
        self.0.iter().fold((0.0, 0.0), |(taken, price), (information, said)| {
            let whole = 1.0 + variance * information;
            (taken + variance * said / whole, price + whole.ln())
        })
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

    /// Against the dense covariance of the rows that are left: the same normal distribution of the others.
    #[test]
    fn rows_given_the_rest_are_as_the_dense_covariance_says() {
        for count in 0..4 {
            let z = columns(count);
            let dense = DMatrix::identity(9, 9) + &z * z.transpose();
            let r = DVector::from_fn(9, |i, _| (i as f64).cos());
            let weighed = dense.clone().try_inverse().unwrap() * &r;
            let (own, rest) = (vec![1, 2, 7], vec![0, 3, 4, 5, 6, 8]);
            let part = |a: &[usize], b: &[usize]| DMatrix::from_fn(a.len(), b.len(), |i, j| dense[(a[i], b[j])]);
            let pick = |a: &[usize]| DVector::from_fn(a.len(), |i, _| r[a[i]]);
            let gain = part(&own, &rest) * part(&rest, &rest).try_inverse().unwrap();
            let error = pick(&own) - &gain * pick(&rest);
            let covariance = part(&own, &own) - gain * part(&rest, &own);
            let exact = error.dot(&(covariance.try_inverse().unwrap() * &error));
            let given = &GivenRest::each(&z, [own]).unwrap()[0];
            let left = given.left(&DMatrix::from_column_slice(9, 1, weighed.as_slice()));
            assert!((left.norm_squared() - exact).abs() < 1e-11 * exact, "{count}");
        }
    }

    /// Against the covariance `I + a^2 Z Z'` itself: its determinant, and the square of whitened values.
    #[test]
    fn an_error_of_any_size_along_its_directions_is_the_same_covariance() {
        let r = DVector::from_fn(9, |i, _| (i as f64).cos());
        for count in 0..4 {
            let z = columns(count);
            let directions = Directions::of(&z, &z.tr_mul(&r));
            for deviation in [0.1, 0.7, 3.0] {
                let fold = Fold::of(&z * deviation);
                let (taken, price) = directions.at(deviation);
                assert!((price - fold.price()).abs() < 1e-11, "{count} {deviation}");
                let left = r.norm_squared() - taken;
                assert!((left - fold.taken_off(&r).norm_squared()).abs() < 1e-11, "{count} {deviation}");
            }
        }
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
