//! Sparse matrix of fixed pattern, its Cholesky factor and, where it is unsymmetric, its LU factor.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::linalg::solvers::Solve;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::linalg::solvers::{Lu, SymbolicLu};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};
use faer::{Conj, MatMut, Par, Side};

use super::substitute::substitute;

/// A degree of freedom that is held: it has no equation.
pub const HELD: usize = usize::MAX;

/// Where the entries of every group's matrix go in the value array; [`u32::MAX`] for none.
pub type Scatter = Vec<Vec<u32>>;

/// Pattern of a square matrix in compressed columns: the lower triangle, or all of it.
#[derive(Debug)]
pub struct Pattern {
    symbolic: SymbolicSparseColMat<usize>,
    diagonal: Vec<usize>,
}

/// Which entries of a matrix are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stored {
    /// The lower triangle of a symmetric matrix.
    Lower,
    /// Every entry.
    All,
}

impl Pattern {
    /// Pattern of `n` equations in which the members of each group are coupled.
    ///
    /// `groups` list equation numbers, [`HELD`] for none. Returns the pattern and for every
    /// group the position in the value array of each of its entries, row by row ([`Stored::Lower`]:
    /// of its lower triangle, whatever the order of the equations), [`u32::MAX`] for held members.
    #[must_use]
    pub fn new<'a>(n: usize, groups: impl Iterator<Item = &'a [usize]> + Clone, stored: Stored) -> (Self, Scatter) {
        let mut columns: Vec<Vec<usize>> = vec![Vec::new(); n];
        for group in groups.clone() {
            for &a in group {
                for &b in group {
                    if a != HELD && b != HELD && (a >= b || stored == Stored::All) {
                        columns[b].push(a);
                    }
                }
            }
        }
        let mut start = Vec::with_capacity(n + 1);
        let mut rows = Vec::new();
        let mut diagonal = Vec::with_capacity(n);
        start.push(0);
        for (j, column) in columns.iter_mut().enumerate() {
            column.sort_unstable();
            column.dedup();
            diagonal.push(rows.len() + column.partition_point(|&i| i < j));
            rows.extend_from_slice(column);
            start.push(rows.len());
        }
        let place = |a: usize, b: usize| {
            if a == HELD || b == HELD {
                return u32::MAX;
            }
            let (row, column) = if stored == Stored::All { (a, b) } else { (a.max(b), a.min(b)) };
            let list = &rows[start[column]..start[column + 1]];
            list.binary_search(&row).map_or(u32::MAX, |k| (start[column] + k) as u32)
        };
        let scatter = groups
            .map(|group| {
                let mut list = Vec::with_capacity(group.len() * group.len());
                for i in 0..group.len() {
                    let columns = if stored == Stored::All { group.len() } else { i + 1 };
                    for j in 0..columns {
                        list.push(place(group[i], group[j]));
                    }
                }
                list
            })
            .collect();
        let symbolic = SymbolicSparseColMat::new_checked(n, n, start, None, rows);
        (Self { symbolic, diagonal }, scatter)
    }

    /// Number of stored values.
    #[must_use]
    pub fn entries(&self) -> usize {
        self.symbolic.row_idx().len()
    }

    /// Positions of the diagonal in the value array.
    #[must_use]
    pub fn diagonal(&self) -> &[usize] {
        &self.diagonal
    }

    /// Product of the matrix of the given values, [`Stored::All`], with `v`.
    pub fn multiply(&self, values: &[f64], v: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        for (j, w) in self.starts().windows(2).enumerate() {
            for k in w[0]..w[1] {
                out[self.rows()[k]] += values[k] * v[j];
            }
        }
    }

    /// Product of the symmetric matrix of the given values, [`Stored::Lower`], with `v`.
    pub fn multiply_symmetric(&self, values: &[f64], v: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        let rows = self.rows();
        for (j, w) in self.starts().windows(2).enumerate() {
            let mut sum = 0.0;
            for (&row, &value) in rows[w[0]..w[1]].iter().zip(&values[w[0]..w[1]]) {
                if row == j {
                    sum += value * v[j];
                } else {
                    sum += value * v[row];
                    out[row] += value * v[j];
                }
            }
            out[j] += sum;
        }
    }

    /// First position of every column in the value array, and the end.
    pub(crate) fn starts(&self) -> &[usize] {
        self.symbolic.col_ptr()
    }

    /// Row of every position.
    pub(crate) fn rows(&self) -> &[usize] {
        self.symbolic.row_idx()
    }
}

/// Adds the lower triangle of an element's matrix at the places of a pattern of [`Stored::Lower`].
pub fn add_lower<const D: usize>(values: &mut [f64], places: &[u32], k: &[[f64; D]; D]) {
    let mut rest = places;
    for (i, row) in k.iter().enumerate() {
        let Some((own, after)) = rest.split_at_checked(i + 1) else { return };
        for (v, &place) in row.iter().zip(own) {
            if place != u32::MAX {
                values[place as usize] += v;
            }
        }
        rest = after;
    }
}

