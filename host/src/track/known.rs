//! What is known of the tip's motion, and what a place must show for it.

use super::candidate::{ANYWHERE, Demand, NEAR, WITHIN_REACH};

/// So near to where it is expected a tip may be half hidden, pixels beside its last step.
const EXPECTED_PX: f64 = 5.0;
/// Part by which the contrast follows that of a frame.
const GAIN_FOLLOWS: f64 = 0.2;

/// Motion and contrast so far.
#[derive(Debug, Clone, Copy)]
pub struct Known {
    /// Where it was last, from its place in the first frame, pixels.
    pub shift: [f64; 2],
    /// Last step, pixels.
    velocity: [f64; 2],
    /// Contrast over that in the first frame.
    pub gain: f64,
    /// Longest step between two frames, pixels.
    fastest: f64,
    /// Frames since it was seen.
    missed: u32,
}

impl Default for Known {
    fn default() -> Self {
        Self { shift: [0.0; 2], velocity: [0.0; 2], gain: 1.0, fastest: 0.0, missed: 0 }
    }
}

impl Known {
    /// It was not seen in the last frame.
    pub fn is_lost(&self) -> bool {
        self.missed > 0
    }

    /// Where it is expected.
    pub fn ahead(&self) -> [f64; 2] {
        [self.shift[0] + self.velocity[0], self.shift[1] + self.velocity[1]]
    }

    /// What a place must show: the more, the less it is expected there.
    pub fn demand(&self, shift: [f64; 2]) -> &'static Demand {
        let ahead = self.ahead();
        let off = (shift[0] - ahead[0]).hypot(shift[1] - ahead[1]);
        if !self.is_lost() && off < EXPECTED_PX + self.velocity[0].hypot(self.velocity[1]) {
            &NEAR
        } else if off < EXPECTED_PX + self.fastest * (f64::from(self.missed) + 1.0) {
            &WITHIN_REACH
        } else {
            &ANYWHERE
        }
    }

    /// It is not seen.
    pub fn miss(&mut self) {
        self.velocity = [0.0; 2];
        self.missed = self.missed.saturating_add(1);
    }

    /// It is seen there, with that contrast. A step is one between two frames.
    pub fn find(&mut self, shift: [f64; 2], gain: f64) {
        let step = [shift[0] - self.shift[0], shift[1] - self.shift[1]];
        self.velocity = if self.is_lost() { [0.0; 2] } else { step };
        self.fastest = self.fastest.max(self.velocity[0].hypot(self.velocity[1]));
        self.gain += GAIN_FOLLOWS * (gain - self.gain);
        self.shift = shift;
        self.missed = 0;
    }
}
