//! Paths that are solved with finite elements.

use super::run::Curve;

/// Part of a depth by which two are one.
pub(super) const SAME: f64 = 0.002;

/// A path that is solved: straight pieces, or where rates do not matter the turns alone, a second a millimetre.
pub(super) struct Job {
    pub run: usize,
    pub path: Curve,
    pub before_mm: f64,
    /// Places on the path at which it turns.
    pub corners: Vec<f64>,
    /// Where on the path (time, or the place along the turns) finite elements add how much, N.
    pub added: Curve,
}

impl Job {
    /// True when it is what a spot sees next that was pressed so deep before.
    pub fn is_after(&self, deepest_mm: f64) -> bool {
        self.before_mm > 0.0 && (self.before_mm - deepest_mm).abs() <= SAME * self.before_mm
    }
}
