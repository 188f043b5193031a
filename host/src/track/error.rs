//! What can be wrong with a region and its frames.

use super::frame::Roi;
use super::template::LEAST_SIDE_PX;

/// Why nothing can be followed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TrackError {
    /// The region leaves the frame.
    #[error("the region {roi} is not inside the frames of {width} x {height} pixels")]
    Outside {
        /// As asked for.
        roi: Roi,
        /// Of the frames.
        width: usize,
        /// Of the frames.
        height: usize,
    },
    /// The region is too small.
    #[error("the region {roi} is too small; expected at least {LEAST_SIDE_PX} x {LEAST_SIDE_PX} pixels")]
    Small {
        /// As asked for.
        roi: Roi,
    },
    /// Nothing is to be seen.
    #[error(
        "the region {roi} of the first frame shows nothing to follow: its contrast is {:.2} % of full scale, its noise {:.2} %",
        100.0 * contrast,
        100.0 * noise
    )]
    Flat {
        /// As asked for.
        roi: Roi,
        /// Standard deviation of the smoothed brightness, as a part of full scale.
        contrast: f64,
        /// Standard deviation of the smoothed noise, as a part of full scale.
        noise: f64,
    },
    /// The tip is no place.
    #[error("the tip is at {:?}; expected a place in the first frame, in pixels", tip)]
    Tip {
        /// As asked for.
        tip: [f64; 2],
    },
    /// A frame has another number of pixels than its size asks for.
    #[error("the frame has {count} pixels; expected {width} x {height}")]
    Pixels {
        /// Its values.
        count: usize,
        /// As it says.
        width: usize,
        /// As it says.
        height: usize,
    },
    /// Frames differ in size.
    #[error("the frame has {width} x {height} pixels; expected {} x {} as the first", expected.0, expected.1)]
    Size {
        /// Of this frame.
        width: usize,
        /// Of this frame.
        height: usize,
        /// Of the first.
        expected: (usize, usize),
    },
}

impl TrackError {
    /// Which option helps.
    #[must_use]
    pub fn advice(&self) -> &'static str {
        match self {
            Self::Outside { .. } => "--roi X,Y,WIDTH,HEIGHT is in whole pixels from the upper left corner",
            Self::Small { .. } | Self::Flat { .. } => "draw --roi around the tip as the first frame shows it",
            Self::Tip { .. } => "--tip X,Y is in pixels from the upper left corner of the first frame",
            Self::Pixels { .. } | Self::Size { .. } => "all frames of a recording have the size of the first",
        }
    }
}
