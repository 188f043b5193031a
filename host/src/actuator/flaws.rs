//! What a real actuator adds to its transfer function: a limit of speed, dry friction, backlash.

/// Flaws of an actuator; [`Flaws::NONE`] is a transfer function alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flaws {
    /// Largest speed, mm/s.
    pub rate_mm_s: f64,
    /// Dry friction, as the command that it holds at rest, V.
    pub friction_v: f64,
    /// Whole width of the gap between spindle and shaft, mm.
    pub backlash_mm: f64,
}

impl Flaws {
    /// None.
    pub const NONE: Self = Self { rate_mm_s: f64::INFINITY, friction_v: 0.0, backlash_mm: 0.0 };

    /// True if there is one.
    pub fn any(&self) -> bool {
        *self != Self::NONE
    }
}
