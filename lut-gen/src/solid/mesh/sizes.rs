//! Sizes of the block's elements, as parts of the ball.

use crate::fem::block::BlockMesh;
use crate::fem::grading::graded;

/// Element sizes of the block, all in units of the ball radius except refinement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sizes {
    /// Radial size at the axis.
    pub axis: f64,
    /// Growth of the radial size per radius under the ball.
    pub growth_under: f64,
    /// Radius, beyond which the ball is no longer near.
    pub near: f64,
    /// Growth of the radial size beyond `near`.
    pub growth_far: f64,
    /// Height of the elements at the surface.
    pub surface: f64,
    /// Growth of the height with distance from the surface.
    pub growth_down: f64,
    /// Divides all sizes.
    pub refinement: f64,
}

impl BlockMesh {
    /// Meshes a block for a ball of radius `ball_mm`.
    #[must_use]
    pub fn new(radius_mm: f64, height_mm: f64, ball_mm: f64, sizes: &Sizes) -> Self {
        let s = sizes;
        let r = graded(radius_mm / ball_mm, s.refinement, |x| {
            s.axis + s.growth_under * x.min(s.near) + s.growth_far * (x - s.near).max(0.0)
        });
        let depth = graded(height_mm / ball_mm, s.refinement, |x| s.surface + s.growth_down * x);
        let r: Vec<f64> = r.iter().map(|x| x * ball_mm).collect();
        let z: Vec<f64> = depth.iter().rev().map(|x| height_mm - x * ball_mm).collect();
        Self::from_lines(&r, &z)
    }
}
