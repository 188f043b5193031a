//! Which way a loop runs.

use super::sampled::Sampling;

/// Which loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Way {
    /// A continuous controller.
    Continuous,
    /// A sampled one with a hold.
    Sampled(Sampling),
}
