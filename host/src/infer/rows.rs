//! Which rows of a data set count.

use nalgebra::{DMatrix, DVector};

/// A mask over rows. A row that is left out is removed: it is no observation of zero.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Mask {
    used: Vec<usize>,
    all: usize,
}

impl Mask {
    /// From a flag for every row.
    #[must_use]
    pub fn of(flags: &[bool]) -> Self {
        let used = flags.iter().enumerate().filter_map(|(at, used)| used.then_some(at)).collect();
        Self { used, all: flags.len() }
    }

    /// Every row counts.
    #[must_use]
    pub fn whole(rows: usize) -> Self {
        Self { used: (0..rows).collect(), all: rows }
    }

    /// Rows that count, in their order.
    #[must_use]
    pub fn used(&self) -> &[usize] {
        &self.used
    }

    /// Number of rows that count.
    #[must_use]
    pub fn count(&self) -> usize {
        self.used.len()
    }

    /// Number of rows in all.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.all
    }

    /// True where every row counts.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        self.used.len() == self.all
    }

    /// The rows of a vector that count.
    ///
    /// # Panics
    /// When the vector has fewer rows than the mask.
    #[must_use]
    pub fn pick(&self, values: &DVector<f64>) -> DVector<f64> {
        DVector::from_fn(self.used.len(), |i, _| values[self.used[i]])
    }

    /// The rows of a matrix that count.
    ///
    /// # Panics
    /// When the matrix has fewer rows than the mask.
    #[must_use]
    pub fn pick_rows(&self, of: &DMatrix<f64>) -> DMatrix<f64> {
        of.select_rows(&self.used)
    }

    /// Puts picked rows back among all; the others are 0.
    ///
    /// # Panics
    /// When the number of rows differs from [`Mask::count`].
    #[must_use]
    pub fn spread(&self, picked: &DVector<f64>) -> DVector<f64> {
        let mut out = DVector::zeros(self.all);
        for (value, at) in picked.iter().zip(&self.used) {
            out[*at] = *value;
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_that_are_left_out_are_gone_and_come_back_as_nothing() {
        let mask = Mask::of(&[true, false, true]);
        let values = DVector::from_vec(vec![1.0, 2.0, 3.0]);
        assert_eq!((mask.count(), mask.rows(), mask.is_whole()), (2, 3, false));
        assert_eq!(mask.pick(&values).as_slice(), [1.0, 3.0]);
        assert_eq!(mask.spread(&mask.pick(&values)).as_slice(), [1.0, 0.0, 3.0]);
        assert_eq!(mask.pick_rows(&DMatrix::identity(3, 3)).row(1)[2], 1.0);
        assert!(Mask::whole(3).is_whole());
    }
}
