//! Points of a mesh's triangles: areas, shapes and what they put into the flux density.

use crate::fem::mesh::Mesh;
use crate::fem::triangle::NODES;

use super::field::{FieldError, Geometry};

/// Radius below which a point is on the axis, mm.
const ON_AXIS_MM: f64 = 1e-9;

/// A point of integration.
#[derive(Debug, Clone)]
pub(super) struct Point {
    /// Area times its weight, mm^2.
    pub area: f64,
    /// w: 1, or the radius, mm.
    pub width: f64,
    pub shape: [f64; NODES],
    /// What the shapes put into g, 1/mm: their slopes along x and y, and about an axis N/r in the first.
    pub slope: [[f64; 2]; NODES],
}

/// What a potential at the nodes makes of g.
pub(super) fn gradient(point: &Point, own: &[f64; NODES]) -> [f64; 2] {
    let mut g = [0.0; 2];
    for (slope, value) in point.slope.iter().zip(own) {
        g[0] += slope[0] * value;
        g[1] += slope[1] * value;
    }
    g
}

/// The points of a triangle's rule.
pub(super) fn points(mesh: &Mesh, geometry: Geometry, t: usize) -> Result<Vec<Point>, FieldError> {
    let made = mesh.order.rule().iter().map(|(l, weight)| point(mesh, geometry, t, *l, *weight));
    made.collect::<Option<_>>()
        .ok_or_else(|| FieldError::Degenerate { region: mesh.regions[t], at: mesh.nodes[mesh.triangles[t][0]] })
}

/// A point of a triangle; `None` where it turns over.
pub(super) fn point(mesh: &Mesh, geometry: Geometry, t: usize, l: [f64; 3], weight: f64) -> Option<Point> {
    let count = mesh.order.nodes();
    let (shape, local) = (mesh.order.shapes(l), mesh.order.slopes(l));
    let (mut at, mut j) = ([0.0; 2], [[0.0; 2]; 2]);
    for n in 0..count {
        let x = mesh.nodes[mesh.triangles[t][n]];
        for i in 0..2 {
            at[i] += shape[n] * x[i];
            j[i][0] += x[i] * local[n][0];
            j[i][1] += x[i] * local[n][1];
        }
    }
    let det = j[0][0] * j[1][1] - j[0][1] * j[1][0];
    if det.is_nan() || det <= 0.0 {
        return None;
    }
    let mut slope = [[0.0; 2]; NODES];
    for n in 0..count {
        slope[n] = [
            (j[1][1] * local[n][0] - j[1][0] * local[n][1]) / det,
            (j[0][0] * local[n][1] - j[0][1] * local[n][0]) / det,
        ];
    }
    let mut width = 1.0;
    if geometry == Geometry::Axisymmetric {
        width = at[0];
        for n in 0..count {
            // On the axis A/r is dA/dr.
            slope[n][0] += if at[0] > ON_AXIS_MM { shape[n] / at[0] } else { slope[n][0] };
        }
    }
    Some(Point { area: 0.5 * det * weight, width, shape, slope })
}

/// Barycentric coordinates of a point in a triangle with curved sides, by Newton's method.
pub(super) fn coordinates(mesh: &Mesh, t: usize, at: [f64; 2]) -> Option<[f64; 3]> {
    let count = mesh.order.nodes();
    let mut l = [1.0 / 3.0; 3];
    for _ in 0..20 {
        let (shape, local) = (mesh.order.shapes(l), mesh.order.slopes(l));
        let (mut off, mut j) = (at, [[0.0; 2]; 2]);
        for n in 0..count {
            let x = mesh.nodes[mesh.triangles[t][n]];
            for i in 0..2 {
                off[i] -= shape[n] * x[i];
                j[i][0] += x[i] * local[n][0];
                j[i][1] += x[i] * local[n][1];
            }
        }
        let det = j[0][0] * j[1][1] - j[0][1] * j[1][0];
        let (b, c) = ((j[1][1] * off[0] - j[0][1] * off[1]) / det, (j[0][0] * off[1] - j[1][0] * off[0]) / det);
        l = [l[0] - b - c, l[1] + b, l[2] + c];
        if !(b.is_finite() && c.is_finite()) || l.iter().any(|x| x.abs() > 4.0) {
            return None;
        }
        if b.abs() + c.abs() < 1e-13 {
            return Some(l);
        }
    }
    None
}
