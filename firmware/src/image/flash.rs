//! The microcontroller's flash: tables in bank 2, calibrations in the last two sectors of bank 1.
//!
//! Why not embassy's driver, and why the data cache stays off:
//! `docs/decisions/0009-flash-and-caches.md`.
#![allow(unsafe_code)]

use crate::flash::{BANK_LEN, CalibrationStore, EraseProgress, FlashError, Loaded, Setup, TableStore, WORD, journal};
use embassy_stm32::pac::flash::regs::Acr;
use embassy_stm32::pac::flash::vals::Psize;
use embassy_stm32::peripherals::FLASH;
use embassy_stm32::{Peri, pac};

/// Bank 2 in the address space.
const BANK_2: usize = 0x0810_0000;

/// The two journals: sectors 10 and 11 of bank 1, address and sector number of the control register.
const JOURNALS: [(usize, u8); 2] = [(0x080C_0000, 10), (0x080E_0000, 11)];
const JOURNAL_LEN: usize = 128 * 1024;

/// Sector numbers of bank 2 begin here in the control register (RM0090 section 3.9.8: SNB 0b10000 is sector 12).
const BANK_2_SECTORS: u8 = 0b1_0000;

/// A journal with fewer places left is emptied at the next start.
const PLACES_LOW: usize = 64;

/// Keys of RM0090 section 3.6.1.
const KEYS: [u32; 2] = [0x4567_0123, 0xCDEF_89AB];

/// Instruction cache and prefetch on: what hides the 5 wait states of 168 MHz. The data cache stays
/// off.
pub fn accelerate() {
    pac::FLASH.acr().modify(|w| {
        w.set_icen(true);
        w.set_prften(true);
    });
}

/// The only owner of the flash controller.
pub struct BoardFlash {
    _flash: Peri<'static, FLASH>,
    /// Of the erase that is polled.
    erasing: Option<DataCacheOff>,
}

impl BoardFlash {
    /// Takes the flash and tidies the journals; an erase here takes 1 to 2 s, before the watchdog runs and with all outputs off.
    pub fn take(flash: Peri<'static, FLASH>) -> Self {
        let mut flash = BoardFlash { _flash: flash, erasing: None };
        flash.tidy();
        flash
    }

    /// Moves the latest calibration to the other journal when the one in use is nearly full: written there first, erased here after.
    fn tidy(&mut self) {
        // What cannot be read is not erased: the board says so, and the first setup that is stored goes behind it.
        let Some(used) = in_use() else {
            return;
        };
        let other = 1 - used;
        let low =
            journal::free_place(region(used)).is_none_or(|at| at + PLACES_LOW * journal::RECORD_LEN > JOURNAL_LEN);
        let Some(latest) = journal::latest(region(used)).filter(|_| low) else {
            return;
        };
        let blank = journal::is_blank(region(other));
        let ready = blank || erase_journal(other).is_ok();
        if ready && append(other, &latest).is_ok() && erase_journal(used).is_err() {
            defmt::error!("journal could not be erased");
        }
    }
}

/// The journal that holds records. If a power cut left both, the fuller one is older and will be emptied again.
fn in_use() -> Option<usize> {
    let places = |j: usize| journal::free_place(region(j)).unwrap_or(JOURNAL_LEN);
    match (journal::latest(region(0)), journal::latest(region(1))) {
        (None, None) => None,
        (Some(_), None) => Some(0),
        (None, Some(_)) => Some(1),
        (Some(_), Some(_)) => Some(if places(0) >= places(1) { 0 } else { 1 }),
    }
}

fn region(number: usize) -> &'static [u8] {
    let (address, _) = JOURNALS[number & 1];
    // SAFETY: memory-mapped flash, always readable; written only through `program`, which no slice outlives within a function.
    unsafe { core::slice::from_raw_parts(address as *const u8, JOURNAL_LEN) }
}

fn append(number: usize, setup: &Setup) -> Result<(), FlashError> {
    let at = journal::free_place(region(number)).ok_or(FlashError)?;
    let record = journal::record(setup).ok_or(FlashError)?;
    program(JOURNALS[number & 1].0 + at, &record)
}

/// Blocks for 1 to 2 s: code runs from the same bank.
fn erase_journal(number: usize) -> Result<(), FlashError> {
    let cache = DataCacheOff::begin();
    start_erase(JOURNALS[number & 1].1);
    while pac::FLASH.sr().read().bsy() {}
    finish_erase(cache)
}

fn unlock() {
    if pac::FLASH.cr().read().lock() {
        for key in KEYS {
            pac::FLASH.keyr().write_value(key);
        }
    }
}

fn clear_errors() {
    pac::FLASH.sr().write(|w| {
        w.set_eop(true);
        w.set_pgserr(true);
        w.set_pgperr(true);
        w.set_pgaerr(true);
        w.set_wrperr(true);
        w.set_operr(true);
    });
}

/// True if no error flag is set.
fn succeeded() -> bool {
    let sr = pac::FLASH.sr().read();
    !(sr.pgserr() || sr.pgperr() || sr.pgaerr() || sr.wrperr() || sr.operr())
}

