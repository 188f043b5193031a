//! Iterative solution of an unsymmetric system with a good preconditioner.

/// Scalar product.
#[must_use]
pub fn dot(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(x, y)| x * y).sum()
}

/// GMRES with right preconditioning (Saad, Iterative Methods for Sparse Linear Systems, 2003,
/// algorithm 9.5): solves `A x = b`, `b` given in `x`, until the residual is below
/// `tolerance` times `|b|`. Returns false, with `x` unchanged, when `steps` do not suffice.
pub fn gmres(
    mut apply: impl FnMut(&[f64], &mut [f64]),
    mut precondition: impl FnMut(&mut [f64]),
    x: &mut [f64],
    tolerance: f64,
    steps: usize,
) -> bool {
    let n = x.len();
    let size = dot(x, x).sqrt();
    if size == 0.0 {
        return true;
    }
    let mut basis: Vec<Vec<f64>> = vec![x.iter().map(|v| v / size).collect()];
    let mut directions: Vec<Vec<f64>> = Vec::new();
    // columns of the triangle, the rotations that made it, and the rotated right-hand side
    let mut triangle: Vec<Vec<f64>> = Vec::new();
    let mut rotations: Vec<(f64, f64)> = Vec::new();
    let mut right = vec![size];
    for k in 0..steps {
        let mut z = basis[k].clone();
        precondition(&mut z);
        let mut w = vec![0.0; n];
        apply(&z, &mut w);
        directions.push(z);
        let mut h = Vec::with_capacity(k + 2);
        for v in &basis {
            let part = dot(&w, v);
            h.push(part);
            for (w, v) in w.iter_mut().zip(v) {
                *w -= part * v;
            }
        }
        let rest = dot(&w, &w).sqrt();
        for (i, &(c, s)) in rotations.iter().enumerate() {
            (h[i], h[i + 1]) = (c * h[i] + s * h[i + 1], c * h[i + 1] - s * h[i]);
        }
        let length = h[k].hypot(rest);
        if !(length > 0.0 && length.is_finite()) {
            return false;
        }
        let (c, s) = (h[k] / length, rest / length);
        h[k] = length;
        rotations.push((c, s));
        triangle.push(h);
        let last = right[k];
        right[k] = c * last;
        right.push(-s * last);
        if (s * last).abs() <= tolerance * size {
            let y = back_substitute(&triangle, &right);
            x.fill(0.0);
            for (y, z) in y.iter().zip(&directions) {
                for (x, z) in x.iter_mut().zip(z) {
                    *x += y * z;
                }
            }
            return true;
        }
        basis.push(w.iter().map(|w| w / rest).collect());
    }
    false
}

fn back_substitute(triangle: &[Vec<f64>], right: &[f64]) -> Vec<f64> {
    let n = triangle.len();
    let mut y = vec![0.0; n];
    for i in (0..n).rev() {
        let sum: f64 = (i + 1..n).map(|j| triangle[j][i] * y[j]).sum();
        y[i] = (right[i] - sum) / triangle[i][i];
    }
    y
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An unsymmetric matrix near its preconditioner's, against the known solution.
    #[test]
    fn solves_an_unsymmetric_system() {
        let n = 40;
        let a = |i: usize, j: usize| {
            if i == j { 4.0 + i as f64 } else { 0.3 * ((3 * i + 7 * j) as f64).sin() / (1.0 + i.abs_diff(j) as f64) }
        };
        let wanted: Vec<f64> = (0..n).map(|i| (0.7 * i as f64).cos()).collect();
        let apply = |v: &[f64], out: &mut [f64]| {
            for (i, out) in out.iter_mut().enumerate() {
                *out = (0..n).map(|j| a(i, j) * v[j]).sum();
            }
        };
        let mut x = vec![0.0; n];
        apply(&wanted, &mut x);
        let diagonal = |v: &mut [f64]| v.iter_mut().enumerate().for_each(|(i, v)| *v /= a(i, i));
        assert!(gmres(apply, diagonal, &mut x, 1e-12, 40));
        assert!(x.iter().zip(&wanted).all(|(x, w)| (x - w).abs() < 1e-10));
        let mut hard = vec![1.0; n];
        assert!(!gmres(apply, diagonal, &mut hard, 1e-12, 2));
        assert_eq!(hard, vec![1.0; n]);
    }
}
