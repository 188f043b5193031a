//! Whether the samples of a press can be identified at all: counted, and named if not.

use protocol::message::Outcome;

/// What a press must have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReadingsConfig {
    /// Fewest samples between surface and deepest row of the table.
    pub samples_min: u16,
    /// Samples in a row that read the press' largest force to the bit, each deeper than the one before, that are a sensor at its end. Noise or
    /// a rising force make even two of a kind rare; five are none.
    pub flat_min: u16,
}

impl Default for ReadingsConfig {
    fn default() -> Self {
        ReadingsConfig { samples_min: 10, flat_min: 5 }
    }
}

/// Samples of a press, counted by what they are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Readings {
    /// Below the surface, in the table.
    pub inside: u16,
    /// Deeper than the table.
    pub deeper: u16,
    /// Depth or force that is not a number.
    pub bad: u16,
    /// All.
    pub all: u16,
    /// Most in a row, each deeper than the one before, that read the largest force to the bit.
    pub flat: u16,
}

impl Readings {
    /// Counts samples (depth mm, force N) of a press into a table of `depth_max_mm`.
    pub fn of(samples: impl Iterator<Item = (f32, f32)> + Clone, depth_max_mm: f32) -> Self {
        let largest_n = samples.clone().fold(f32::NEG_INFINITY, |most, (_, f)| if f > most { f } else { most });
        let (mut readings, mut flat, mut before_mm) = (Readings::default(), 0, f32::NEG_INFINITY);
        for (depth_mm, force_n) in samples {
            readings.all = readings.all.saturating_add(1);
            let kind = if !(depth_mm.is_finite() && force_n.is_finite()) {
                &mut readings.bad
            } else if depth_mm > depth_max_mm {
                &mut readings.deeper
            } else if depth_mm > 0.0 {
                &mut readings.inside
            } else {
                continue;
            };
            *kind = kind.saturating_add(1);
            flat = if force_n == largest_n && depth_mm > before_mm { flat + 1 } else { 0 };
            readings.flat = readings.flat.max(flat);
            before_mm = depth_mm;
        }
        readings
    }

    /// Why nothing can be identified from them; `None` if something can. A tenth of the samples may be no number. A sixth may lie deeper than the table: a soft
    /// foam's contact is found up to 0.6 mm late when the load cell is noisy, the press then goes that much deeper, and still covers the table.
    pub const fn refused(&self, config: &ReadingsConfig) -> Option<Outcome> {
        let touching = self.inside as u32 + self.deeper as u32;
        if 10 * self.bad as u32 > self.all as u32 {
            Some(Outcome::BadReadings)
        } else if touching == 0 {
            Some(Outcome::NoContact)
        } else if self.flat >= config.flat_min {
            Some(Outcome::Saturated)
        } else if 6 * self.deeper as u32 > touching {
            Some(Outcome::DeeperThanTable)
        } else if self.inside < config.samples_min {
            Some(Outcome::TooShort)
        } else {
            None
        }
    }
}
