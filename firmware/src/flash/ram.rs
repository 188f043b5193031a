//! Flash bank 2 in RAM, for the simulated board and for tests: as strict as the real one.

use super::{BANK_LEN, CalibrationStore, EraseProgress, FlashError, Loaded, Setup, TableStore, WORD, sector_range};

/// What a simulated flash does when its power is cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PowerCut {
    /// Power stays.
    Never,
    /// After this many more words written or sectors erased nothing changes any more and every call fails.
    After(u32),
}

/// Flash bank 2 over any bytes. It refuses unaligned writes, and writes that would need a bit to rise: a word must be
/// erased (all ones) or be overwritten with zeros.
#[derive(Debug, Clone)]
pub struct RamFlash<B> {
    bytes: B,
    power: PowerCut,
    refused: u32,
    operations: u32,
    setup: Loaded,
}

impl<B: AsRef<[u8]> + AsMut<[u8]>> RamFlash<B> {
    /// Flash that holds `bytes`: [`BANK_LEN`] of them (erased flash is all `0xff`); shorter ones make every access
    /// beyond them fail.
    pub const fn new(bytes: B) -> Self {
        RamFlash { bytes, power: PowerCut::Never, refused: 0, operations: 0, setup: Loaded::Nothing }
    }

    /// Cuts the power after some more operations, or restores it.
    pub fn set_power(&mut self, power: PowerCut) {
        self.power = power;
    }

    /// Writes and erases refused because they broke a rule of the flash. Not zero means a defect in the caller.
    pub const fn rule_violations(&self) -> u32 {
        self.refused
    }

    /// Words written and sectors erased so far.
    pub const fn operations(&self) -> u32 {
        self.operations
    }

    /// Makes what was stored of the setup unreadable.
    pub fn tear_setup(&mut self) {
        self.setup = Loaded::Unreadable;
    }

    /// The bytes, e.g. to keep them over a simulated restart.
    pub fn into_inner(self) -> B {
        self.bytes
    }

    /// True while there is power for one more operation; counts it.
    fn spend(&mut self) -> Result<(), FlashError> {
        match &mut self.power {
            PowerCut::After(0) => return Err(FlashError),
            PowerCut::After(left) => *left -= 1,
            PowerCut::Never => {}
        }
        self.operations = self.operations.saturating_add(1);
        Ok(())
    }

    fn refuse(&mut self) -> Result<(), FlashError> {
        self.refused = self.refused.saturating_add(1);
        Err(FlashError)
    }
}

impl<B: AsRef<[u8]> + AsMut<[u8]>> TableStore for RamFlash<B> {
    fn bytes(&self) -> &[u8] {
        let bytes = self.bytes.as_ref();
        bytes.get(..BANK_LEN).unwrap_or(bytes)
    }

    fn start_erase(&mut self, sector: u8) -> Result<(), FlashError> {
        let Some(range) = sector_range(sector).filter(|r| r.end <= self.bytes().len()) else {
            return self.refuse();
        };
        self.spend()?;
        if let Some(bytes) = self.bytes.as_mut().get_mut(range) {
            bytes.fill(0xff);
        }
        Ok(())
    }

    fn poll_erase(&mut self) -> Result<EraseProgress, FlashError> {
        Ok(EraseProgress::Done)
    }

    fn write(&mut self, offset: usize, data: &[u8]) -> Result<(), FlashError> {
        let whole = offset.is_multiple_of(WORD) && data.len().is_multiple_of(WORD);
        let fits = offset.checked_add(data.len()).is_some_and(|end| end <= self.bytes().len());
        if !whole || !fits {
            return self.refuse();
        }
        for (i, word) in data.chunks_exact(WORD).enumerate() {
            let at = offset + i * WORD;
            let old = self.bytes().get(at..at + WORD).unwrap_or(&[]);
            let erased = old.iter().all(|b| *b == 0xff);
            let zeroing = word.iter().all(|b| *b == 0);
            if !erased && !zeroing {
                return self.refuse();
            }
            self.spend()?;
            if let Some(slot) = self.bytes.as_mut().get_mut(at..at + WORD) {
                slot.copy_from_slice(word);
            }
        }
        Ok(())
    }
}

impl<B: AsRef<[u8]> + AsMut<[u8]>> CalibrationStore for RamFlash<B> {
    fn load_setup(&mut self) -> Loaded {
        self.setup.clone()
    }

    fn save_setup(&mut self, setup: &Setup) -> Result<(), FlashError> {
        self.spend()?;
        self.setup = Loaded::Stored(setup.clone());
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_refuses_what_real_flash_cannot_do() {
        let mut flash = RamFlash::new(vec![0xffu8; BANK_LEN]);
        assert_eq!(flash.write(2, &[0; 4]), Err(FlashError));
        assert_eq!(flash.write(4, &[0; 3]), Err(FlashError));
        assert_eq!(flash.write(BANK_LEN, &[0; 4]), Err(FlashError));
        assert_eq!(flash.rule_violations(), 3);
        assert_eq!(flash.write(4, &[1, 2, 3, 4]), Ok(()));
        assert_eq!(flash.write(4, &[1, 2, 3, 4]), Err(FlashError));
        assert_eq!(flash.write(4, &[0; 4]), Ok(()));
        assert_eq!(flash.start_erase(0), Ok(()));
        assert_eq!(flash.bytes()[4], 0xff);
        assert_eq!(flash.start_erase(12), Err(FlashError));
    }

    #[test]
    fn after_a_power_cut_nothing_changes() {
        let mut flash = RamFlash::new(vec![0xffu8; BANK_LEN]);
        flash.set_power(PowerCut::After(1));
        assert_eq!(flash.write(0, &[1; 8]), Err(FlashError));
        assert_eq!(flash.bytes()[..8], [1, 1, 1, 1, 0xff, 0xff, 0xff, 0xff]);
        assert_eq!(flash.start_erase(0), Err(FlashError));
        assert_eq!(flash.bytes()[0], 1);
    }
}
