//! The axisymmetric eight-node quadrilateral with reduced (2 x 2) integration, total Lagrangian.

mod solid;

pub use solid::{DOFS, Matter, Quadrature, Ring, Solid, Stiffness};
