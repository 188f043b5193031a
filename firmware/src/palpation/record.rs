//! The samples of one palpation.

use crate::contact::Sample;

/// Most samples: 4 mm at 1 mm/s and 50 Hz are 200, with the lead before contact and the approach's overrun 300.
pub const RECORD_LEN: usize = 320;

/// Height and force (its zero taken off), in order of time.
#[derive(Debug, Clone)]
pub struct Record {
    samples: [Sample; RECORD_LEN],
    len: usize,
}

impl Default for Record {
    fn default() -> Self {
        Self::new()
    }
}

impl Record {
    /// Empty.
    pub const fn new() -> Self {
        Record { samples: [Sample { probe_mm: 0.0, force_n: 0.0 }; RECORD_LEN], len: 0 }
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        self.len = 0;
    }

    /// Adds a sample; false if there is no room.
    pub fn push(&mut self, sample: Sample) -> bool {
        match self.samples.get_mut(self.len) {
            Some(slot) => {
                *slot = sample;
                self.len += 1;
                true
            }
            None => false,
        }
    }

    /// Sample number `i`.
    pub fn get(&self, i: usize) -> Option<Sample> {
        self.samples().get(i).copied()
    }

    /// All samples.
    pub fn samples(&self) -> &[Sample] {
        self.samples.get(..self.len).unwrap_or(&[])
    }
}
