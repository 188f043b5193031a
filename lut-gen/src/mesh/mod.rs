//! Structured quadratic mesh of the cylinder block, fine under the ball.

mod block;
mod grading;

pub use block::{BlockMesh, Sizes};
pub use grading::graded;
