//! Structured quadratic mesh of the cylinder block, fine under the ball.

mod sizes;

pub use crate::fem::block::BlockMesh;
pub use crate::fem::grading::graded;
pub use sizes::Sizes;
