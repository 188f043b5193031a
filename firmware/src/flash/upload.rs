//! Upload of a table over the link: pieces in order, header last.

use super::{ActiveTable, EraseProgress, SLOT_LEN, TableStore, WORD, find_active, sector_of, slot_for, slot_range};
use protocol::lut::{HEADER_LEN, MAGIC, Table, VERSION};
use protocol::message::{Refusal, Slot, TableBegin, TableChunk};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Phase {
    None,
    /// Sector being erased, and the last one to erase.
    Erasing {
        sector: u8,
        last: u8,
    },
    Receiving,
}

/// State of the upload. At most one at a time; a new [`TableBegin`] replaces it.
#[derive(Debug, Clone)]
pub struct Upload {
    phase: Phase,
    slot: Slot,
    begin: TableBegin,
    next: usize,
    /// The header waits here until the payload is in flash.
    header: [u8; HEADER_LEN],
    /// Bytes of a word that is not complete yet.
    word: [u8; WORD],
    /// The last upload became the active table.
    committed: bool,
}

impl Default for Upload {
    fn default() -> Self {
        Self::new()
    }
}

impl Upload {
    /// No upload.
    pub const fn new() -> Self {
        Upload {
            phase: Phase::None,
            slot: Slot::None,
            begin: TableBegin { length: 0, crc: 0 },
            next: 0,
            header: [0; HEADER_LEN],
            word: [0; WORD],
            committed: false,
        }
    }

    /// Next byte expected; 0 without an upload.
    pub const fn next_offset(&self) -> u32 {
        self.next as u32
    }

    /// Length announced; 0 without an upload.
    pub const fn length(&self) -> u32 {
        self.begin.length
    }

    /// True while flash is being erased: bank 2 must not be read.
    pub const fn is_erasing(&self) -> bool {
        matches!(self.phase, Phase::Erasing { .. })
    }

    /// Starts an upload: chooses the slot, forgets `active` if the new table needs its place, starts the erase.
    ///
    /// # Errors
    /// [`Refusal::TooLarge`] (also for a length shorter than a header: [`Refusal::OutOfRange`]), [`Refusal::FlashFailed`],
    /// [`Refusal::Busy`] during an erase.
    pub fn begin<S: TableStore>(
        &mut self,
        store: &mut S,
        active: &mut Option<ActiveTable>,
        begin: &TableBegin,
    ) -> Result<(), Refusal> {
        if self.is_erasing() {
            return Err(Refusal::Busy);
        }
        let length = begin.length as usize;
        if length < HEADER_LEN {
            return Err(Refusal::OutOfRange);
        }
        let in_use = active.map_or(Slot::None, |a| a.slot);
        let slot = slot_for(length, in_use).ok_or(Refusal::TooLarge)?;
        let range = slot_range(slot);
        let (Some(sector), Some(last)) = (sector_of(range.start), sector_of(range.start + length - 1)) else {
            return Err(Refusal::TooLarge);
        };
        *self = Upload::new();
        if slot == Slot::Whole || in_use == Slot::Whole {
            *active = None;
        }
        store.start_erase(sector).map_err(|_| Refusal::FlashFailed)?;
        self.phase = Phase::Erasing { sector, last };
        self.slot = slot;
        self.begin = begin.clone();
        Ok(())
    }

    /// One tick of the erase: `None` while it runs or when there is none; then whether it succeeded.
    pub fn poll<S: TableStore>(&mut self, store: &mut S) -> Option<Result<(), Refusal>> {
        let Phase::Erasing { sector, last } = self.phase else {
            return None;
        };
        match store.poll_erase() {
            Ok(EraseProgress::Busy) => return None,
            Ok(EraseProgress::Done) if sector < last => {
                if store.start_erase(sector + 1).is_ok() {
                    self.phase = Phase::Erasing { sector: sector + 1, last };
                    return None;
                }
            }
            Ok(EraseProgress::Done) => {
                self.phase = Phase::Receiving;
                return Some(Ok(()));
            }
            Err(_) => {}
        }
        *self = Upload::new();
        Some(Err(Refusal::FlashFailed))
    }

