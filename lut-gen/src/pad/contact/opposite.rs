//! What lies across from a place of an edge.

use crate::fem::shape::line3;

/// An edge at its present place: positions of its three nodes (mm).
pub type Edge = [[f64; 2]; 3];

/// Coefficients of `x` (or `y`, component `i`) over an edge's coordinate: constant, linear,
/// quadratic.
fn parabola(edge: &Edge, i: usize) -> [f64; 3] {
    let [a, b, c] = edge.map(|at| at[i]);
    [b, 0.5 * (c - a), 0.5 * (a - 2.0 * b + c)]
}

/// An edge faces the other side as long as it runs outward everywhere.
#[must_use]
pub fn faces(edge: &Edge) -> bool {
    let [_, linear, quadratic] = parabola(edge, 0);
    linear > 2.0 * quadratic.abs()
}

/// Coordinate at which an edge that [`faces`] is at `x`; beyond its ends that of the parabola,
/// clamped to twice its length.
#[must_use]
pub fn coordinate(edge: &Edge, x: f64) -> f64 {
    let [constant, linear, quadratic] = parabola(edge, 0);
    let c = constant - x;
    let root = (linear * linear - 4.0 * quadratic * c).max(0.0).sqrt();
    (-2.0 * c / (linear + root)).clamp(-2.0, 2.0)
}

/// The other side at a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Opposite {
    /// Height (mm).
    pub height: f64,
    /// Its slope along x.
    pub slope: f64,
    /// Its second derivative along x (1/mm).
    pub bend: f64,
    /// Of an edge: its shape functions there, and their derivatives along x (1/mm).
    pub shapes: Option<([f64; 3], [f64; 3])>,
}

impl Opposite {
    /// An edge at `x`.
    #[must_use]
    pub fn edge(edge: &Edge, x: f64) -> Self {
        let at = coordinate(edge, x);
        let (shapes, natural) = line3(at);
        let [_, x1, x2] = parabola(edge, 0);
        let [_, y1, y2] = parabola(edge, 1);
        let along = x1 + 2.0 * x2 * at;
        let slope = (y1 + 2.0 * y2 * at) / along;
        Self {
            height: (0..3).map(|b| shapes[b] * edge[b][1]).sum(),
            slope,
            bend: 2.0 * (y2 - slope * x2) / (along * along),
            shapes: Some((shapes, natural.map(|n| n / along))),
        }
    }
}
