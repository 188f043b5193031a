//! Contact of the block's top with an analytic rigid indenter: pressure, friction, adhesion.

mod ball;
mod interface;
mod penalty;
mod surface;

pub use ball::{Ball, Touch};
pub use interface::{Adhesion, Interface};
pub use penalty::Penalty;
pub use surface::{EdgeStiffness, Grip, Sum, Surface};
