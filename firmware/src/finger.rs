//! Where a finger is and how fast it goes, told by the shaft under it and the force that it presses with.
//!
//! The place of its bone is that of the shaft and what its pulp is compressed by. It moves evenly, and the shaft under it
//! hardly moves it: it is known better ahead than the force is, which every step of the shaft changes.

pub mod pulp;

use protocol::TICK_S;

/// Parts of what a reading of the place adds to place and rate: an alpha-beta filter with both poles at 0.7 a tick. It
/// follows an even motion without an error, after a fifth of a second, and little of a hand's tremor.
const ALPHA: f32 = 0.51;
const BETA: f32 = 0.09;

/// A finger that is followed; `Default` is none.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Finger {
    /// Place below the surface, mm, and rate, mm/s; none while it is not felt.
    followed: Option<(f32, f32)>,
}

impl Finger {
    /// One tick. Where the finger will be in `ahead_s`, mm below the surface; `None` for one that is not felt: whose force,
    /// N, is not more than the sensor's least, or is no number.
    pub fn step(&mut self, shaft_mm: f32, force_n: f32, least_n: f32, ahead_s: f32) -> Option<f32> {
        let read_mm = shaft_mm + pulp::compression_mm(force_n);
        self.followed = (force_n > least_n && read_mm.is_finite()).then(|| {
            let (place_mm, rate_mm_s) = self.followed.unwrap_or((read_mm, 0.0));
            let expected_mm = place_mm + rate_mm_s * TICK_S;
            let new_mm = read_mm - expected_mm;
            (expected_mm + ALPHA * new_mm, rate_mm_s + BETA * new_mm / TICK_S)
        });
        self.followed.map(|(place_mm, rate_mm_s)| place_mm + rate_mm_s * ahead_s)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// 20 mm/s over a shaft that gives way: no error after a few ticks, and it is known ahead.
    #[test]
    fn an_even_motion_is_known_ahead() {
        let mut finger = Finger::default();
        for tick in 0..100 {
            let force_n = 0.3 + 0.01 * tick as f32;
            let place_mm = 0.4 * tick as f32;
            let shaft_mm = place_mm - pulp::compression_mm(force_n);
            let ahead_mm = finger.step(shaft_mm, force_n, 0.2, 0.1).unwrap();
            if tick > 30 {
                assert!((ahead_mm - place_mm - 2.0).abs() < 0.01, "{tick}: {ahead_mm}");
            }
        }
    }

    #[test]
    fn one_that_is_not_felt_is_nowhere_and_begins_at_rest() {
        let mut finger = Finger::default();
        for nothing in [0.0, 0.2, f32::NAN] {
            assert_eq!(finger.step(1.0, nothing, 0.2, 0.1), None);
        }
        assert_eq!(finger.step(f32::NAN, 1.0, 0.2, 0.1), None);
        let first = finger.step(1.0, 0.3, 0.2, 0.1);
        assert_eq!(first, Some(1.0 + pulp::compression_mm(0.3)));
        finger.step(2.0, 1.0, 0.2, 0.1);
        assert_eq!((finger.step(2.0, 0.1, 0.2, 0.1), finger), (None, Finger::default()));
    }
}
