//! The rigid indenter: a ball on a shank of its own radius.

use serde::{Deserialize, Serialize};

use crate::scalar::Real;

/// A rigid ball. Above its equator it continues as a cylindrical shank of the
/// same radius, so depths beyond the radius are defined and the profile stays
/// smooth (sphere and cylinder share the tangent at the equator).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Ball<T = f64> {
    /// Radius `R` (mm).
    pub radius_mm: T,
}

/// Where a point lies relative to the indenter, with derivatives by its position.
#[derive(Debug, Clone, Copy)]
pub struct Touch<T = f64> {
    /// Depth of the point inside the indenter `g` (mm), negative outside.
    pub depth_mm: T,
    /// Unit normal out of the indenter `[r, z]`; `dg/dx = -n`.
    pub normal: [T; 2],
    /// Curvature `1 / |x - c|` (1/mm) of the distance field, 0 at the shank.
    pub curvature: T,
    /// Length along the meridian (mm) from the pole to below the point.
    pub arc_mm: T,
    /// `|d arc / dx|`, along `t = [-n_z, n_r]`: `R / |x - c|`, 1 at the shank.
    pub arc_slope: T,
}

impl<T: Real> Ball<T> {
    /// The point `x = [r, z]` and the indenter whose centre is at height `centre_mm` on the axis.
    #[must_use]
    pub fn touch(&self, x: [T; 2], centre_mm: T) -> Touch<T> {
        let (zero, one) = (T::from(0.0), T::from(1.0));
        let up = x[1] - centre_mm;
        if up.value() >= 0.0 {
            return Touch {
                depth_mm: self.radius_mm - x[0],
                normal: [one, zero],
                curvature: zero,
                arc_mm: self.radius_mm * std::f64::consts::FRAC_PI_2 + up,
                arc_slope: one,
            };
        }
        let distance = (x[0] * x[0] + up * up).sqrt();
        let curvature = one / distance;
        Touch {
            depth_mm: self.radius_mm - distance,
            normal: [x[0] * curvature, up * curvature],
            curvature,
            arc_mm: self.radius_mm * x[0].atan2(-up),
            arc_slope: self.radius_mm * curvature,
        }
    }
}
