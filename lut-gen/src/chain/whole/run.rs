//! A run as finite elements follow it.

use crate::chain::Passage;

/// How finely a path is solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Detail {
    /// A coarse mesh whatever the effects are, to compare places that are far from each other: a third of the time.
    Valleys,
    /// As exact as a name asks for.
    Names,
}

/// Values by time (s), or by the place on a path.
pub(super) type Curve = Vec<(f64, f64)>;

/// A run's motion with places for all readings, and what the ball does there.
pub(super) struct Fine {
    pub run: usize,
    /// The recorded motion at those places.
    pub recorded: Passage,
    /// The ball's own: time (s) and depth (mm).
    pub path: Curve,
    /// Depth of the ball in earlier presses on the spot, mm; 0 on a fresh one, or where nothing remembers.
    pub before_mm: f64,
}

/// Ball and block: geometry, specimen, ball.
pub(super) type Block = (usize, usize, usize);
