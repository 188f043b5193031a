//! Magnets by finite elements: electromagnets, permanent magnets and the fluid in their gap.
//!
//! Lengths are in mm, flux densities in T, field strengths in A/mm, currents in A. Laws have no hysteresis.

pub mod bh;
pub mod curve;
pub mod design;
pub mod edge;
mod energy;
pub mod field;
pub mod fluid;
mod look;
pub mod map;
pub mod material;
mod outside;
mod point;
mod potential;
mod recover;
pub mod shape;
mod sizes;
pub mod study;
pub mod winding;
