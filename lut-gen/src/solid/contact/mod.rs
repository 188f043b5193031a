//! Contact of the block's surface with an analytic rigid indenter: pressure, friction, adhesion.

mod ball;
mod indenter;
mod interface;
mod penalty;
mod surface;

pub use ball::{Ball, Touch};
pub use indenter::{Indenter, Platen};
pub use interface::{Adhesion, Interface};
pub use penalty::Penalty;
pub use surface::{EdgeStiffness, Grip, Sum, Surface};