    /// Takes a piece.
    ///
    /// # Errors
    /// [`Refusal::OutOfOrder`] if it does not continue the upload (a repeated piece is fine), [`Refusal::Busy`] during the
    /// erase, [`Refusal::OutOfRange`] beyond the announced length, [`Refusal::FlashFailed`], which ends the upload.
    pub fn chunk<S: TableStore>(&mut self, store: &mut S, chunk: &TableChunk) -> Result<(), Refusal> {
        match self.phase {
            Phase::None => return Err(Refusal::OutOfOrder),
            Phase::Erasing { .. } => return Err(Refusal::Busy),
            Phase::Receiving => {}
        }
        let from = chunk.offset as usize;
        let end = from.saturating_add(chunk.data.len());
        if end > self.begin.length as usize {
            return Err(Refusal::OutOfRange);
        }
        if end <= self.next {
            return Ok(());
        }
        if from != self.next {
            return Err(Refusal::OutOfOrder);
        }
        for byte in &chunk.data {
            if self.put(store, *byte).is_err() {
                *self = Upload::new();
                return Err(Refusal::FlashFailed);
            }
        }
        Ok(())
    }

    fn put<S: TableStore>(&mut self, store: &mut S, byte: u8) -> Result<(), super::FlashError> {
        let at = self.next;
        self.next += 1;
        if let Some(slot) = self.header.get_mut(at) {
            *slot = byte;
            return Ok(());
        }
        if let Some(slot) = self.word.get_mut(at % WORD) {
            *slot = byte;
        }
        let last = self.next == self.begin.length as usize;
        if self.next.is_multiple_of(WORD) || last {
            let base = slot_range(self.slot).start + at / WORD * WORD;
            store.write(base, &self.word)?;
            self.word = [0; WORD];
        }
        Ok(())
    }

    /// Checks the upload, writes its header, makes it the active table and retires the old one. Asked again after a success (its answer
    /// was lost), it succeeds again and changes nothing.
    ///
    /// # Errors
    /// [`Refusal::OutOfOrder`] without a complete upload; [`Refusal::TableRejected`] if it does not pass its checks, after which the upload is
    /// gone and the old table stays; [`Refusal::FlashFailed`], after which the upload is gone and the table in use is the one that a restart
    /// would find: if the old one could not be retired, that of slot A, old or new.
    pub fn commit<S: TableStore>(&mut self, store: &mut S, active: &mut Option<ActiveTable>) -> Result<(), Refusal> {
        if self.phase == Phase::None && self.committed {
            return Ok(());
        }
        if self.phase != Phase::Receiving || self.next != self.begin.length as usize {
            return Err(Refusal::OutOfOrder);
        }
        let upload = core::mem::take(self);
        let base = slot_range(upload.slot).start;
        if !upload.header_is_plausible() || !upload.crc_is_as_announced(store.bytes(), base) {
            return Err(Refusal::TableRejected);
        }
        let done = upload.activate(store, active, base);
        if done == Err(Refusal::FlashFailed) {
            *active = find_active(store.bytes()).0;
        }
        self.committed = done.is_ok();
        done
    }

    /// Header last, then the old table's end.
    fn activate<S: TableStore>(
        &self,
        store: &mut S,
        active: &mut Option<ActiveTable>,
        base: usize,
    ) -> Result<(), Refusal> {
        store.write(base, &self.header).map_err(|_| Refusal::FlashFailed)?;
        let parsed =
            store.bytes().get(slot_range(self.slot)).and_then(|bytes| Table::parse(bytes).ok().map(|t| t.checked()));
        let Some(checked) = parsed else {
            retire(store, base)?;
            return Err(Refusal::TableRejected);
        };
        let old = active.replace(ActiveTable { slot: self.slot, checked });
        match old {
            Some(old) if old.slot != self.slot => retire(store, slot_range(old.slot).start)?,
            // Without an active table the other slot may still hold an older one that was not chosen.
            None if self.slot != Slot::Whole => {
                let other = SLOT_LEN - base;
                let has_table = store.bytes().get(other..other + MAGIC.len()) == Some(&MAGIC[..]);
                if has_table {
                    retire(store, other)?;
                }
            }
            _ => {}
        }
        Ok(())
    }

    fn header_is_plausible(&self) -> bool {
        self.header.starts_with(&MAGIC)
            && self.header.get(8..10) == Some(&VERSION.to_le_bytes()[..])
            && self.header.get(12..16) == Some(&self.begin.length.to_le_bytes()[..])
    }

    fn crc_is_as_announced(&self, bank: &[u8], base: usize) -> bool {
        let payload = base + HEADER_LEN..base + self.begin.length as usize;
        let Some(payload) = bank.get(payload) else {
            return false;
        };
        let crc = protocol::frame::CRC32;
        let mut digest = crc.digest();
        digest.update(&self.header);
        digest.update(payload);
        digest.finalize() == self.begin.crc
    }
}

/// Overwrites a table's magic with zeros, which flash allows without an erase.
fn retire<S: TableStore>(store: &mut S, base: usize) -> Result<(), Refusal> {
    store.write(base, &[0; MAGIC.len()]).map_err(|_| Refusal::FlashFailed)
}

#[cfg(test)]
mod tests;
