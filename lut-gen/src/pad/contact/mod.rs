//! Contact between an edge of a body and what lies across: rigid, or the edge of another body.
//!
//! | file | holds |
//! |---|---|
//! | [`rigid`] | plates and balls |
//! | [`opposite`] | what lies across at a place: height, slope, and what moves it |
//! | [`segment`] | the parts of an edge that touch, located inside the elements |
//! | [`energy`] | energy, force and stiffness of the penalty over those parts |
//! | [`friction`] | Coulomb friction of a step |

pub mod energy;
pub mod friction;
pub mod opposite;
pub mod rigid;
pub mod segment;
