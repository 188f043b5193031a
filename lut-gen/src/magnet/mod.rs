//! Magnets by finite elements: electromagnets, permanent magnets and the fluid in their gap.
//!
//! Lengths are in mm, flux densities in T, field strengths in A/mm, currents in A. Laws have no hysteresis.

pub mod bh;
pub mod field;
mod look;
mod point;
