//! Setups in flash: a journal of records in an erased region; the last whole record counts.
//!
//! A record is written into erased words and never changed, its CRC last, so a power cut leaves the old setup or the
//! new one. A region of 128 KiB takes 2,048 records; it is emptied only at start, before any output can be on
//! (see the image's `flash` module), because erasing in bank 1 halts the processor for 1 to 2 s.

use super::{Setup, WORD};
use crate::sensor::ALL_FITTED;
use protocol::frame::CRC32;
use protocol::message::{Calibration, Fitted, Report};

/// Bytes of a record: length (u32), body, CRC-32 of length and body in the last word. The body is the calibration (postcard,
/// as on the link) and a byte of the parts that are fitted; without this byte all are.
pub const RECORD_LEN: usize = 64;

const CRC_AT: usize = RECORD_LEN - WORD;

/// Kind of the report whose body a record begins with (`Calibration` in the table of messages).
const KIND: u8 = 0x89;

/// The record of a setup; `None` if it does not fit, which the schema rules out.
pub fn record(setup: &Setup) -> Option<[u8; RECORD_LEN]> {
    let mut record = [0; RECORD_LEN];
    let body = record.get_mut(WORD..CRC_AT)?;
    let len = Report::Calibration(setup.calibration.clone()).encode(body).ok()?.len();
    let Fitted { palpator, actuator, coil } = setup.fitted;
    *body.get_mut(len)? = u8::from(palpator) | u8::from(actuator) << 1 | u8::from(coil) << 2;
    record.get_mut(..WORD)?.copy_from_slice(&(len as u32 + 1).to_le_bytes());
    let crc = CRC32.checksum(record.get(..CRC_AT)?);
    record.get_mut(CRC_AT..)?.copy_from_slice(&crc.to_le_bytes());
    Some(record)
}

fn read(record: &[u8]) -> Option<Setup> {
    let (content, crc) = record.split_at_checked(CRC_AT)?;
    if CRC32.checksum(content).to_le_bytes() != *crc {
        return None;
    }
    let (len, body) = content.split_first_chunk::<WORD>()?;
    let body = body.get(..u32::from_le_bytes(*len) as usize)?;
    if let Some(calibration) = calibration(body) {
        return Some(Setup { calibration, fitted: ALL_FITTED });
    }
    let (fitted, body) = body.split_last()?;
    let is = |bit: u8| fitted & 1 << bit != 0;
    Some(Setup { calibration: calibration(body)?, fitted: Fitted { palpator: is(0), actuator: is(1), coil: is(2) } })
}

fn calibration(body: &[u8]) -> Option<Calibration> {
    match Report::decode(KIND, body) {
        Ok(Report::Calibration(calibration)) => Some(calibration),
        _ => None,
    }
}

/// The last whole record of a region.
pub fn latest(region: &[u8]) -> Option<Setup> {
    latest_by(region, read)
}

/// The last record that `read` makes a setup of. Places that were never written are passed over by their first
/// word, which is a length in every other: 2,048 checksums take 14 ms, and control waits for them in a tare.
fn latest_by(region: &[u8], read: impl FnMut(&[u8]) -> Option<Setup>) -> Option<Setup> {
    region.rchunks_exact(RECORD_LEN).filter(|record| !record.starts_with(&[0xff; WORD])).find_map(read)
}

/// True if nothing was ever written.
pub fn is_blank(bytes: &[u8]) -> bool {
    let (words, rest) = bytes.as_chunks::<8>();
    words.iter().all(|word| u64::from_ne_bytes(*word) == u64::MAX) && rest.iter().all(|b| *b == 0xff)
}

/// Offset of the first record place that is still erased, behind everything written; `None` if the region is full.
pub fn free_place(region: &[u8]) -> Option<usize> {
    let used = region.chunks_exact(RECORD_LEN).rposition(|record| !is_blank(record)).map_or(0, |last| last + 1);
    let at = used * RECORD_LEN;
    (at + RECORD_LEN <= region.len()).then_some(at)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::sensor::DEFAULT_CALIBRATION;

    fn with_zero(zero_ratio: f32) -> Setup {
        let mut calibration = DEFAULT_CALIBRATION;
        calibration.load_cell.zero_ratio = zero_ratio;
        Setup { calibration, fitted: Fitted { palpator: false, actuator: true, coil: true } }
    }

    /// As [`record`] was before a board could have parts missing.
    fn record_of_old(calibration: &Calibration) -> [u8; RECORD_LEN] {
        let mut record = [0; RECORD_LEN];
        let len = Report::Calibration(calibration.clone()).encode(&mut record[WORD..CRC_AT]).unwrap().len();
        record[..WORD].copy_from_slice(&(len as u32).to_le_bytes());
        let crc = CRC32.checksum(&record[..CRC_AT]);
        record[CRC_AT..].copy_from_slice(&crc.to_le_bytes());
        record
    }

    #[test]
    fn a_record_without_parts_is_of_a_whole_board() {
        let old = record_of_old(&DEFAULT_CALIBRATION);
        assert_eq!(latest(&old), Some(Setup { calibration: DEFAULT_CALIBRATION, fitted: ALL_FITTED }));
    }

    #[test]
    fn every_mask_of_parts_reads_back() {
        for bits in 0..8 {
            let is = |bit: u8| bits & 1 << bit != 0;
            let fitted = Fitted { palpator: is(0), actuator: is(1), coil: is(2) };
            let setup = Setup { calibration: DEFAULT_CALIBRATION, fitted };
            assert_eq!(latest(&record(&setup).unwrap()), Some(setup));
        }
    }

    #[test]
    fn one_record_is_checked_and_not_the_places_behind_it() {
        let mut region = vec![0xff; 2048 * RECORD_LEN];
        region[..RECORD_LEN].copy_from_slice(&record(&with_zero(0.1)).unwrap());
        let mut checked = 0;
        let found = latest_by(&region, |record| {
            checked += 1;
            read(record)
        });
        assert_eq!((found, checked), (Some(with_zero(0.1)), 1));
    }

    #[test]
    fn the_last_record_counts_until_the_region_is_full() {
        let mut region = vec![0xff; 4 * RECORD_LEN];
        assert_eq!(latest(&region), None);
        for i in 0..4 {
            let at = free_place(&region).unwrap();
            assert_eq!(at, i * RECORD_LEN);
            let calibration = with_zero(0.1 + 0.01 * i as f32);
            region[at..at + RECORD_LEN].copy_from_slice(&record(&calibration).unwrap());
            assert_eq!(latest(&region), Some(calibration));
        }
        assert_eq!(free_place(&region), None);
    }

    #[test]
    fn a_power_cut_at_any_word_leaves_the_old_calibration_or_the_new_one() {
        let (old, new) = (with_zero(0.1), with_zero(0.2));
        for words in 0..=RECORD_LEN / WORD {
            let mut region = vec![0xff; 4 * RECORD_LEN];
            region[..RECORD_LEN].copy_from_slice(&record(&old).unwrap());
            let written = words * WORD;
            region[RECORD_LEN..RECORD_LEN + written].copy_from_slice(&record(&new).unwrap()[..written]);
            let expected = if written == RECORD_LEN { &new } else { &old };
            assert_eq!(latest(&region).as_ref(), Some(expected), "{words} words");
            // A place that was begun is not used again: its words cannot be written twice.
            assert_eq!(free_place(&region), Some(if words == 0 { 1 } else { 2 } * RECORD_LEN));
        }
    }
}
