//! Finite elements that know no physics: drawings, triangle meshes, shape functions, sparse matrices.
//!
//! A physics is a folder of its own that imports this one and no other physics.

pub mod drawing;
pub mod mesh;
pub mod sparse;
pub mod triangle;
