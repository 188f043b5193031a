//! From an information matrix (`J' C^-1 J`) to what is known of the parameters.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::product::inner;

/// Two-sided 95 % of a normal distribution.
pub const Z95: f64 = 1.959_963_984_540_054;

/// Factor of a positive definite matrix whose rows differ in scale: it is scaled to a unit diagonal first.
#[derive(Debug, Clone)]
pub struct Factor {
    scale: Vec<f64>,
    scaled: Cholesky<f64, Dyn>,
}

impl Factor {
    /// `None` where the matrix is singular, indefinite or not finite.
    #[must_use]
    pub fn of(matrix: &DMatrix<f64>) -> Option<Self> {
        let n = matrix.nrows();
        let scale: Vec<f64> = (0..n).map(|i| matrix[(i, i)].sqrt()).collect();
        if scale.iter().any(|s| !(s.is_finite() && *s > 0.0)) || matrix.iter().any(|v| !v.is_finite()) {
            return None;
        }
        let scaled = DMatrix::from_fn(n, n, |i, j| matrix[(i, j)] / scale[i] / scale[j]).cholesky()?;
        Some(Self { scale, scaled })
    }

    /// `A^-1 b`.
    #[must_use]
    pub fn solve(&self, right: &DVector<f64>) -> DVector<f64> {
        let inner = DVector::from_fn(right.len(), |i, _| right[i] / self.scale[i]);
        let solved = self.scaled.solve(&inner);
        DVector::from_fn(right.len(), |i, _| solved[i] / self.scale[i])
    }

    /// `A^-1 B`.
    #[must_use]
    pub fn solve_all(&self, right: &DMatrix<f64>) -> DMatrix<f64> {
        let inner = DMatrix::from_fn(right.nrows(), right.ncols(), |i, j| right[(i, j)] / self.scale[i]);
        let solved = self.scaled.solve(&inner);
        DMatrix::from_fn(right.nrows(), right.ncols(), |i, j| solved[(i, j)] / self.scale[i])
    }

    /// `J A^(-1/2)`: columns along which a normal distribution with the covariance `A^-1` moves what has the derivative `J`, `J A^-1 J'` in all.
    #[must_use]
    pub fn rooted(&self, jacobian: &DMatrix<f64>) -> DMatrix<f64> {
        let scaled = DMatrix::from_fn(jacobian.ncols(), jacobian.nrows(), |i, j| jacobian[(j, i)] / self.scale[i]);
        // the diagonal of a factor is above 0
        self.scaled.l_dirty().solve_lower_triangular(&scaled).map_or_else(|| scaled.transpose(), |own| own.transpose())
    }

    /// `A^-1`.
    #[must_use]
    pub fn inverse(&self) -> DMatrix<f64> {
        let inverse = self.scaled.inverse();
        let n = inverse.nrows();
        DMatrix::from_fn(n, n, |i, j| inverse[(i, j)] / self.scale[i] / self.scale[j])
    }

    /// Logarithm of the determinant.
    #[must_use]
    pub fn log_determinant(&self) -> f64 {
        let scaled: f64 = self.scaled.l_dirty().diagonal().iter().map(|v| 2.0 * v.ln()).sum();
        scaled + self.scale.iter().map(|s| 2.0 * s.ln()).sum::<f64>()
    }
}

/// Covariance of parameters; `None` where the information is singular.
#[must_use]
pub fn covariance(information: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    Factor::of(information).map(|factor| factor.inverse())
}

/// Standard errors; infinite where the information is singular.
#[must_use]
pub fn standard_errors(information: &DMatrix<f64>) -> Vec<f64> {
    match covariance(information) {
        Some(covariance) => covariance.diagonal().iter().map(|v| v.max(0.0).sqrt()).collect(),
        None => vec![f64::INFINITY; information.nrows()],
    }
}

/// Logarithm of the determinant of a positive definite matrix; minus infinity where it is none.
#[must_use]
pub fn log_determinant(matrix: &DMatrix<f64>) -> f64 {
    Factor::of(matrix).map_or(f64::NEG_INFINITY, |factor| factor.log_determinant())
}

/// Information on parameters that is left when nuisance amounts, each with a unit normal prior, are marginalised: one Schur
/// complement, `J'J - J'F (I + F'F)^-1 F'J`.
///
/// `jacobian` and `nuisance` are whitened, a column each.
#[must_use]
pub fn marginal_information(jacobian: &DMatrix<f64>, nuisance: &DMatrix<f64>) -> DMatrix<f64> {
    let own = inner(jacobian, jacobian);
    if nuisance.ncols() == 0 {
        return own;
    }
    let mut freedom = inner(nuisance, nuisance);
    (0..freedom.nrows()).for_each(|i| freedom[(i, i)] += 1.0);
    let coupling = inner(nuisance, jacobian);
    // I + F'F is positive definite unless an entry is not finite; then nothing is known.
    match Factor::of(&freedom) {
        Some(factor) => own - coupling.tr_mul(&factor.solve_all(&coupling)),
        None => DMatrix::zeros(own.nrows(), own.ncols()),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// Units that differ by ten orders of magnitude cost nothing but rounding.
    #[test]
    fn parameters_of_very_different_units_have_their_covariance() {
        let unit = DMatrix::from_diagonal(&DVector::from_vec(vec![1e-5, 1e5]));
        let plain = DMatrix::from_row_slice(2, 2, &[2.0, 1.0, 1.0, 2.0]);
        let found = covariance(&(&unit * &plain * &unit)).unwrap();
        assert!((found[(0, 1)] + 1.0 / 3.0).abs() < 1e-12, "{found}");
        assert!((log_determinant(&plain) - 3.0_f64.ln()).abs() < 1e-14);
        assert_eq!(standard_errors(&DMatrix::zeros(2, 2)), [f64::INFINITY; 2]);
        assert_eq!(log_determinant(&DMatrix::from_element(1, 1, f64::NAN)), f64::NEG_INFINITY);
    }

    #[test]
    fn roots_have_the_covariance_as_their_product() {
        let (a, j) =
            (DMatrix::from_row_slice(2, 2, &[2.0, 1.0, 1.0, 50.0]), DMatrix::from_fn(3, 2, |i, j| (i + 2 * j) as f64));
        let factor = Factor::of(&a).unwrap();
        let root = factor.rooted(&j);
        assert!((&root * root.transpose() - &j * factor.inverse() * j.transpose()).amax() < 1e-12);
    }

    /// A nuisance along the only parameter with unit prior halves what one reading says; a wide one takes it all.
    #[test]
    fn marginal_information_is_that_of_the_joint_covariance() {
        let jacobian = DMatrix::from_fn(5, 2, |i, j| ((i + 2 * j) as f64).sin());
        let nuisance = DMatrix::from_fn(5, 3, |i, j| ((3 * i + j) as f64).cos());
        let joint = DMatrix::identity(5, 5) + &nuisance * nuisance.transpose();
        let exact = jacobian.tr_mul(&(joint.try_inverse().unwrap() * &jacobian));
        assert!((marginal_information(&jacobian, &nuisance) - exact).amax() < 1e-12);
    }
}
