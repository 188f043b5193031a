//! The motion of a ball that gathers its rate.

/// A ramp with a smooth start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ramp {
    /// Largest depth (mm).
    pub depth_mm: f64,
    /// Rate after the start (mm/s).
    pub rate_mm_s: f64,
    /// Share of the depth over which the rate is gathered.
    pub smooth: f64,
}

impl Ramp {
    /// Time over which the ball gathers its rate (s): it covers half the way of full rate meanwhile.
    fn start_s(&self) -> f64 {
        2.0 * self.smooth * self.depth_mm / self.rate_mm_s
    }

    /// Time to the largest depth (s).
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.depth_mm / self.rate_mm_s + 0.5 * self.start_s()
    }

    /// Depth at a time (mm). The rate rises as `10 s^3 - 15 s^4 + 6 s^5`, whose first and second
    /// derivatives vanish at both ends.
    #[must_use]
    pub fn at(&self, time_s: f64) -> f64 {
        let start = self.start_s();
        let s = (time_s / start).clamp(0.0, 1.0);
        let gathered = s.powi(4) * (2.5 - 3.0 * s + s * s);
        (self.rate_mm_s * (start * gathered + (time_s - start).max(0.0))).min(self.depth_mm)
    }
}