/// The data cache is off while the controller erases or programs: a read of one bank while the
/// other is written may corrupt it (ES0206 section 2.2.12). Holds what the access control register
/// was before.
#[must_use]
struct DataCacheOff(Acr);

impl DataCacheOff {
    fn begin() -> Self {
        let before = pac::FLASH.acr().read();
        pac::FLASH.acr().modify(|w| w.set_dcen(false));
        DataCacheOff(before)
    }

    /// Empties both caches of what has changed, which they allow only while they are off (RM0090
    /// section 3.6.4), and puts the register back.
    fn end(self) {
        pac::FLASH.acr().modify(|w| {
            w.set_dcen(false);
            w.set_icen(false);
        });
        pac::FLASH.acr().modify(|w| {
            w.set_dcrst(true);
            w.set_icrst(true);
        });
        pac::FLASH.acr().modify(|w| {
            w.set_dcrst(false);
            w.set_icrst(false);
        });
        pac::FLASH.acr().write_value(self.0);
    }
}

fn start_erase(sector: u8) {
    unlock();
    clear_errors();
    pac::FLASH.cr().modify(|w| {
        w.set_ser(true);
        w.set_snb(sector);
        w.set_psize(Psize::PSIZE32);
    });
    pac::FLASH.cr().modify(|w| w.set_strt(true));
}

fn finish_erase(cache: DataCacheOff) -> Result<(), FlashError> {
    let succeeded = succeeded();
    pac::FLASH.cr().modify(|w| {
        w.set_ser(false);
        w.set_lock(true);
    });
    cache.end();
    if succeeded { Ok(()) } else { Err(FlashError) }
}

/// Writes words and reads them back; 16 us each.
fn program(address: usize, data: &[u8]) -> Result<(), FlashError> {
    let cache = DataCacheOff::begin();
    unlock();
    clear_errors();
    pac::FLASH.cr().modify(|w| {
        w.set_psize(Psize::PSIZE32);
        w.set_pg(true);
    });
    let mut result = Ok(());
    for (i, word) in data.as_chunks::<WORD>().0.iter().enumerate() {
        let place = (address + i * WORD) as *mut u32;
        // SAFETY: callers give word-aligned addresses inside bank 2 or a journal, which hold no code and no Rust object.
        unsafe { place.write_volatile(u32::from_le_bytes(*word)) };
        while pac::FLASH.sr().read().bsy() {}
        if !succeeded() {
            result = Err(FlashError);
            break;
        }
    }
    pac::FLASH.cr().modify(|w| {
        w.set_pg(false);
        w.set_lock(true);
    });
    cache.end();
    for (i, word) in data.as_chunks::<WORD>().0.iter().enumerate() {
        // SAFETY: as above; reading flash is always allowed.
        let stored = unsafe { ((address + i * WORD) as *const u32).read_volatile() };
        if stored != u32::from_le_bytes(*word) {
            result = Err(FlashError);
        }
    }
    result
}

impl TableStore for BoardFlash {
    fn bytes(&self) -> &[u8] {
        // SAFETY: memory-mapped flash; writes need `&mut self`, so no slice lives across them.
        unsafe { core::slice::from_raw_parts(BANK_2 as *const u8, BANK_LEN) }
    }

    fn start_erase(&mut self, sector: u8) -> Result<(), FlashError> {
        if crate::flash::sector_range(sector).is_none() {
            return Err(FlashError);
        }
        self.erasing.get_or_insert_with(DataCacheOff::begin);
        start_erase(BANK_2_SECTORS + sector);
        Ok(())
    }

    fn poll_erase(&mut self) -> Result<EraseProgress, FlashError> {
        if pac::FLASH.sr().read().bsy() {
            return Ok(EraseProgress::Busy);
        }
        let cache = self.erasing.take().unwrap_or_else(DataCacheOff::begin);
        finish_erase(cache).map(|()| EraseProgress::Done)
    }

    fn write(&mut self, offset: usize, data: &[u8]) -> Result<(), FlashError> {
        let whole = offset.is_multiple_of(WORD) && data.len().is_multiple_of(WORD);
        let fits = offset.checked_add(data.len()).is_some_and(|end| end <= BANK_LEN);
        if !whole || !fits {
            return Err(FlashError);
        }
        program(BANK_2 + offset, data)
    }
}

impl CalibrationStore for BoardFlash {
    fn load_setup(&mut self) -> Loaded {
        match in_use().and_then(|used| journal::latest(region(used))) {
            Some(setup) => Loaded::Stored(setup),
            None if (0..2).all(|j| journal::is_blank(region(j))) => Loaded::Nothing,
            None => Loaded::Unreadable,
        }
    }

    fn save_setup(&mut self, setup: &Setup) -> Result<(), FlashError> {
        // Without a record: the first journal with a place, be it behind what cannot be read.
        let has_place = |j: &usize| journal::free_place(region(*j)).is_some();
        append(in_use().or_else(|| (0..2).find(has_place)).unwrap_or(0), setup)
    }
}
