//! Tables in flash: slots, upload, and what a power cut leaves.
//!
//! Flash bank 2 (1 MiB) holds nothing but tables, so code runs from bank 1 while bank 2 is written. Two slots of
//! 512 KiB ([`Slot::A`], [`Slot::B`]) hold ordinary tables: a new one goes into the slot that is not in use, payload first
//! and header last, and only then is the old one's magic overwritten with zeros. A power cut at any write leaves the old
//! table or the new one. A table above 512 KiB takes the whole bank ([`Slot::Whole`]); there the old table
//! is gone once the upload begins, and a power cut leaves no table rather than a broken one.

pub mod journal;
mod ram;
mod upload;

pub use ram::{PowerCut, RamFlash};
pub use upload::Upload;

use protocol::lut::{Checked, HEADER_LEN, MAGIC, Table};
use protocol::message::{Calibration, Fitted, Slot};

/// Bytes of bank 2.
pub const BANK_LEN: usize = 1024 * 1024;

/// Bytes of one slot.
pub const SLOT_LEN: usize = BANK_LEN / 2;

/// Smallest unit of a write, bytes; offsets and lengths are multiples of it.
pub const WORD: usize = 4;

/// Sizes of bank 2's sectors in KiB (RM0090 table 6: sectors 12 to 23 of a 2 MiB part).
pub const SECTOR_KIB: [u16; 12] = [16, 16, 16, 16, 64, 128, 128, 128, 128, 128, 128, 128];

/// First byte and length of a sector of bank 2, by its number within the bank.
pub fn sector_range(sector: u8) -> Option<core::ops::Range<usize>> {
    let index = usize::from(sector);
    let len = usize::from(*SECTOR_KIB.get(index)?) * 1024;
    let from = SECTOR_KIB.iter().take(index).map(|kib| usize::from(*kib) * 1024).sum::<usize>();
    Some(from..from + len)
}

/// Number of the sector that holds a byte of bank 2.
pub fn sector_of(offset: usize) -> Option<u8> {
    (0..SECTOR_KIB.len() as u8).find(|s| sector_range(*s).is_some_and(|r| r.contains(&offset)))
}

/// Where a slot lies in bank 2; empty for [`Slot::None`].
pub const fn slot_range(slot: Slot) -> core::ops::Range<usize> {
    match slot {
        Slot::None => 0..0,
        Slot::A => 0..SLOT_LEN,
        Slot::B => SLOT_LEN..BANK_LEN,
        Slot::Whole => 0..BANK_LEN,
    }
}

/// Flash could not be erased or written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FlashError;

impl core::fmt::Display for FlashError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("flash could not be erased or written")
    }
}

impl core::error::Error for FlashError {}

/// How far an erase is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EraseProgress {
    /// Still erasing; ask again in the next tick. Bank 2 must not be read meanwhile.
    Busy,
    /// Done.
    Done,
}

/// Flash bank 2. Erasing a sector takes 1 to 2 s, so it is started and polled; writing a word takes 16 us and is not.
pub trait TableStore {
    /// The whole bank, memory-mapped, [`BANK_LEN`] bytes (a smaller store offers smaller slots only in tests).
    fn bytes(&self) -> &[u8];

    /// Starts to erase one sector (number within the bank).
    ///
    /// # Errors
    /// [`FlashError`] when the flash refuses.
    fn start_erase(&mut self, sector: u8) -> Result<(), FlashError>;

    /// Asks whether the started erase has ended.
    ///
    /// # Errors
    /// [`FlashError`] when the erase failed.
    fn poll_erase(&mut self) -> Result<EraseProgress, FlashError>;

    /// Writes whole words at a multiple of [`WORD`]. Bits can only fall: a word is erased, or is overwritten with
    /// zeros.
    ///
    /// # Errors
    /// [`FlashError`] when the flash refuses or the words do not read back.
    fn write(&mut self, offset: usize, data: &[u8]) -> Result<(), FlashError>;
}

/// What a board is set up for.
#[derive(Debug, Clone, PartialEq)]
pub struct Setup {
    /// Laws of its sensors.
    pub calibration: Calibration,
    /// Parts that are wired.
    pub fitted: Fitted,
}

/// What a store holds.
#[derive(Debug, Clone, PartialEq)]
pub enum Loaded {
    /// Nothing was ever stored.
    Nothing,
    /// The setup stored last that reads back whole.
    Stored(Setup),
    /// Something that does not read back.
    Unreadable,
}

/// Where a calibration and what goes with it survive a restart.
pub trait CalibrationStore {
    /// The setup stored last.
    fn load_setup(&mut self) -> Loaded;

    /// Stores a setup; after a power cut the old or the new one is there.
    ///
    /// # Errors
    /// [`FlashError`] when it could not be stored; the old one stays.
    fn save_setup(&mut self, setup: &Setup) -> Result<(), FlashError>;
}

/// The table in use.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ActiveTable {
    /// Its slot; never [`Slot::None`].
    pub slot: Slot,
    /// What its check found.
    pub checked: Checked,
}

/// Looks through the slots at start. The second value is true if a slot holds a table that does not pass its checks
/// while no slot holds a good one.
pub fn find_active(bank: &[u8]) -> (Option<ActiveTable>, bool) {
    let mut broken = false;
    for slot in [Slot::Whole, Slot::A, Slot::B] {
        let Some(bytes) = bank.get(slot_range(slot)) else {
            continue;
        };
        // A table in slot A begins where a whole-bank table does; its length tells which it is.
        match Table::parse(bytes) {
            Ok(table) if slot == Slot::Whole && table.bytes().len() <= SLOT_LEN => {}
            Ok(table) => {
                let checked = table.checked();
                return (Some(ActiveTable { slot, checked }), false);
            }
            Err(_) => broken |= bytes.get(..MAGIC.len()) == Some(&MAGIC[..]),
        }
    }
    (None, broken)
}

/// The slot a new table of `length` bytes goes to while `active` is in use; `None` if it is too long or too short.
pub fn slot_for(length: usize, active: Slot) -> Option<Slot> {
    match length {
        n if !(HEADER_LEN..=BANK_LEN).contains(&n) => None,
        n if n > SLOT_LEN => Some(Slot::Whole),
        _ if active == Slot::A => Some(Slot::B),
        _ => Some(Slot::A),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sectors_tile_the_bank_and_no_sector_crosses_the_slots() {
        let mut next = 0;
        for s in 0..SECTOR_KIB.len() as u8 {
            let range = sector_range(s).unwrap_or(0..0);
            assert_eq!(range.start, next);
            assert!(range.end <= SLOT_LEN || range.start >= SLOT_LEN);
            assert_eq!(sector_of(range.start), Some(s));
            assert_eq!(sector_of(range.end - 1), Some(s));
            next = range.end;
        }
        assert_eq!(next, BANK_LEN);
        assert_eq!(sector_of(BANK_LEN), None);
    }

    #[test]
    fn slots_alternate_and_large_tables_take_the_bank() {
        assert_eq!(slot_for(1000, Slot::None), Some(Slot::A));
        assert_eq!(slot_for(1000, Slot::A), Some(Slot::B));
        assert_eq!(slot_for(1000, Slot::B), Some(Slot::A));
        assert_eq!(slot_for(630_000, Slot::A), Some(Slot::Whole));
        assert_eq!(slot_for(BANK_LEN + 1, Slot::A), None);
        assert_eq!(slot_for(HEADER_LEN - 1, Slot::A), None);
    }
}
