//! One run as the chain sees it.

/// Recorded motion of one run, thinned to the places where force is predicted.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Passage {
    /// Time since the first sample (s), rising.
    pub time_s: Vec<f64>,
    /// Recorded depth (mm), as long as `time_s`.
    pub depth_mm: Vec<f64>,
    /// Start on the session clock (s), if it is known.
    pub start_s: f64,
    /// Which geometry of the [`super::Library`].
    pub geometry: usize,
    /// Index of the specimen in the experiment, the owner of its height.
    pub specimen: usize,
    /// Index of the ball in the experiment, the owner of its radius.
    pub indenter: usize,
    /// Largest recorded depth of earlier presses on this spot (mm), 0 on a fresh one.
    pub pressed_before_mm: f64,
}
