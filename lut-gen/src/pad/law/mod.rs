//! What the parts of a press are made of.
//!
//! | file | holds |
//! |---|---|
//! | [`gradient`] | from the logarithms of the principal stretches to the stress and tangent of a deformation gradient |
//! | [`ogden`] | rubbers and tissues: nearly incompressible, up to four terms |
//! | [`foam`] | compressible foams |
//! | [`plastic`] | a yield stress that follows a programme, on Hencky's elasticity |
//! | [`relaxing`] | Prony series on the first two |
//! | [`material`] | any of them, as the elements ask for it |

pub mod foam;
pub mod gradient;
pub mod material;
pub mod ogden;
pub mod plastic;
pub mod relaxing;
