//! Flux density at a point from the slopes of the triangles around it.
//!
//! The slope of a second-order triangle errs by the square of its size, and with another sign a triangle further. A quadratic
//! through the slopes of all triangles around the point, by least squares, takes most of that away (after Zienkiewicz and
//! Zhu, Int. J. Numer. Meth. Eng. 33, 1992, 1331-1364). Only triangles of the point's own region count, for the flux density
//! jumps where regions meet.

use super::field::{Field, Solution};
use super::point::{gradient, point};

/// Where slopes are sampled in a triangle: barycentric coordinates.
const SAMPLES: [[f64; 3]; 3] = {
    const A: f64 = 1.0 / 6.0;
    const B: f64 = 2.0 / 3.0;
    [[B, A, A], [A, B, A], [A, A, B]]
};

/// Coefficients of a quadratic.
const TERMS: usize = 6;
/// Triangles that a fit wants: three slopes each, for six coefficients.
const LEAST: usize = 7;

impl Field {
    /// g at a point of triangle `t` by a quadratic fit; `None` where too few triangles of its region are around.
    pub(super) fn fitted(&self, solution: &Solution, t: usize, at: [f64; 2]) -> Option<[f64; 2]> {
        let patch = self.patch(t);
        if patch.len() < LEAST {
            return None;
        }
        let mut samples = Vec::with_capacity(3 * patch.len());
        for t in patch {
            let own = self.own(solution, t);
            for l in SAMPLES {
                let point = point(&self.mesh, self.geometry, t, l, 1.0)?;
                let x = self.position(t, l);
                samples.push(([x[0] - at[0], x[1] - at[1]], gradient(&point, &own)));
            }
        }
        fit(&samples)
    }

    /// Triangles of the region of `t` that share a node with it, itself among them, and their neighbours while they are few.
    fn patch(&self, t: usize) -> Vec<usize> {
        let count = self.mesh.order.nodes();
        let region = self.mesh.regions[t];
        let mut patch = vec![t];
        for _ in 0..2 {
            let mut wider = patch.clone();
            for own in &patch {
                for node in &self.mesh.triangles[*own][..count] {
                    wider.extend(self.around[*node].iter().filter(|o| self.mesh.regions[**o] == region));
                }
            }
            wider.sort_unstable();
            wider.dedup();
            patch = wider;
            if patch.len() >= LEAST {
                break;
            }
        }
        patch
    }

    fn position(&self, t: usize, l: [f64; 3]) -> [f64; 2] {
        let shape = self.mesh.order.shapes(l);
        let mut x = [0.0; 2];
        for (n, node) in self.mesh.triangles[t].iter().enumerate().take(self.mesh.order.nodes()) {
            for (x, p) in x.iter_mut().zip(self.mesh.nodes[*node]) {
                *x += shape[n] * p;
            }
        }
        x
    }
}

/// The value at the origin of quadratics through samples of two numbers, by least squares; near samples count more.
fn fit(samples: &[([f64; 2], [f64; 2])]) -> Option<[f64; 2]> {
    let far = samples.iter().map(|(x, _)| x[0].hypot(x[1])).fold(0.0, f64::max);
    // Normal equations with two right-hand sides, in parts of the farthest distance.
    let mut rows = [[0.0; TERMS + 2]; TERMS];
    for ([x, y], value) in samples {
        let (x, y) = (x / far, y / far);
        let weight = (-2.0 * (x * x + y * y)).exp();
        let terms = [1.0, x, y, x * x, x * y, y * y];
        for (i, row) in rows.iter_mut().enumerate() {
            for (j, other) in terms.iter().enumerate() {
                row[j] += weight * terms[i] * other;
            }
            row[TERMS] += weight * terms[i] * value[0];
            row[TERMS + 1] += weight * terms[i] * value[1];
        }
    }
    // Elimination from the last term up leaves the first, which is the value at the origin.
    for i in (1..TERMS).rev() {
        let pivot = rows[i];
        if pivot[i] <= 1e-10 * rows[0][0] {
            return None;
        }
        for row in rows.iter_mut().take(i) {
            let factor = row[i] / pivot[i];
            row.iter_mut().zip(pivot).for_each(|(own, other)| *own -= factor * other);
        }
    }
    (rows[0][0] > 0.0).then(|| [rows[0][TERMS] / rows[0][0], rows[0][TERMS + 1] / rows[0][0]])
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_quadratic_is_recovered_to_rounding() {
        let of = |x: f64, y: f64| [3.0 + x - 2.0 * y + 0.5 * x * x - x * y + y * y, -1.0 + 4.0 * x * y];
        let samples: Vec<_> = (0..5)
            .flat_map(|i| (0..5).map(move |j| [f64::from(i) * 0.3 - 0.5, f64::from(j) * 0.2 - 0.3]))
            .map(|p| (p, of(p[0], p[1])))
            .collect();
        let [a, b] = fit(&samples).unwrap();
        assert!((a - 3.0).abs() < 1e-12 && (b + 1.0).abs() < 1e-12, "{a} {b}");
        // On a line there is no quadratic in the plane.
        let line: Vec<_> = samples.iter().map(|(p, v)| ([p[0], 0.0], *v)).collect();
        assert_eq!(fit(&line), None);
    }
}
