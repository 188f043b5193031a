//! Means of what the self-test program sees: analog inputs and driven pins, a millisecond at a time.

use libm::sqrtf;
use protocol::lut::Table;
use protocol::selftest::{INPUTS, Measured, PINS};

/// The table whose fingerprint the program computes: that of the host's tests.
const TABLE: &[u8] = include_bytes!("../../tests/golden/fingerprint.lut");

/// The table of [`crate::fingerprint`]; `None` if it does not parse.
pub fn table() -> Option<Table<'static>> {
    Table::parse(TABLE).ok()
}

/// Sums over milliseconds.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Average {
    /// Mean so far, and the sum of squares about it (Welford, Technometrics 4, 1962): single precision loses nothing.
    mean: [f32; INPUTS],
    squares: [f32; INPUTS],
    high: [u16; PINS],
    count: u16,
    lost: u16,
}

impl Average {
    /// Nothing seen.
    pub const fn new() -> Self {
        Average { mean: [0.0; INPUTS], squares: [0.0; INPUTS], high: [0; PINS], count: 0, lost: 0 }
    }

    /// Takes a millisecond: readings, fractions of the reference, and which pins are high; `None` for one that is lost.
    pub fn take(&mut self, readings: Option<[f32; INPUTS]>, high: [bool; PINS]) {
        let Some(readings) = readings else {
            self.lost = self.lost.saturating_add(1);
            return;
        };
        self.count = self.count.saturating_add(1);
        let count = f32::from(self.count);
        for ((mean, squares), reading) in self.mean.iter_mut().zip(&mut self.squares).zip(readings) {
            let off = reading - *mean;
            *mean += off / count;
            *squares += off * (reading - *mean);
        }
        for (seen, high) in self.high.iter_mut().zip(high) {
            *seen = seen.saturating_add(u16::from(high));
        }
    }

    /// Milliseconds with readings so far.
    pub const fn count(&self) -> u16 {
        self.count
    }

    /// Milliseconds without.
    pub const fn lost(&self) -> u16 {
        self.lost
    }

    /// What was seen in `took_us`, up to `uptime_us`.
    pub fn measured(&self, took_us: u32, uptime_us: u64) -> Measured {
        let degrees = f32::from(self.count.saturating_sub(1).max(1));
        Measured {
            mean: self.mean,
            spread: self.squares.map(|squares| sqrtf(squares / degrees)),
            high: self.high,
            count: self.count,
            lost: self.lost,
            took_us,
            uptime_us,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_spreads_levels_and_losses_are_counted() {
        let mut average = Average::new();
        for i in 0..1000u16 {
            let swing = if i % 2 == 0 { 0.001 } else { -0.001 };
            average.take(Some([0.5 + swing, 0.25, 0.0, 1.0, 0.75]), [true, i < 250, false, false, i == 3]);
        }
        average.take(None, [true; PINS]);
        let measured = average.measured(1_001_000, 5_000_000);
        for (mean, expected) in measured.mean.into_iter().zip([0.5, 0.25, 0.0, 1.0, 0.75]) {
            // Half a code of the converter is 1.2e-4.
            assert!((mean - expected).abs() < 2e-5, "{mean}");
        }
        assert!((measured.spread[0] - 0.001).abs() < 1e-5 && measured.spread[1] == 0.0, "{:?}", measured.spread);
        assert_eq!((measured.high, measured.count, measured.lost), ([1000, 250, 0, 0, 1], 1000, 1));
    }

    #[test]
    fn nothing_seen_is_no_number_that_is_none() {
        let measured = Average::new().measured(0, 0);
        assert_eq!((measured.count, measured.mean, measured.spread), (0, [0.0; INPUTS], [0.0; INPUTS]));
    }

    #[test]
    fn the_table_has_a_fingerprint() {
        assert!(table().and_then(|table| crate::fingerprint::fingerprint(&table)).is_some());
    }
}
