//! What a track leaves.

use super::encoder::Encoder;
use crate::track::{Frame, Measure, Position, Roi};

/// What a call has found.
pub(super) struct Tracked {
    /// The first frame.
    pub first: Frame,
    /// What is looked for in it.
    pub roi: Roi,
    /// Scale and surface.
    pub measure: Measure,
    /// Frames a second, where known.
    pub rate_hz: Option<f64>,
    /// One a frame.
    pub positions: Vec<Position>,
    /// What it is compared with.
    pub encoder: Option<Encoder>,
    /// Time that frames took, reading included, s.
    pub seconds: f64,
}
