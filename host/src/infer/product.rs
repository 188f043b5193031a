//! Products of tall matrices: a row for every reading, a column for a parameter, a direction or a clean twin.

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};
use nalgebra::DMatrix;

/// `a' b`. One core: fits run side by side.
///
/// # Panics
/// When the numbers of rows differ.
#[must_use]
pub fn inner(a: &DMatrix<f64>, b: &DMatrix<f64>) -> DMatrix<f64> {
    let mut out = DMatrix::zeros(a.ncols(), b.ncols());
    matmul(seen_mut(&mut out), Accum::Replace, seen(a).transpose(), seen(b), 1.0, Par::Seq);
    out
}

/// Columns beside each other.
///
/// # Panics
/// When one has another number of rows.
#[must_use]
pub fn beside<'a>(rows: usize, parts: impl IntoIterator<Item = &'a DMatrix<f64>>) -> DMatrix<f64> {
    let parts: Vec<&DMatrix<f64>> = parts.into_iter().collect();
    let mut all = DMatrix::zeros(rows, parts.iter().map(|p| p.ncols()).sum());
    let mut at = 0;
    for part in parts {
        all.columns_mut(at, part.ncols()).copy_from(part);
        at += part.ncols();
    }
    all
}

/// Puts a square matrix times some rows of another one in the place of these rows.
///
/// # Panics
/// When the rows are not there.
pub fn turn_rows(by: &DMatrix<f64>, of: &mut DMatrix<f64>, first: usize) {
    let own = of.rows(first, by.nrows()).into_owned();
    let columns = of.ncols();
    let rows = seen_mut(of).submatrix_mut(first, 0, by.nrows(), columns);
    matmul(rows, Accum::Replace, seen(by), seen(&own), 1.0, Par::Seq);
}

fn seen(matrix: &DMatrix<f64>) -> MatRef<'_, f64> {
    MatRef::from_column_major_slice(matrix.as_slice(), matrix.nrows(), matrix.ncols())
}

fn seen_mut(matrix: &mut DMatrix<f64>) -> MatMut<'_, f64> {
    let (rows, columns) = matrix.shape();
    MatMut::from_column_major_slice_mut(matrix.as_mut_slice(), rows, columns)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(rows: usize, columns: usize) -> DMatrix<f64> {
        DMatrix::from_fn(rows, columns, |i, j| ((3 * i + 7 * j) as f64).sin())
    }

    /// To rounding of sums of 40 numbers below 1; nothing has products as well.
    #[test]
    fn products_are_those_of_any_other_library() {
        for (k, m) in [(1, 1), (3, 9), (8, 2), (0, 4)] {
            let (a, b) = (of(40, k), of(40, m));
            assert!((inner(&a, &b) - a.tr_mul(&b)).amax() < 1e-13 || k == 0);
            assert_eq!(inner(&a, &b).shape(), (k, m));
        }
        let (square, mut whole) = (of(5, 5), of(12, 3));
        let expected = &square * whole.rows(4, 5);
        let before = whole.clone();
        turn_rows(&square, &mut whole, 4);
        assert!((whole.rows(4, 5) - expected).amax() < 1e-14);
        assert!(whole.rows(0, 4) == before.rows(0, 4) && whole.rows(9, 3) == before.rows(9, 3));
    }
}
