//! Plane or ring: what a node does to the deformation gradient.

use crate::fem::element::{Element, Point};
use crate::fem::operator::Operator;
use crate::fem::place::place;
use crate::fem::quadrature::gauss;
use crate::fem::shape::quad8;

/// What the half plane x >= 0 is a section of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Section {
    /// A long body under plane strain; forces are per mm of its length, of both halves.
    Plane,
    /// A body of revolution about x = 0.
    #[default]
    Ring,
}

impl Section {
    /// Depth of the body at `x`, mm; in the plane 1 mm of both halves.
    #[must_use]
    pub fn depth_mm(self, x: f64) -> f64 {
        match self {
            Self::Plane => 2.0,
            Self::Ring => std::f64::consts::TAU * x,
        }
    }

    /// Area of the flat print of a contact of this radius (mm2); in the plane its width (mm).
    #[must_use]
    pub fn print_mm2(self, radius_mm: f64) -> f64 {
        match self {
            Section::Plane => 2.0 * radius_mm,
            Section::Ring => std::f64::consts::PI * radius_mm * radius_mm,
        }
    }
}

/// Points that an element is integrated with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Rule {
    /// 2 x 2: does not lock where the volume hardly changes.
    #[default]
    Reduced,
    /// 3 x 3.
    Full,
}

/// `[dN/dx, dN/dy, N/x]` of a node at a point (1/mm), the last 0 in the plane.
#[derive(Debug, Clone, Copy)]
pub struct Slope([f64; 3]);

impl Operator<f64, 2, 5> for Slope {
    #[inline]
    fn strain(&self, u: &[f64; 2], f: &mut [f64; 5]) {
        let Slope(g) = self;
        f[0] += g[0] * u[0];
        f[1] += g[1] * u[0];
        f[2] += g[0] * u[1];
        f[3] += g[1] * u[1];
        f[4] += g[2] * u[0];
    }

    #[inline]
    fn force(&self, p: &[f64; 5]) -> [f64; 2] {
        let Slope(g) = self;
        [g[0] * p[0] + g[1] * p[1] + g[2] * p[4], g[0] * p[2] + g[1] * p[3]]
    }
}

/// An element of eight nodes.
pub type Quad = Element<f64, Slope, 8>;

impl Section {
    /// The element with nodes at `x` (mm); `None` where it turns over.
    #[must_use]
    pub fn element(self, rule: Rule, nodes: [usize; 8], x: &[[f64; 2]; 8]) -> Option<Quad> {
        let line = gauss(if rule == Rule::Reduced { 2 } else { 3 });
        let mut points = Vec::with_capacity(line.len() * line.len());
        for &(a, wa) in &line {
            for &(b, wb) in &line {
                let (n, d) = quad8(a, b);
                let here = place(x, &n, &d);
                if here.det.is_nan() || here.det <= 0.0 {
                    return None;
                }
                let hoop = if self == Self::Ring { 1.0 / here.at[0] } else { 0.0 };
                let operators = std::array::from_fn(|i| Slope([here.slope[i][0], here.slope[i][1], n[i] * hoop]));
                points.push(Point { volume: self.depth_mm(here.at[0]) * here.det * wa * wb, operators });
            }
        }
        Some(Element::of(nodes, points))
    }
}
