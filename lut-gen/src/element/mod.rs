//! The axisymmetric eight-node quadrilateral with reduced (2 x 2) integration.

mod quadrature;
mod quad8;
mod solid;

pub use quadrature::gauss;
pub use quad8::{quad8, line3};
pub use solid::{DOFS, LOWER, Quadrature, Solid};
