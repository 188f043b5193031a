//! Total-Lagrangian internal force and stiffness of one element.

use super::{gauss, quad8};
use crate::law::{Gradient, Law, first_piola, respond};

/// Reference data of one quadrature point; it never changes during a solve.
#[derive(Debug, Clone)]
struct Point {
    /// `2 pi R det(J) w`: reference volume of the point (mm^3).
    volume: f64,
    /// `[dN/dR, dN/dZ, N/R]` of each node (1/mm).
    grad: [[f64; 3]; 8],
}

/// Number of quadrature points an element is integrated with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quadrature {
    /// 2 x 2 points: the measured best in force error per second.
    Reduced,
    /// 3 x 3 points.
    Full,
}

/// One eight-node ring element.
#[derive(Debug, Clone)]
pub struct Solid {
    /// Its nodes, in the order of [`quad8`].
    pub nodes: [usize; 8],
    points: Vec<Point>,
}

/// Local degrees of freedom: `2 a` is radial, `2 a + 1` axial at node `a`.
pub const DOFS: usize = 16;
/// Entries of the lower triangle of the element stiffness, row by row.
pub const LOWER: usize = DOFS * (DOFS + 1) / 2;

impl Solid {
    /// Prepares an element with the corner and middle positions `x` (mm).
    #[must_use]
    pub fn new(nodes: [usize; 8], x: &[[f64; 2]; 8], quadrature: Quadrature) -> Self {
        let rule = gauss(match quadrature {
            Quadrature::Reduced => 2,
            Quadrature::Full => 3,
        });
        let mut points = Vec::with_capacity(rule.len() * rule.len());
        for &(a, wa) in &rule {
            for &(b, wb) in &rule {
                points.push(Point::new(x, a, b, wa * wb));
            }
        }
        Self { nodes, points }
    }

    fn gradient(point: &Point, u: &[f64; DOFS]) -> Gradient {
        let mut f = [1.0, 0.0, 0.0, 1.0, 1.0];
        for (a, g) in point.grad.iter().enumerate() {
            let (ur, uz) = (u[2 * a], u[2 * a + 1]);
            f[0] += g[0] * ur;
            f[1] += g[1] * ur;
            f[2] += g[0] * uz;
            f[3] += g[1] * uz;
            f[4] += g[2] * ur;
        }
        f
    }

    /// Adds the internal force to `force` and returns the strain energy (N mm);
    /// `None` when the element is turned inside out.
    #[must_use]
    pub fn force(&self, law: &impl Law, u: &[f64; DOFS], force: &mut [f64; DOFS]) -> Option<f64> {
        let mut energy = 0.0;
        for point in &self.points {
            let (w, p) = first_piola(law, &Self::gradient(point, u))?;
            energy += point.volume * w;
            point.add_force(&p, force);
        }
        Some(energy)
    }

    /// Adds internal force and the lower triangle of the stiffness, returns the
    /// strain energy (N mm); `None` when the element is turned inside out.
    #[must_use]
    pub fn stiffness(
        &self,
        law: &impl Law,
        u: &[f64; DOFS],
        force: &mut [f64; DOFS],
        lower: &mut [f64; LOWER],
    ) -> Option<f64> {
        let mut energy = 0.0;
        for point in &self.points {
            let response = respond(law, &Self::gradient(point, u))?;
            energy += point.volume * response.energy;
            point.add_force(&response.stress, force);
            point.add_stiffness(&response.tangent, lower);
        }
        Some(energy)
    }
}

impl Point {
    fn new(x: &[[f64; 2]; 8], a: f64, b: f64, weight: f64) -> Self {
        let (n, d) = quad8(a, b);
        let (mut radius, mut j) = (0.0, [[0.0; 2]; 2]);
        for i in 0..8 {
            radius += n[i] * x[i][0];
            for k in 0..2 {
                j[k][0] += d[i][0] * x[i][k];
                j[k][1] += d[i][1] * x[i][k];
            }
        }
        let det = j[0][0] * j[1][1] - j[0][1] * j[1][0];
        let grad = std::array::from_fn(|i| {
            [
                (d[i][0] * j[1][1] - d[i][1] * j[1][0]) / det,
                (d[i][1] * j[0][0] - d[i][0] * j[0][1]) / det,
                n[i] / radius,
            ]
        });
        Self { volume: std::f64::consts::TAU * radius * det * weight, grad }
    }

    fn add_force(&self, p: &[f64; 5], force: &mut [f64; DOFS]) {
        let p = p.map(|x| x * self.volume);
        for (a, g) in self.grad.iter().enumerate() {
            force[2 * a] += g[0] * p[0] + g[1] * p[1] + g[2] * p[4];
            force[2 * a + 1] += g[0] * p[2] + g[1] * p[3];
        }
    }

    /// `B' A B` for the rows of node `a`: radial dofs move `[rr, rz, tt]`, axial `[zr, zz]`.
    fn add_stiffness(&self, tangent: &[[f64; 5]; 5], lower: &mut [f64; LOWER]) {
        let t = tangent.map(|row| row.map(|x| x * self.volume));
        let mut at = 0;
        for (a, g) in self.grad.iter().enumerate() {
            // rows of B' A for the two dofs of node a
            let r: [f64; 5] = std::array::from_fn(|k| g[0] * t[0][k] + g[1] * t[1][k] + g[2] * t[4][k]);
            let z: [f64; 5] = std::array::from_fn(|k| g[0] * t[2][k] + g[1] * t[3][k]);
            let row_z = at + 2 * a + 1;
            for (b, q) in self.grad[..=a].iter().enumerate() {
                lower[at + 2 * b] += r[0] * q[0] + r[1] * q[1] + r[4] * q[2];
                if b < a {
                    lower[at + 2 * b + 1] += r[2] * q[0] + r[3] * q[1];
                }
                lower[row_z + 2 * b] += z[0] * q[0] + z[1] * q[1] + z[4] * q[2];
                lower[row_z + 2 * b + 1] += z[2] * q[0] + z[3] * q[1];
            }
            at = row_z + 2 * a + 2;
        }
    }
}
