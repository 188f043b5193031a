//! The finger pad: a finger pressed on a plate, on a foam, on a body whose yield stress is
//! prescribed.
//!
//! Two soft bodies, or one and a rigid one, in the plane or about an axis; the upper moves down.
//! Units are mm, N, MPa, s.
//!
//! | folder | holds |
//! |---|---|
//! | [`law`] | skin, tissue, foam, and a body that yields |
//! | [`body`] | cross-section of the finger, block, and their elements |
//! | [`contact`] | contact without friction of edges that slide as far as they like |
//! | [`model`] | the equations of both bodies |
//! | [`control`] | the yield stress with which a block feels like a foam |
//! | [`ellipse`] | prints with two radii (thesis Eqs. 28-38) |
//! | [`hertz`] | the fingertip as an elastic sphere (Eqs. 50-52) |
//! | [`press`] | the way down, and what was found at every depth ([`state`]) |

pub mod body;
pub mod contact;
pub mod control;
pub mod ellipse;
pub mod error;
pub mod hertz;
pub mod law;
pub mod model;
mod path;
mod potential;
pub mod press;
pub mod state;
