//! Sensor calibrations and other tables of x and y: does a law describe them, against the scatter of their own repeats?
//!
//! The order is that of a [diagnosis](crate::diagnose): repeats say what noise is ([`lack_of_fit`]); without them nothing is named, and all that
//! can be said is what the rest of a fit looks like ([`polynomial`]). Readings that also depend on direction or time are compared press by press
//! ([`hysteresis`]), because samples of one press are not independent.

pub mod distribution;
pub mod hysteresis;
pub mod lack_of_fit;
pub mod polynomial;
