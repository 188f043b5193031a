//! When the 50 Hz record is sent.

/// Divides the tick rate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct TelemetryClock {
    divider: u8,
    count: u8,
}

impl TelemetryClock {
    /// Every `divider`-th tick from the next one on; 0 for never.
    pub fn set(&mut self, divider: u8) {
        *self = TelemetryClock { divider, count: 0 };
    }

    /// One tick; true if a record is due.
    pub fn step(&mut self) -> bool {
        if self.divider == 0 {
            return false;
        }
        let due = self.count == 0;
        self.count = if self.count + 1 >= self.divider { 0 } else { self.count + 1 };
        due
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_nth_tick_and_never_for_zero() {
        let mut clock = TelemetryClock::default();
        assert!(!(0..10).any(|_| clock.step()));
        for (divider, expected) in [(1, 12), (3, 4), (255, 1)] {
            clock.set(divider);
            assert_eq!((0..12).filter(|_| clock.step()).count(), expected);
        }
    }
}
