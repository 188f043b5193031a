//! Substitution with a supernodal Cholesky factor for one right-hand side.
//!
//! The library's calls a product of matrices for every supernode, whose preparation costs more than a product with one
//! column: on a plane mesh this takes a third of the time.

use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;

/// A supernode: columns `start..start + size` of the factor, which have the same rows.
struct Supernode<'a> {
    start: usize,
    size: usize,
    /// Rows below its square block.
    below: &'a [usize],
    /// Its columns, one after the other, the block's rows first.
    values: &'a [f64],
}

fn supernodes<'a>(
    symbolic: &'a SymbolicSupernodalCholesky<usize>,
    values: &'a [f64],
) -> impl DoubleEndedIterator<Item = Supernode<'a>> {
    let (begin, end, at) = (symbolic.supernode_begin(), symbolic.supernode_end(), symbolic.col_ptr_for_val());
    (0..symbolic.n_supernodes()).map(move |s| Supernode {
        start: begin[s],
        size: end[s] - begin[s],
        below: symbolic.supernode(s).pattern(),
        values: &values[at[s]..at[s + 1]],
    })
}

/// Solves `L L' x = b`, `b` given in `x`; `work` is as long as the longest supernode, or grows to it.
pub(super) fn substitute(
    symbolic: &SymbolicSupernodalCholesky<usize>,
    values: &[f64],
    x: &mut [f64],
    work: &mut Vec<f64>,
) {
    for Supernode { start, size, below, values } in supernodes(symbolic, values) {
        work.clear();
        work.resize(below.len(), 0.0);
        let own = &mut x[start..start + size];
        for (j, column) in values.chunks_exact(size + below.len()).enumerate() {
            let (block, rest) = column.split_at(size);
            own[j] /= block[j];
            let value = own[j];
            own[j + 1..].iter_mut().zip(&block[j + 1..]).for_each(|(x, l)| *x -= l * value);
            work.iter_mut().zip(rest).for_each(|(sum, l)| *sum += l * value);
        }
        below.iter().zip(&*work).for_each(|(row, sum)| x[*row] -= sum);
    }
    for Supernode { start, size, below, values } in supernodes(symbolic, values).rev() {
        work.clear();
        work.extend(below.iter().map(|row| x[*row]));
        let own = &mut x[start..start + size];
        for (j, column) in values.chunks_exact(size + below.len()).enumerate().rev() {
            let (block, rest) = column.split_at(size);
            let sum = product(&block[j + 1..], &own[j + 1..]) + product(rest, work);
            own[j] = (own[j] - sum) / block[j];
        }
    }
}

/// Scalar product by eight sums, which the processor adds side by side.
fn product(a: &[f64], b: &[f64]) -> f64 {
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<8>(), b.as_chunks::<8>());
    let mut sums = [0.0; 8];
    for (a, b) in a.iter().zip(b) {
        for i in 0..8 {
            sums[i] += a[i] * b[i];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f64>() + rest
}
