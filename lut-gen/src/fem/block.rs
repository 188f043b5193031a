//! Serendipity (8-node) mesh of a rectangle `[0, W] x [0, h]` in the r-z plane.

/// Nodes and elements; the base is z = 0, the top z = height.
#[derive(Debug, Clone)]
pub struct BlockMesh {
    /// Node positions `[r, z]` (mm).
    pub nodes: Vec<[f64; 2]>,
    /// Nodes of each element: four corners counter-clockwise from inner bottom,
    /// then the middles of bottom, outer, top, inner side.
    pub elements: Vec<[usize; 8]>,
    /// Surface edges from the axis outward: inner, middle, outer node.
    pub top: Vec<[usize; 3]>,
    /// Height of the block (mm).
    pub height_mm: f64,
    /// Radius of the block (mm).
    pub radius_mm: f64,
}

impl BlockMesh {
    /// Edges of the side from the top downward: upper, middle, lower node.
    #[must_use]
    pub fn side(&self) -> Vec<[usize; 3]> {
        let outer = |e: &[usize; 8]| [e[2], e[5], e[1]];
        let mut edges: Vec<_> =
            self.elements.iter().map(outer).filter(|e| e.iter().all(|n| self.nodes[*n][0] >= self.radius_mm)).collect();
        edges.reverse();
        edges
    }

    /// Meshes the rectangle spanned by the given lines (each sorted, at least two).
    #[must_use]
    pub fn from_lines(r: &[f64], z: &[f64]) -> Self {
        let (nr, nz) = (r.len() - 1, z.len() - 1);
        // Nodes stand on a (2 nr + 1) x (2 nz + 1) lattice without the cell centres.
        let at = |k: usize, x: &[f64]| {
            if k.is_multiple_of(2) { x[k / 2] } else { 0.5 * (x[k / 2] + x[k / 2 + 1]) }
        };
        let mut nodes = Vec::new();
        let mut id = vec![usize::MAX; (2 * nr + 1) * (2 * nz + 1)];
        let cell = |i: usize, j: usize| i * (2 * nz + 1) + j;
        for i in 0..=2 * nr {
            for j in 0..=2 * nz {
                if i.is_multiple_of(2) || j.is_multiple_of(2) {
                    id[cell(i, j)] = nodes.len();
                    nodes.push([at(i, r), at(j, z)]);
                }
            }
        }
        let node = |i: usize, j: usize| id[cell(i, j)];
        let mut elements = Vec::with_capacity(nr * nz);
        for i in 0..nr {
            for j in 0..nz {
                let (a, b) = (2 * i, 2 * j);
                elements.push([
                    node(a, b),
                    node(a + 2, b),
                    node(a + 2, b + 2),
                    node(a, b + 2),
                    node(a + 1, b),
                    node(a + 2, b + 1),
                    node(a + 1, b + 2),
                    node(a, b + 1),
                ]);
            }
        }
        let top = (0..nr).map(|i| [node(2 * i, 2 * nz), node(2 * i + 1, 2 * nz), node(2 * i + 2, 2 * nz)]).collect();
        Self { nodes, elements, top, height_mm: z[nz], radius_mm: r[nr] }
    }
}
