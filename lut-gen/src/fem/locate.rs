//! Which triangle of a mesh a point is in.

use super::mesh::Mesh;
use super::triangle::NODES;

/// Triangles by the cells of a grid that they reach into.
#[derive(Debug, Clone)]
pub struct Locator {
    low: [f64; 2],
    /// Cells a mm.
    per_mm: [f64; 2],
    cells: Vec<Vec<u32>>,
}

/// Cells of the grid along each side.
const CELLS: usize = 128;
/// Part of its box by which a triangle may reach beyond it: a curved side bulges.
const BULGE: f64 = 0.1;
/// Barycentric coordinate below which a point is outside.
const OUTSIDE: f64 = -1e-6;

impl Locator {
    /// Sorts the triangles of a mesh.
    #[must_use]
    pub fn new(mesh: &Mesh) -> Self {
        let (low, high) = bounds(mesh.nodes.iter().copied());
        let per_mm = [0, 1].map(|i| CELLS as f64 / (high[i] - low[i]).max(f64::MIN_POSITIVE));
        let mut own = Self { low, per_mm, cells: vec![Vec::new(); CELLS * CELLS] };
        for (t, triangle) in mesh.triangles.iter().enumerate() {
            let (low, high) = bounds(triangle[..mesh.order.nodes()].iter().map(|n| mesh.nodes[*n]));
            let more = [0, 1].map(|i| BULGE * (high[i] - low[i]));
            let (from, to) =
                (own.cell([low[0] - more[0], low[1] - more[1]]), own.cell([high[0] + more[0], high[1] + more[1]]));
            for i in from[0]..=to[0] {
                for j in from[1]..=to[1] {
                    own.cells[CELLS * i + j].push(t as u32);
                }
            }
        }
        own
    }

    fn cell(&self, at: [f64; 2]) -> [usize; 2] {
        [0, 1].map(|i| (((at[i] - self.low[i]) * self.per_mm[i]).max(0.0) as usize).min(CELLS - 1))
    }

    /// The triangle around a point (mm) of the mesh, with the point's barycentric coordinates; `None` outside. Of two
    /// triangles with a side in common the one that the point is deeper in.
    #[must_use]
    pub fn find(&self, mesh: &Mesh, at: [f64; 2]) -> Option<(usize, [f64; 3])> {
        let [i, j] = self.cell(at);
        let mut best: Option<(usize, [f64; 3])> = None;
        let least = |l: &[f64; 3]| l.iter().copied().fold(f64::INFINITY, f64::min);
        for t in &self.cells[CELLS * i + j] {
            let t = *t as usize;
            let Some(found) = coordinates(mesh, t, at) else { continue };
            if best.as_ref().is_none_or(|(_, l)| least(&found) > least(l)) {
                best = Some((t, found));
            }
        }
        best.filter(|(_, l)| least(l) > OUTSIDE)
    }
}

fn bounds(points: impl Iterator<Item = [f64; 2]>) -> ([f64; 2], [f64; 2]) {
    points.fold(([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]), |(low, high), p| {
        ([low[0].min(p[0]), low[1].min(p[1])], [high[0].max(p[0]), high[1].max(p[1])])
    })
}

/// Barycentric coordinates of a point in a triangle with curved sides, by Newton's method.
fn coordinates(mesh: &Mesh, t: usize, at: [f64; 2]) -> Option<[f64; 3]> {
    let x = mesh.places(t);
    let mut l = [1.0 / 3.0; 3];
    for _ in 0..20 {
        let (shape, local) = (mesh.order.shapes(l), mesh.order.slopes(l));
        let (mut off, mut j) = (at, [[0.0; 2]; 2]);
        for n in 0..NODES {
            for i in 0..2 {
                off[i] -= shape[n] * x[n][i];
                j[i][0] += x[n][i] * local[n][0];
                j[i][1] += x[n][i] * local[n][1];
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
