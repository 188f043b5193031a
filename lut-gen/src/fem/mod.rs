//! Finite elements that know no physics.
//!
//! | file | holds |
//! |---|---|
//! | [`drawing`], [`mesh`] | drawings and graded meshes of triangles over them |
//! | [`locate`] | the triangle around a point |
//! | [`grading`], [`block`] | spacings that follow a size, structured meshes of a rectangle |
//! | [`shape`], [`triangle`], [`quadrature`] | shape functions and the rules to integrate with |
//! | [`place`] | an element's map: position, area, slopes in real directions |
//! | [`operator`] | what a physics tells: how nodes strain a point, and the point's energy, flux, tangent and memory |
//! | [`element`], [`domain`] | force and stiffness of one element and of all of them |
//! | [`equations`] | numbers of the free degrees of freedom, gathering and spreading |
//! | [`sparse`], [`ordered`], [`krylov`] | patterns, elimination order, factors, and an iteration with a neighbour's factor |
//! | [`newton`], [`secant`] | the least of an energy, with old factors that steps better |
//! | [`newton`], [`secant`] | the least of an energy, with old factors that steps better |
//!
//! A physics is a folder of its own that imports this one and no other physics.

pub mod block;
pub mod domain;
pub mod drawing;
pub mod element;
pub mod equations;
pub mod grading;
pub mod krylov;
pub mod locate;
pub mod mesh;
pub mod newton;
pub mod operator;
pub mod ordered;
pub mod place;
pub mod quadrature;
pub mod secant;
pub mod shape;
pub mod sparse;
mod substitute;
pub mod triangle;
