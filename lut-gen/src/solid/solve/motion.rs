//! What the ball does over time.

use super::SolveError;

/// Where a segment ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Target {
    /// The ball reaches this depth (mm), linearly in time; negative above the untouched surface.
    DepthMm(f64),
    /// The force on the ball reaches this value (N), linearly in time.
    ForceN(f64),
}

/// A linear piece of the motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    /// Duration (s), positive.
    pub duration_s: f64,
    /// Where it ends.
    pub end: Target,
}

/// A piecewise linear programme of depth or force. It starts at time 0 with the ball at rest at
/// `start_mm`.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// Depth at time 0 (mm); 0 is touching, negative is above.
    pub start_mm: f64,
    /// The pieces, in order.
    pub segments: Vec<Segment>,
}

/// Most segments of a motion.
const MOST_SEGMENTS: usize = 10_000;

impl Motion {
    /// Nothing yet: the ball touches the surface.
    #[must_use]
    pub fn from_touch() -> Self {
        Self { start_mm: 0.0, segments: Vec::new() }
    }

    /// A ramp from touch to a depth (mm) at a rate (mm/s).
    #[must_use]
    pub fn ramp(depth_mm: f64, rate_mm_s: f64) -> Self {
        Self::from_touch().to_depth(depth_mm, rate_mm_s)
    }

    /// Continues to a depth (mm) at a rate (mm/s, positive whatever the direction). After a
    /// prescribed force nobody knows yet from where: that is refused by [`Motion::check`], use
    /// [`Motion::to_depth_within`].
    #[must_use]
    pub fn to_depth(self, depth_mm: f64, rate_mm_s: f64) -> Self {
        let from = match self.segments.last().map(|s| s.end) {
            None => self.start_mm,
            Some(Target::DepthMm(d)) => d,
            Some(Target::ForceN(_)) => f64::NAN,
        };
        self.segment((depth_mm - from).abs() / rate_mm_s, Target::DepthMm(depth_mm))
    }

    /// Continues to a depth (mm) within a duration (s).
    #[must_use]
    pub fn to_depth_within(self, depth_mm: f64, duration_s: f64) -> Self {
        self.segment(duration_s, Target::DepthMm(depth_mm))
    }

    /// Continues to a force (N) within a duration (s).
    #[must_use]
    pub fn to_force(self, force_n: f64, duration_s: f64) -> Self {
        self.segment(duration_s, Target::ForceN(force_n))
    }

    /// Holds what the last segment reached, its depth or its force, for a duration (s).
    #[must_use]
    pub fn hold(self, duration_s: f64) -> Self {
        let end = self.segments.last().map_or(Target::DepthMm(self.start_mm), |s| s.end);
        self.segment(duration_s, end)
    }

    /// The same segments again, so that there are `times` of them in all.
    #[must_use]
    pub fn cycles(mut self, times: usize) -> Self {
        let once = self.segments.clone();
        for _ in 1..times {
            self.segments.extend_from_slice(&once);
        }
        self
    }

    fn segment(mut self, duration_s: f64, end: Target) -> Self {
        self.segments.push(Segment { duration_s, end });
        self
    }

    /// Total duration (s).
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.segments.iter().map(|s| s.duration_s).sum()
    }

    /// Largest prescribed depth (mm), 0 when none is positive.
    #[must_use]
    pub fn deepest_mm(&self) -> f64 {
        self.segments.iter().fold(self.start_mm.max(0.0), |m, s| match s.end {
            Target::DepthMm(d) => m.max(d),
            Target::ForceN(_) => m,
        })
    }

    /// Largest prescribed force (N), 0 when none is positive.
    #[must_use]
    pub fn largest_force_n(&self) -> f64 {
        self.segments.iter().fold(0.0, |m: f64, s| match s.end {
            Target::DepthMm(_) => m,
            Target::ForceN(f) => m.max(f),
        })
    }

    /// Checks that there is something to do.
    ///
    /// # Errors
    /// [`SolveError::Parameter`] when it starts inside the specimen, there is no segment or too
    /// many, a duration is not positive, or a target is not finite.
    pub fn check(&self) -> Result<(), SolveError> {
        let refuse = |parameter, value, expected: &str| {
            Err(SolveError::Parameter { parameter, value, expected: expected.to_owned() })
        };
        if !(self.start_mm.is_finite() && self.start_mm <= 0.0) {
            return refuse("start_mm of the motion", self.start_mm, "must be finite and not inside the specimen");
        }
        if self.segments.len() > MOST_SEGMENTS {
            return refuse("segments of the motion", self.segments.len() as f64, "but at most 10000 are allowed");
        }
        if self.segments.is_empty() {
            return refuse("segments of the motion", 0.0, "but at least one is needed");
        }
        for s in &self.segments {
            if !(s.duration_s.is_finite() && s.duration_s > 0.0) {
                let expected = "must be positive; after a prescribed force it must be given, not a rate";
                return refuse("duration_s of a segment", s.duration_s, expected);
            }
            match s.end {
                Target::DepthMm(d) if !d.is_finite() => return refuse("depth_mm of a segment", d, "must be finite"),
                Target::ForceN(f) if !f.is_finite() => return refuse("force_n of a segment", f, "must be finite"),
                _ => {}
            }
        }
        Ok(())
    }
}
