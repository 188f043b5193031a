//! Where a point of an element is, and how fast its shape functions change there.

use crate::scalar::Real;

/// A point of an element's map from natural to real coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place<T, const NODES: usize> {
    /// Position (mm).
    pub at: [T; 2],
    /// Determinant of the map: area per natural area (mm^2), negative where the element turns over.
    pub det: T,
    /// Slopes of the shape functions along the two real directions (1/mm).
    pub slope: [[T; 2]; NODES],
}

/// Maps an element with nodes at `x` (mm) at the point of the given shape functions and natural slopes.
#[must_use]
pub fn place<T: Real, const NODES: usize>(
    x: &[[T; 2]; NODES],
    shape: &[f64; NODES],
    natural: &[[f64; 2]; NODES],
) -> Place<T, NODES> {
    let zero = T::from(0.0);
    let (mut at, mut j) = ([zero; 2], [[zero; 2]; 2]);
    for i in 0..NODES {
        for k in 0..2 {
            at[k] += x[i][k] * shape[i];
            j[k][0] += x[i][k] * natural[i][0];
            j[k][1] += x[i][k] * natural[i][1];
        }
    }
    let det = j[0][0] * j[1][1] - j[0][1] * j[1][0];
    let slope = std::array::from_fn(|i| {
        let d = natural[i];
        [(j[1][1] * d[0] - j[1][0] * d[1]) / det, (j[0][0] * d[1] - j[0][1] * d[0]) / det]
    });
    Place { at, det, slope }
}
