//! Where a magnet's field ends, and how far it is meshed.

use std::f64::consts::FRAC_PI_2;

use crate::fem::drawing::Curve;

use super::design::Design;
use super::field::{Around, Geometry};
pub use super::outside::Mirror;
use super::shape::Shape;

/// Where the field ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Edge {
    /// Nowhere.
    Open,
    /// No flux leaves a circle about the origin; about an axis, a sphere.
    Round {
        /// Its radius, mm.
        radius: f64,
    },
    /// No flux leaves a box of twice this width and height; about an axis, a cylinder.
    Box {
        /// Half its width, or its radius, mm.
        half: f64,
    },
}

/// Radius of the meshed circle over what the drawing reaches: beyond it the field is known in closed form. Nearer, the sides on
/// the circle would have to be shorter; farther, there is more to mesh.
const NEAR: f64 = 1.3;

impl Edge {
    /// Its radius or half width, mm; infinite where there is none.
    #[must_use]
    pub const fn extent(self) -> f64 {
        match self {
            Edge::Open => f64::INFINITY,
            Edge::Round { radius } => radius,
            Edge::Box { half } => half,
        }
    }
}

impl Design {
    /// How far the mesh goes: radius of a circle or half width of a box, mm.
    #[must_use]
    pub fn meshed_mm(&self) -> f64 {
        self.around().map_or(self.edge.extent(), |around| around.near_mm)
    }

    /// What lies beyond the mesh; `None` where the mesh ends at the boundary.
    #[must_use]
    pub fn around(&self) -> Option<Around> {
        // what is cut away is drawn too
        let shapes = self.regions.iter().flat_map(|region| region.shapes.iter().chain(&region.without));
        let reach = shapes.map(Shape::reach).fold(0.0, f64::max);
        let near_mm = NEAR * reach;
        match self.edge {
            Edge::Open => Some(Around { near_mm, far_mm: None, mirror: self.mirror }),
            // A boundary that is hardly farther away is meshed.
            Edge::Round { radius } if radius > NEAR * near_mm => {
                Some(Around { near_mm, far_mm: Some(radius), mirror: self.mirror })
            }
            Edge::Round { .. } | Edge::Box { .. } => None,
        }
    }

    /// True when only x of 0 and more is meshed: about an axis, and beside a mirror.
    #[must_use]
    pub fn is_half(&self) -> bool {
        self.geometry == Geometry::Axisymmetric || self.mirror.is_some()
    }

    /// True when a point is on the mesh's boundary or the axis, and the potential is held there.
    #[must_use]
    pub fn is_held(&self, p: [f64; 2]) -> bool {
        let far = self.edge.extent();
        let near = 1e-6 * far;
        let is_held = self.geometry == Geometry::Axisymmetric || self.mirror == Some(Mirror::Along);
        if is_held && p[0] < 1e-9 {
            return true;
        }
        match self.edge {
            Edge::Open => false,
            Edge::Round { radius } => p[0].hypot(p[1]) > radius - near,
            Edge::Box { half } => p[0].abs().max(p[1].abs()) > half - near,
        }
    }

    pub(super) fn is_inside(&self, p: [f64; 2]) -> bool {
        (!self.is_half() || p[0] > 0.0)
            && match self.edge {
                Edge::Open | Edge::Round { .. } => p[0].hypot(p[1]) < self.meshed_mm(),
                Edge::Box { .. } => true,
            }
    }

    /// The mesh's boundary, without axis or mirror.
    pub(super) fn frame(&self) -> Vec<Curve> {
        let far = self.meshed_mm();
        match (self.edge, self.is_half()) {
            (Edge::Box { half }, false) => Curve::rectangle([-half, -half], [half, half]).to_vec(),
            (Edge::Box { half }, true) => Curve::rectangle([0.0, -half], [half, half])[..3].to_vec(),
            (_, false) => vec![Curve::circle([0.0, 0.0], far)],
            (_, true) => {
                vec![Curve::Arc { centre: [0.0, 0.0], radius: far, from: -FRAC_PI_2, to: FRAC_PI_2 }]
            }
        }
    }

    /// The axis or mirror as far as it is meshed.
    pub(super) fn axis(&self) -> Curve {
        let far = self.meshed_mm();
        Curve::Line([0.0, far], [0.0, -far])
    }
}
