//! Total-Lagrangian ring element of a material.

use crate::fem::element::{Element, Point};
use crate::fem::operator::{self, Operator, PointLaw, PointTangent};
use crate::fem::place::place;
use crate::fem::quadrature::gauss;
use crate::fem::shape::quad8;
use crate::scalar::Real;
use crate::solid::law::{Gradient, Material, Relaxation, Strained};

/// Number of quadrature points an element is integrated with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quadrature {
    /// 2 x 2 points: the measured best in force error per second, and free of volumetric locking.
    Reduced,
    /// 3 x 3 points.
    Full,
}

/// One eight-node ring element, its nodes in the order of [`quad8`]; its strain is the deformation gradient
/// `[rr, rz, zr, zz, tt]`.
pub type Solid<T = f64> = Element<T, Ring<T>, 8>;

/// Local degrees of freedom: `2 a` is radial, `2 a + 1` axial at node `a`.
pub const DOFS: usize = 16;

/// Element stiffness, `K[i][j] = d force_i / d u_j` (N/mm).
pub type Stiffness = [[f64; DOFS]; DOFS];

/// `[dN/dR, dN/dZ, N/R]` of a node at a point (1/mm): what its displacement does to the gradient.
#[derive(Debug, Clone, Copy)]
pub struct Ring<T>([T; 3]);

impl<T: Real> Operator<T, 2, 5> for Ring<T> {
    #[inline]
    fn strain(&self, u: &[T; 2], f: &mut [T; 5]) {
        let Ring(g) = self;
        f[0] += g[0] * u[0];
        f[1] += g[1] * u[0];
        f[2] += g[0] * u[1];
        f[3] += g[1] * u[1];
        f[4] += g[2] * u[0];
    }

    /// Radial displacements move `[rr, rz, tt]`, axial ones `[zr, zz]`.
    #[inline]
    fn force(&self, p: &[T; 5]) -> [T; 2] {
        let Ring(g) = self;
        [g[0] * p[0] + g[1] * p[1] + g[2] * p[4], g[0] * p[2] + g[1] * p[3]]
    }
}

/// What the points of an element are made of in one step in time.
#[derive(Debug)]
pub struct Matter<'a, T = f64> {
    /// The material.
    pub material: &'a Material<T>,
    /// Factors of the time step.
    pub step: &'a Relaxation<T>,
}

impl<T: Strained> PointLaw<T, 5> for Matter<'_, T> {
    fn rest(&self) -> [T; 5] {
        let (one, zero) = (T::from(1.0), T::from(0.0));
        [one, zero, zero, one, one]
    }

    fn states(&self) -> usize {
        self.material.history()
    }

    fn flux(&self, f: &[T; 5], old: &[T], new: Option<&mut [T]>) -> Option<(T, [T; 5])> {
        self.material.stress(self.step, f, old, new)
    }
}

impl PointTangent<5> for Matter<'_> {
    fn response(&self, f: &Gradient, old: &[f64]) -> Option<operator::Response<5>> {
        let r = self.material.respond(self.step, f, old)?;
        Some(operator::Response { energy: r.energy, flux: r.stress, tangent: r.tangent })
    }
}

impl<T: Real> Solid<T> {
    /// Prepares an element with the corner and middle positions `x` (mm). Its points' volumes are
    /// `2 pi R det(J) w` (mm^3).
    #[must_use]
    pub fn new(nodes: [usize; 8], x: &[[T; 2]; 8], quadrature: Quadrature) -> Self {
        let rule = gauss(match quadrature {
            Quadrature::Reduced => 2,
            Quadrature::Full => 3,
        });
        let mut points = Vec::with_capacity(rule.len() * rule.len());
        for &(a, wa) in &rule {
            for &(b, wb) in &rule {
                points.push(point(x, a, b, wa * wb));
            }
        }
        Self::of(nodes, points)
    }

    /// Deformation gradient `[rr, rz, zr, zz, tt]` at every material point.
    pub fn gradients(&self, u: &[T; DOFS]) -> impl Iterator<Item = [T; 5]> {
        let (one, zero) = (T::from(1.0), T::from(0.0));
        self.strains([one, zero, zero, one, one], u)
    }
}

fn point<T: Real>(x: &[[T; 2]; 8], a: f64, b: f64, weight: f64) -> Point<T, Ring<T>, 8> {
    let (n, d) = quad8(a, b);
    let here = place(x, &n, &d);
    let radius = here.at[0];
    let operators = std::array::from_fn(|i| Ring([here.slope[i][0], here.slope[i][1], T::from(n[i]) / radius]));
    Point { volume: radius * here.det * (std::f64::consts::TAU * weight), operators }
}
