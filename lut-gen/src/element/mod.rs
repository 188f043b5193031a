//! The axisymmetric eight-node quadrilateral with reduced (2 x 2) integration.

mod quad8;
mod quadrature;
mod solid;

pub use quad8::{line3, quad8};
pub use quadrature::gauss;
pub use solid::{DOFS, Matter, Quadrature, Solid, Stiffness};
