//! Eigenvalues of a symmetric matrix, with an end.

use nalgebra::{DMatrix, SymmetricEigen};

/// Sweeps after which the iteration is given up; a matrix of a hundred rows takes a few hundred.
const MOST_SWEEPS: usize = 10_000;

/// Eigenvalues and vectors of a symmetric matrix; `None` where it is empty, an entry is not finite or the iteration has no end.
///
/// `nalgebra`'s own call without a limit never returns from a matrix that holds a NaN.
#[must_use]
pub fn symmetric(matrix: DMatrix<f64>) -> Option<SymmetricEigen<f64, nalgebra::Dyn>> {
    if matrix.is_empty() || matrix.iter().any(|value| !value.is_finite()) {
        return None;
    }
    SymmetricEigen::try_new(matrix, f64::EPSILON, MOST_SWEEPS)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_matrix_that_is_no_number_has_no_eigenvalues() {
        let mut matrix = DMatrix::from_row_slice(2, 2, &[2.0, 1.0, 1.0, 2.0]);
        let mut values = symmetric(matrix.clone()).unwrap().eigenvalues.as_slice().to_vec();
        values.sort_by(f64::total_cmp);
        // Rounding of a matrix of order one.
        assert!((values[0] - 1.0).abs() < 1e-14 && (values[1] - 3.0).abs() < 1e-14);
        matrix[(0, 1)] = f64::NAN;
        assert!(symmetric(matrix).is_none());
    }
}
