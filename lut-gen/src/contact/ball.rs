//! The rigid indenter: a ball on a shank of its own radius.

/// A rigid ball. Above its equator it continues as a cylindrical shank of the
/// same radius, so depths beyond the radius are defined and the profile stays
/// smooth (sphere and cylinder share the tangent at the equator).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ball {
    /// Radius `R` (mm).
    pub radius_mm: f64,
}

/// Penetration of one point, with derivatives by its position.
#[derive(Debug, Clone, Copy)]
pub struct Touch {
    /// Depth of the point inside the indenter `g` (mm), positive.
    pub depth_mm: f64,
    /// Unit normal out of the indenter `[r, z]`; `dg/dx = -n`.
    pub normal: [f64; 2],
    /// Curvature `1 / |x - c|` (1/mm) of the distance field, 0 at the shank.
    pub curvature: f64,
}

impl Ball {
    /// Where the point `x = [r, z]` is inside the indenter whose centre is at
    /// height `centre_mm` on the axis; `None` outside.
    #[must_use]
    pub fn touch(&self, x: [f64; 2], centre_mm: f64) -> Option<Touch> {
        let up = x[1] - centre_mm;
        if up >= 0.0 {
            let depth_mm = self.radius_mm - x[0];
            return (depth_mm > 0.0).then_some(Touch { depth_mm, normal: [1.0, 0.0], curvature: 0.0 });
        }
        let square = x[0] * x[0] + up * up;
        if square >= self.radius_mm * self.radius_mm {
            return None;
        }
        let distance = square.sqrt();
        Some(Touch {
            depth_mm: self.radius_mm - distance,
            normal: [x[0] / distance, up / distance],
            curvature: 1.0 / distance,
        })
    }
}
