//! Total-Lagrangian internal force and stiffness of one element.

use super::{gauss, quad8};
use crate::law::{Material, Relaxation, Strained};
use crate::scalar::Real;

/// Reference data of one quadrature point; it never changes during a solve.
#[derive(Debug, Clone)]
struct Point<T> {
    /// `2 pi R det(J) w`: reference volume of the point (mm^3).
    volume: T,
    /// `[dN/dR, dN/dZ, N/R]` of each node (1/mm).
    grad: [[T; 3]; 8],
}

/// Number of quadrature points an element is integrated with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quadrature {
    /// 2 x 2 points: the measured best in force error per second, and free of volumetric locking.
    Reduced,
    /// 3 x 3 points.
    Full,
}

/// One eight-node ring element.
#[derive(Debug, Clone)]
pub struct Solid<T = f64> {
    /// Its nodes, in the order of [`quad8`].
    pub nodes: [usize; 8],
    points: Vec<Point<T>>,
}

/// Local degrees of freedom: `2 a` is radial, `2 a + 1` axial at node `a`.
pub const DOFS: usize = 16;

/// Element stiffness, `K[i][j] = d force_i / d u_j` (N/mm).
pub type Stiffness = [[f64; DOFS]; DOFS];

/// What the points of an element are made of, and what they remember.
#[derive(Debug)]
pub struct Matter<'a, T = f64> {
    /// The material.
    pub material: &'a Material<T>,
    /// Factors of the time step.
    pub step: &'a Relaxation<T>,
    /// History of the element's points at the step's start, [`Material::history`] numbers each.
    pub history: &'a [T],
}

impl<T: Strained> Solid<T> {
    /// Prepares an element with the corner and middle positions `x` (mm).
    #[must_use]
    pub fn new(nodes: [usize; 8], x: &[[T; 2]; 8], quadrature: Quadrature) -> Self {
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

    /// Number of material points.
    #[must_use]
    pub fn points(&self) -> usize {
        self.points.len()
    }

    /// Reference volume (mm^3) of every material point.
    pub fn volumes(&self) -> impl Iterator<Item = T> {
        self.points.iter().map(|p| p.volume)
    }

    /// Deformation gradient `[rr, rz, zr, zz, tt]` at every material point.
    pub fn gradients(&self, u: &[T; DOFS]) -> impl Iterator<Item = [T; 5]> {
        self.points.iter().map(|p| p.gradient(u))
    }

    /// Adds the internal force (N) to `force` and returns the strain energy (N mm) of the
    /// elastic law; `new` receives the history at the step's end. `None` when the element
    /// is turned inside out.
    #[must_use]
    pub fn force(
        &self,
        matter: &Matter<T>,
        u: &[T; DOFS],
        force: &mut [T; DOFS],
        mut new: Option<&mut [T]>,
    ) -> Option<T> {
        let each = matter.material.history();
        let mut energy = T::from(0.0);
        for (i, point) in self.points.iter().enumerate() {
            let range = i * each..(i + 1) * each;
            let kept = new.as_deref_mut().map(|h| &mut h[range.clone()]);
            let (w, p) = matter.material.stress(matter.step, &point.gradient(u), &matter.history[range], kept)?;
            energy += point.volume * w;
            point.add_force(&p, force);
        }
        Some(energy)
    }
}

impl Solid {
    /// Adds internal force and stiffness, returns the strain energy (N mm); `None` when the
    /// element is turned inside out. Of a symmetric stiffness only the lower triangle is filled.
    #[must_use]
    pub fn stiffness(
        &self,
        matter: &Matter,
        u: &[f64; DOFS],
        force: &mut [f64; DOFS],
        stiffness: &mut Stiffness,
        symmetric: bool,
    ) -> Option<f64> {
        let each = matter.material.history();
        let mut energy = 0.0;
        for (i, point) in self.points.iter().enumerate() {
            let old = &matter.history[i * each..(i + 1) * each];
            let response = matter.material.respond(matter.step, &point.gradient(u), old)?;
            energy += point.volume * response.energy;
            point.add_force(&response.stress, force);
            point.add_stiffness(&response.tangent, stiffness, symmetric);
        }
        Some(energy)
    }
}

impl<T: Real> Point<T> {
    fn new(x: &[[T; 2]; 8], a: f64, b: f64, weight: f64) -> Self {
        let (n, d) = quad8(a, b);
        let zero = T::from(0.0);
        let (mut radius, mut j) = (zero, [[zero; 2]; 2]);
        for i in 0..8 {
            radius += x[i][0] * n[i];
            for k in 0..2 {
                j[k][0] += x[i][k] * d[i][0];
                j[k][1] += x[i][k] * d[i][1];
            }
        }
        let det = j[0][0] * j[1][1] - j[0][1] * j[1][0];
        let grad = std::array::from_fn(|i| {
            [
                (j[1][1] * d[i][0] - j[1][0] * d[i][1]) / det,
                (j[0][0] * d[i][1] - j[0][1] * d[i][0]) / det,
                T::from(n[i]) / radius,
            ]
        });
        Self { volume: radius * det * (std::f64::consts::TAU * weight), grad }
    }

    fn gradient(&self, u: &[T; DOFS]) -> [T; 5] {
        let (one, zero) = (T::from(1.0), T::from(0.0));
        let mut f = [one, zero, zero, one, one];
        for (a, g) in self.grad.iter().enumerate() {
            let (ur, uz) = (u[2 * a], u[2 * a + 1]);
            f[0] += g[0] * ur;
            f[1] += g[1] * ur;
            f[2] += g[0] * uz;
            f[3] += g[1] * uz;
            f[4] += g[2] * ur;
        }
        f
    }

    fn add_force(&self, p: &[T; 5], force: &mut [T; DOFS]) {
        let p = p.map(|x| x * self.volume);
        for (a, g) in self.grad.iter().enumerate() {
            force[2 * a] += g[0] * p[0] + g[1] * p[1] + g[2] * p[4];
            force[2 * a + 1] += g[0] * p[2] + g[1] * p[3];
        }
    }
}

impl Point<f64> {
    /// `B' A B` for the rows of node `a`: radial dofs move `[rr, rz, tt]`, axial `[zr, zz]`.
    fn add_stiffness(&self, tangent: &[[f64; 5]; 5], stiffness: &mut Stiffness, symmetric: bool) {
        let t = tangent.map(|row| row.map(|x| x * self.volume));
        for (a, g) in self.grad.iter().enumerate() {
            // rows of B' A for the two dofs of node a
            let r: [f64; 5] = std::array::from_fn(|k| g[0] * t[0][k] + g[1] * t[1][k] + g[2] * t[4][k]);
            let z: [f64; 5] = std::array::from_fn(|k| g[0] * t[2][k] + g[1] * t[3][k]);
            let columns = if symmetric { a + 1 } else { 8 };
            for (b, q) in self.grad[..columns].iter().enumerate() {
                stiffness[2 * a][2 * b] += r[0] * q[0] + r[1] * q[1] + r[4] * q[2];
                stiffness[2 * a][2 * b + 1] += r[2] * q[0] + r[3] * q[1];
                stiffness[2 * a + 1][2 * b] += z[0] * q[0] + z[1] * q[1] + z[4] * q[2];
                stiffness[2 * a + 1][2 * b + 1] += z[2] * q[0] + z[3] * q[1];
            }
        }
    }
}
