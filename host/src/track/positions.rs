//! Positions as frames come: what a display test reads while a finger moves.

use super::error::TrackError;
use super::frame::{Frame, Roi};
use super::position::Position;
use super::source::{Frames, SourceError};
use super::tracker::Tracker;

/// Why there is no further position.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum PositionError {
    /// A frame cannot be read.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Source(#[from] SourceError),
    /// A frame or the region in it is not fit.
    #[error("{name}: {cause}")]
    #[diagnostic(help("{}", cause.advice()))]
    Track {
        /// The frame.
        name: String,
        /// Why.
        cause: TrackError,
    },
    /// A stream without frames.
    #[error("there is no frame; expected at least one")]
    None,
}

/// Positions, one a frame.
#[derive(Debug)]
pub struct Positions<'a> {
    frames: Frames<'a>,
    tracker: Tracker,
    rate_hz: Option<f64>,
    next: usize,
    failed: bool,
}

impl<'a> Positions<'a> {
    /// Reads the first frame, and learns what its region shows. `rate_hz` is used instead of the recording's own. The frame is
    /// returned beside them.
    ///
    /// # Errors
    /// No frame, or nothing to follow in it.
    pub fn open(
        mut frames: Frames<'a>,
        roi: Roi,
        tip: Option<[f64; 2]>,
        rate_hz: Option<f64>,
    ) -> Result<(Self, Frame), PositionError> {
        let first = frames.next().ok_or(PositionError::None)??;
        let named = |cause| PositionError::Track { name: frames.name(), cause };
        let tracker = Tracker::new(&first, roi, tip).map_err(named)?;
        let rate_hz = rate_hz.or(frames.rate());
        Ok((Self { frames, tracker, rate_hz, next: 0, failed: false }, first))
    }

    /// Frames a second, where known.
    #[must_use]
    pub fn rate_hz(&self) -> Option<f64> {
        self.rate_hz
    }
}

impl Iterator for Positions<'_> {
    type Item = Result<Position, PositionError>;

    fn next(&mut self) -> Option<Self::Item> {
        let frame = self.next;
        let time_s = self.rate_hz.map(|rate| frame as f64 / rate);
        if self.failed {
            return None;
        }
        self.next += 1;
        if frame == 0 {
            return Some(Ok(Position { frame, time_s, tip: Some(self.tracker.first()) }));
        }
        let read = self.frames.next()?.map_err(PositionError::from);
        let found = read.and_then(|read| {
            let named = |cause| PositionError::Track { name: self.frames.name(), cause };
            self.tracker.step(&read).map_err(named)
        });
        self.failed = found.is_err();
        Some(found.map(|tip| Position { frame, time_s, tip }))
    }
}
