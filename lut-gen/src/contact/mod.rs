//! Frictionless contact of the block's top with an analytic rigid indenter.

mod ball;
mod surface;

pub use ball::{Ball, Touch};
pub use surface::{EdgeStiffness, Sum, Surface};
