//! How large frames may be.

/// Most pixels of a frame: 64 megapixels.
pub const MOST_PIXELS: usize = 1 << 26;

/// Room for a frame, where it is no larger than frames are.
pub fn pixels(width: usize, height: usize) -> Option<usize> {
    width.checked_mul(height).filter(|count| (1..=MOST_PIXELS).contains(count))
}
