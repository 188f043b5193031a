//! Points of a mesh's triangles: areas, shapes and what they put into the flux density.

use crate::fem::domain::Domain;
use crate::fem::element::{self, Element};
use crate::fem::equations::Equations;
use crate::fem::mesh::Mesh;
use crate::fem::operator::{Operator, PointLaw, PointTangent, Response};
use crate::fem::place::place;
use crate::fem::triangle::{NODES, Order};

use super::bh::{Carlson, Law, Strength};

/// Radius below which a point is on the axis, mm.
const ON_AXIS_MM: f64 = 1e-9;
/// Flux density below which the law is its slope at zero, T.
const NO_FLUX_T: f64 = 1e-12;

/// The plane, or the half plane of radius and height.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Geometry {
    /// Per mm of depth.
    #[default]
    Plane,
    /// Radius is x, the axis is at x = 0.
    Axisymmetric,
}

impl Geometry {
    /// The flux density whose g this is, along x and y or r and z.
    pub(super) const fn flux(self, [x, y]: [f64; 2]) -> [f64; 2] {
        match self {
            Geometry::Plane => [y, -x],
            Geometry::Axisymmetric => [-y, x],
        }
    }

    /// The vector whose product with g is that of `v` with the flux density.
    pub(super) const fn turned(self, v: [f64; 2]) -> [f64; 2] {
        match self {
            Geometry::Plane => [-v[1], v[0]],
            Geometry::Axisymmetric => [v[1], -v[0]],
        }
    }
}

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

/// What the potential of a node puts into g, 1/mm.
#[derive(Debug, Clone, Copy)]
pub(super) struct Turn([f64; 2]);

impl Operator<f64, 1, 2> for Turn {
    #[inline]
    fn strain(&self, [potential]: &[f64; 1], g: &mut [f64; 2]) {
        g[0] += self.0[0] * potential;
        g[1] += self.0[1] * potential;
    }

    #[inline]
    fn force(&self, h: &[f64; 2]) -> [f64; 1] {
        [self.0[0] * h[0] + self.0[1] * h[1]]
    }
}

/// A law of the amount of the flux density, as one of g: the flux is the field strength along it, A/mm.
#[derive(Debug, Clone, Copy)]
pub(super) enum Isotropic<'a> {
    Law(&'a Law),
    /// A fluid, whose coefficients cost as much as one of its points.
    Fluid(Carlson),
}

impl<'a> Isotropic<'a> {
    /// The law as it is asked at many points.
    pub fn of(law: &'a Law) -> Self {
        match law {
            Law::Fluid(fraction) => Isotropic::Fluid(Carlson::of(*fraction)),
            other => Isotropic::Law(other),
        }
    }

    #[inline]
    fn at(&self, b_t: f64) -> Strength {
        match self {
            Isotropic::Law(law) => law.at(b_t),
            Isotropic::Fluid(carlson) => carlson.at(b_t),
        }
    }
}

impl PointLaw<f64, 2> for Isotropic<'_> {
    fn rest(&self) -> [f64; 2] {
        [0.0; 2]
    }

    #[inline]
    fn flux(&self, g: &[f64; 2], _: &[f64], _: Option<&mut [f64]>) -> Option<(f64, [f64; 2])> {
        let b = (g[0] * g[0] + g[1] * g[1]).sqrt();
        let law = self.at(b);
        let secant = if b > NO_FLUX_T { law.h / b } else { law.slope };
        Some((law.energy, [secant * g[0], secant * g[1]]))
    }
}

impl PointTangent<2> for Isotropic<'_> {
    #[inline]
    fn response(&self, g: &[f64; 2], _: &[f64]) -> Option<Response<2>> {
        let square = g[0] * g[0] + g[1] * g[1];
        let b = square.sqrt();
        let law = self.at(b);
        // H / B, and how it changes with the square of B.
        let (secant, turn) =
            if b > NO_FLUX_T { (law.h / b, (law.slope - law.h / b) / square) } else { (law.slope, 0.0) };
        let across = turn * g[0] * g[1];
        Some(Response {
            energy: law.energy,
            flux: [secant * g[0], secant * g[1]],
            tangent: [[secant + turn * g[0] * g[0], across], [across, secant + turn * g[1] * g[1]]],
        })
    }
}

/// Triangles of one order with their equations.
type Triangles<const COUNT: usize> = Domain<f64, Turn, COUNT, 1>;

/// Triangles of any order.
#[derive(Debug)]
pub(super) enum Parts {
    First(Triangles<3>),
    Second(Triangles<6>),
    Third(Triangles<10>),
}

impl Parts {
    /// Prepares the triangles of a mesh; the number of one that turns over is an error.
    pub fn new(mesh: &Mesh, geometry: Geometry, equations: Equations<1>) -> Result<Self, usize> {
        Ok(match mesh.order {
            Order::First => Parts::First(Domain { elements: elements(mesh, geometry)?, equations }),
            Order::Second => Parts::Second(Domain { elements: elements(mesh, geometry)?, equations }),
            Order::Third => Parts::Third(Domain { elements: elements(mesh, geometry)?, equations }),
        })
    }

    /// Volume and slopes of the points of a triangle.
    pub fn points(&self, t: usize) -> Vec<(f64, [[f64; 2]; NODES])> {
        fn of<const COUNT: usize>(triangle: &Element<f64, Turn, COUNT>) -> Vec<(f64, [[f64; 2]; NODES])> {
            let slopes = |p: &element::Point<f64, Turn, COUNT>| {
                std::array::from_fn(|n| p.operators.get(n).map_or([0.0; 2], |turn| turn.0))
            };
            triangle.points.iter().map(|p| (p.volume, slopes(p))).collect()
        }
        match self {
            Parts::First(triangles) => of(&triangles.elements[t]),
            Parts::Second(triangles) => of(&triangles.elements[t]),
            Parts::Third(triangles) => of(&triangles.elements[t]),
        }
    }
}

fn elements<const COUNT: usize>(mesh: &Mesh, geometry: Geometry) -> Result<Vec<Element<f64, Turn, COUNT>>, usize> {
    let element = |t: usize| {
        let points = mesh.order.rule().iter().map(|(l, weight)| {
            let point = point(mesh, geometry, t, *l, *weight)?;
            let operators = std::array::from_fn(|n| Turn(point.slope[n]));
            Some(element::Point { volume: point.area * point.width, operators })
        });
        let points = points.collect::<Option<_>>().ok_or(t)?;
        Ok(Element::of(std::array::from_fn(|n| mesh.triangles[t][n]), points))
    };
    (0..mesh.triangles.len()).map(element).collect()
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

/// A point of a triangle; `None` where it turns over.
pub(super) fn point(mesh: &Mesh, geometry: Geometry, t: usize, l: [f64; 3], weight: f64) -> Option<Point> {
    let shape = mesh.order.shapes(l);
    let here = place(&mesh.places(t), &shape, &mesh.order.slopes(l));
    if here.det.is_nan() || here.det <= 0.0 {
        return None;
    }
    let (mut width, mut slope) = (1.0, here.slope);
    if geometry == Geometry::Axisymmetric {
        width = here.at[0];
        for (slope, shape) in slope.iter_mut().zip(shape) {
            // On the axis A/r is dA/dr.
            slope[0] += if width > ON_AXIS_MM { shape / width } else { slope[0] };
        }
    }
    Some(Point { area: 0.5 * here.det * weight, width, shape, slope })
}
