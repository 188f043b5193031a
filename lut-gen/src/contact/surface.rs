//! Penalty contact integrated over the undeformed top surface.

use super::Ball;
use crate::element::{gauss, line3};

/// One quadrature point of the surface.
#[derive(Debug, Clone, Copy)]
struct Point {
    /// Reference area of the ring it stands for, `2 pi R w` (mm^2).
    area: f64,
    /// Reference position `[r, z]` (mm).
    at: [f64; 2],
    /// Shape functions of the three nodes of its edge.
    shape: [f64; 3],
}

/// The part of the block's top that can touch the ball.
///
/// Contact is the energy `E = k/2 integral <g>^2 dA` over the reference area
/// with penetration `g`; pressure is `k g` per reference area. Integrating
/// between the nodes lets the contact edge move smoothly through an element.
#[derive(Debug, Clone)]
pub struct Surface {
    ball: Ball,
    edges: Vec<[usize; 3]>,
    points: Vec<Point>,
    per_edge: usize,
    /// Penalty `k` (MPa/mm).
    penalty: f64,
}

/// Sums over the surface at one configuration.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Sum {
    /// Penalty energy `E` (N mm).
    pub energy: f64,
    /// Force on the ball, upward, `dE/dd` (N).
    pub force_n: f64,
    /// `d2E/dd2` at fixed displacement (N/mm).
    pub stiffness: f64,
    /// Points in contact.
    pub active: usize,
    /// Largest current radius of a point in contact (mm).
    pub radius_mm: f64,
}

/// Second derivative of an edge's penalty energy: displacement dofs of its three
/// nodes (radial, axial each), then the depth of the ball.
pub type EdgeStiffness = [[f64; 7]; 7];

impl Surface {
    /// Contact of `ball` with the edges of `top` that start within `reach_mm` of the axis.
    #[must_use]
    pub fn new(
        ball: Ball,
        nodes: &[[f64; 2]],
        top: &[[usize; 3]],
        reach_mm: f64,
        per_edge: usize,
        penalty: f64,
    ) -> Self {
        let rule = gauss(per_edge);
        let edges: Vec<_> = top.iter().copied().filter(|e| nodes[e[0]][0] < reach_mm).collect();
        let mut points = Vec::with_capacity(edges.len() * per_edge);
        for e in &edges {
            for &(x, w) in &rule {
                let (shape, slope) = line3(x);
                let sum = |f: &[f64; 3], k: usize| (0..3).map(|i| f[i] * nodes[e[i]][k]).sum::<f64>();
                let at = [sum(&shape, 0), sum(&shape, 1)];
                points.push(Point { area: std::f64::consts::TAU * at[0] * sum(&slope, 0) * w, at, shape });
            }
        }
        Self { ball, edges, points, per_edge, penalty }
    }

    /// The ball.
    #[must_use]
    pub fn ball(&self) -> Ball {
        self.ball
    }

    /// The edges, in the order of [`Surface::edge`].
    #[must_use]
    pub fn edges(&self) -> &[[usize; 3]] {
        &self.edges
    }

    /// Adds one edge: nodal forces (gradient of `E`) to `force`, second
    /// derivatives to `stiffness` when given. `u` holds the edge's dofs.
    pub fn edge(
        &self,
        index: usize,
        centre_mm: f64,
        u: &[f64; 6],
        force: &mut [f64; 6],
        mut stiffness: Option<&mut EdgeStiffness>,
        sum: &mut Sum,
    ) {
        for p in &self.points[index * self.per_edge..][..self.per_edge] {
            let mut x = p.at;
            for (a, n) in p.shape.iter().enumerate() {
                x[0] += n * u[2 * a];
                x[1] += n * u[2 * a + 1];
            }
            let Some(t) = self.ball.touch(x, centre_mm) else {
                continue;
            };
            let k = self.penalty * p.area;
            let g = t.depth_mm;
            sum.energy += 0.5 * k * g * g;
            sum.force_n -= k * g * t.normal[1];
            sum.active += 1;
            sum.radius_mm = sum.radius_mm.max(x[0]);
            for (a, n) in p.shape.iter().enumerate() {
                force[2 * a] -= k * g * n * t.normal[0];
                force[2 * a + 1] -= k * g * n * t.normal[1];
            }
            // d2(g^2/2) = n n' - g c (1 - n n'), and a deeper ball is the point moved up.
            let bend = g * t.curvature;
            let h = |i: usize, j: usize| {
                let nn = t.normal[i] * t.normal[j];
                k * (nn - bend * (f64::from(u8::from(i == j)) - nn))
            };
            let h = [[h(0, 0), h(0, 1)], [h(1, 0), h(1, 1)]];
            sum.stiffness += h[1][1];
            if let Some(s) = stiffness.as_deref_mut() {
                for (a, na) in p.shape.iter().enumerate() {
                    for i in 0..2 {
                        for (b, nb) in p.shape.iter().enumerate() {
                            for j in 0..2 {
                                s[2 * a + i][2 * b + j] += na * nb * h[i][j];
                            }
                        }
                        s[2 * a + i][6] += na * h[i][1];
                    }
                }
            }
        }
    }
}