/// Adds an element's matrix at the places of a pattern of [`Stored::All`].
pub fn add_all<const D: usize>(values: &mut [f64], places: &[u32], k: &[[f64; D]; D]) {
    for (v, &place) in k.iter().flatten().zip(places) {
        if place != u32::MAX {
            values[place as usize] += v;
        }
    }
}

/// Cholesky factor with symbolic analysis done once.
pub struct Factor {
    symbolic: SymbolicCholesky<usize>,
    values: Vec<f64>,
    memory: MemBuffer,
    work: Vec<f64>,
}

/// Analyses a pattern of [`Stored::Lower`]; `None` when memory does not suffice.
fn analysed(pattern: &Pattern, ordering: SymmetricOrdering<'_, usize>) -> Option<SymbolicCholesky<usize>> {
    let parameters = CholeskySymbolicParams {
        supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
        ..Default::default()
    };
    // without an ordering of its own the library analyses what it is given as the upper triangle, whatever side is said
    let upper = pattern.symbolic.transpose().to_col_major().ok()?;
    factorize_symbolic_cholesky(upper.as_ref(), Side::Upper, ordering, parameters).ok()
}

/// The place of every equation in an order of elimination that fills little in (approximate minimum degree), from a pattern of [`Stored::Lower`];
/// `None` when memory does not suffice.
#[must_use]
pub fn elimination_order(pattern: &Pattern) -> Option<Vec<usize>> {
    let symbolic = analysed(pattern, SymmetricOrdering::Amd)?;
    Some(symbolic.perm()?.arrays().1.to_vec())
}

impl Factor {
    /// Analyses a pattern of [`Stored::Lower`], whose equations are eliminated in their order ([`elimination_order`]); `None` when
    /// memory does not suffice.
    #[must_use]
    pub fn new(pattern: &Pattern) -> Option<Self> {
        let symbolic = analysed(pattern, SymmetricOrdering::Identity)?;
        let numeric = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        let solve = symbolic.solve_in_place_scratch::<f64>(1, Par::Seq);
        Some(Self {
            values: vec![0.0; symbolic.len_val()],
            memory: MemBuffer::new(numeric.or(solve)),
            work: Vec::new(),
            symbolic,
        })
    }

    /// Factorises the matrix of the given values. False when it is not positive definite.
    pub fn factorise(&mut self, pattern: &Pattern, values: &[f64]) -> bool {
        self.symbolic
            .factorize_numeric_llt(
                &mut self.values,
                SparseColMatRef::new(pattern.symbolic.as_ref(), values),
                Side::Lower,
                LltRegularization::default(),
                Par::Seq,
                MemStack::new(&mut self.memory),
                Default::default(),
            )
            .is_ok()
    }

    /// Solves in place with the last factor.
    pub fn solve(&mut self, x: &mut [f64]) {
        let n = x.len();
        LltRef::new(&self.symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(x, n, 1),
            Par::Seq,
            MemStack::new(&mut self.memory),
        );
    }
}

impl Factor {
    /// As [`Factor::solve`], by loops over single columns: faster, with sums in another order.
    pub fn substitute(&mut self, x: &mut [f64]) {
        match self.symbolic.raw() {
            SymbolicCholeskyRaw::Supernodal(symbolic) => substitute(symbolic, &self.values, x, &mut self.work),
            SymbolicCholeskyRaw::Simplicial(_) => self.solve(x),
        }
    }
}

/// LU factor with partial pivoting, symbolic analysis done once.
pub(crate) struct UnsymmetricFactor {
    symbolic: SymbolicLu<usize>,
    lu: Option<Lu<usize, f64>>,
}

impl UnsymmetricFactor {
    /// Analyses a pattern of [`Stored::All`]; `None` when memory does not suffice.
    pub fn new(pattern: &Pattern) -> Option<Self> {
        Some(Self { symbolic: SymbolicLu::try_new(pattern.symbolic.as_ref()).ok()?, lu: None })
    }

    /// Factorises the matrix of the given values. False when it is singular or not finite.
    pub fn factorise(&mut self, pattern: &Pattern, values: &[f64]) -> bool {
        let matrix = SparseColMatRef::new(pattern.symbolic.as_ref(), values);
        self.lu = Lu::try_new_with_symbolic(self.symbolic.clone(), matrix).ok();
        self.lu.is_some()
    }

    /// Solves in place with the last factor; false when there is none.
    pub fn solve(&self, x: &mut [f64]) -> bool {
        let Some(lu) = &self.lu else { return false };
        let n = x.len();
        lu.solve_in_place(MatMut::from_column_major_slice_mut(x, n, 1));
        x.iter().all(|v| v.is_finite())
    }
}
