//! Which degrees of freedom are held.

use super::Base;
use crate::fem::equations::Equations;
use crate::solid::mesh::BlockMesh;

/// Equation numbers: the axis does not move radially, base and top as told.
pub fn number(mesh: &BlockMesh, base: Base, bonded_top: bool) -> Equations<2> {
    Equations::number(mesh.nodes.iter().map(|x| {
        // the lines are scaled, so that the lowest may miss zero by rounding
        let bottom = x[1] <= 1e-9 * mesh.height_mm;
        let top = x[1] >= (1.0 - 1e-9) * mesh.height_mm;
        let glued = (bottom && base == Base::Bonded) || (top && bonded_top);
        [x[0] == 0.0 || glued, bottom]
    }))
}
