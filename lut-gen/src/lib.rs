//! Finite elements of spherical indentation and the look-up tables made from them.

pub mod contact;
pub mod element;
pub mod law;
pub mod mesh;
pub mod solve;
pub mod model;
