//! What is told of a ripple.

/// What a ripple is regular over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Over {
    /// Time.
    Time,
    /// Depth.
    Depth,
}

/// A ripple.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ripple {
    /// What it is regular over.
    pub over: Over,
    /// Hz, or periods a millimetre. What is faster than half the sampling rate appears at a lower frequency.
    pub frequency: f64,
    /// Amplitude in one run, N: the root of half of what two of them differ by.
    pub amplitude_n: f64,
    /// Its part of what the force scatters by about smooth curves.
    pub share: f64,
}

/// From this part of the scatter on a ripple spoils what is said of noise.
pub const SPOILS: f64 = 0.3;

impl std::fmt::Display for Ripple {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (unit, over) = match self.over {
            Over::Time => ("Hz (or a higher frequency that the sampling folds there)", "time"),
            Over::Depth => ("periods a millimetre", "depth"),
        };
        write!(
            f,
            "the force ripples over {over} with {:.2} {unit}, amplitude {:.2e} N, {:.0} % of its scatter about smooth curves",
            self.frequency,
            self.amplitude_n,
            100.0 * self.share
        )
    }
}
