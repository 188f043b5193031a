//! Which degrees of freedom are held.

use super::Base;
use crate::fem::sparse::HELD;
use crate::mesh::BlockMesh;

/// Equation numbers: the axis does not move radially, base and top as told.
pub fn number(mesh: &BlockMesh, base: Base, bonded_top: bool) -> (Vec<usize>, usize) {
    let mut next = 0;
    let mut equation = Vec::with_capacity(2 * mesh.nodes.len());
    for x in &mesh.nodes {
        // the lines are scaled, so that the lowest may miss zero by rounding
        let bottom = x[1] <= 1e-9 * mesh.height_mm;
        let top = x[1] >= (1.0 - 1e-9) * mesh.height_mm;
        let glued = (bottom && base == Base::Bonded) || (top && bonded_top);
        let held = [x[0] == 0.0 || glued, bottom];
        for h in held {
            equation.push(if h { HELD } else { next });
            next += usize::from(!h);
        }
    }
    (equation, next)
}
