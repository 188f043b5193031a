//! Flash controller: keys, erase and program with their rules and durations (RM0090 section 3); of
//! the caches only what the rules for them say.

use crate::time::{MICROSECOND, MILLISECOND, Time};

const ACR: usize = 0x00;
const KEYR: usize = 0x04;
const OPTKEYR: usize = 0x08;
const SR: usize = 0x0c;
const CR: usize = 0x10;
const OPTCR: usize = 0x14;

const EOP: u32 = 1;
const WRPERR: u32 = 1 << 4;
const PGPERR: u32 = 1 << 6;
const PGSERR: u32 = 1 << 7;
const BSY: u32 = 1 << 16;

const PRFTEN: u32 = 1 << 8;
const ICEN: u32 = 1 << 9;
const DCEN: u32 = 1 << 10;
const ICRST: u32 = 1 << 11;
const DCRST: u32 = 1 << 12;

const PG: u32 = 1;
const SER: u32 = 1 << 1;
const STRT: u32 = 1 << 16;
const LOCK: u32 = 1 << 31;

const KEYS: [u32; 2] = [0x4567_0123, 0xcdef_89ab];
const OPTION_KEYS: [u32; 2] = [0x0819_2a3b, 0x4c5d_6e7f];

const OPTLOCK: u32 = 1;
const OPTSTRT: u32 = 1 << 1;

/// Bytes of both banks.
pub const FLASH_LEN: usize = 2 << 20;
const BANK_LEN: usize = 1 << 20;

/// Word program time (data sheet, table of flash programming, x32: 16 us typical).
const PROGRAM: Time = 16 * MICROSECOND;

/// Erase times of 16, 64 and 128 KiB (same table, typical, x32).
const ERASE: [(usize, Time); 3] = [(16, 250 * MILLISECOND), (64, 550 * MILLISECOND), (128, 1000 * MILLISECOND)];

/// What changes in the memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Change {
    /// The word at this offset becomes this.
    Word(usize, u32),
    /// The sector from offset with length becomes blank.
    Erase(usize, usize),
}

/// The controller.
#[derive(Debug, Clone)]
pub struct Flash {
    acr: u32,
    cr: u32,
    status: u32,
    keys: usize,
    busy_until: Time,
    /// Programs and erases since the chip was made.
    pub operations: u64,
    /// Programs and erases with the data cache on, which may corrupt it (ES0206 section 2.2.12),
    /// and resets of a cache that was on (RM0090 section 3.6.4), since the chip was made.
    pub violations: u64,
    /// Option bytes in place: OPTCR without its two lowest bits.
    pub options: u32,
    optcr: u32,
    option_keys: usize,
    /// Injected fault: programs and erases end with an error and change nothing.
    pub broken: bool,
}

impl Flash {
    /// After a reset: locked.
    pub fn new() -> Self {
        Flash {
            acr: 0,
            cr: LOCK,
            status: 0,
            keys: 0,
            busy_until: 0,
            operations: 0,
            violations: 0,
            options: 0x0fff_aaec,
            optcr: 0x0fff_aaec | OPTLOCK,
            option_keys: 0,
            broken: false,
        }
    }

    /// Sets the option bytes, as a programmer does.
    pub fn set_options(&mut self, options: u32) {
        self.options = options;
        self.optcr = options | OPTLOCK;
    }

    /// Puts the registers to their reset values.
    pub fn reset(&mut self) {
        let Flash { operations, violations, options, broken, .. } = *self;
        *self = Flash { operations, violations, options, optcr: options | OPTLOCK, broken, ..Flash::new() };
    }

    /// True if every instruction fetch waits for the flash: wait states, and no cache and prefetch
    /// to hide them.
    pub fn is_slow(&self) -> bool {
        self.acr & 0xf != 0 && self.acr & (ICEN | PRFTEN) != ICEN | PRFTEN
    }

    /// True if an operation may begin: with the data cache on none may.
    fn may_begin(&mut self) -> bool {
        let violated = self.acr & DCEN != 0;
        self.violations += u64::from(violated);
        if violated || self.broken {
            self.status |= PGSERR;
        }
        !violated && !self.broken
    }

    /// Offset and length of a sector by its number in CR (SNB: 0 to 11 bank 1, 16 to 27 bank 2).
    fn sector(number: u32) -> Option<(usize, usize)> {
        let bank = match number {
            0..=11 => 0,
            16..=27 => BANK_LEN,
            _ => return None,
        };
        let (at, kib) = match number & 0xf {
            n @ 0..=3 => (16 * n, 16),
            4 => (64, 64),
            n => (128 * (n - 4), 128),
        };
        Some((bank + (at as usize) * 1024, kib * 1024))
    }

    /// The program has written `value` to flash, whose word there was `old`: what becomes of the memory, and for how long the core stands still
    /// because it fetches its code from the bank that is busy.
    pub fn program(&mut self, offset: usize, size: usize, old: u32, value: u32, now: Time) -> (Change, Time) {
        let unchanged = Change::Word(offset, old);
        if self.cr & LOCK != 0 || self.cr & PG == 0 {
            self.status |= PGSERR;
            return (unchanged, 0);
        }
        if self.cr >> 8 & 3 != 2 || size != 4 || !offset.is_multiple_of(4) {
            self.status |= PGPERR;
            return (unchanged, 0);
        }
        if self.is_busy(now) {
            self.status |= WRPERR;
            return (unchanged, 0);
        }
        if !self.may_begin() {
            return (unchanged, 0);
        }
        // Programming only clears bits.
        (Change::Word(offset, old & value), self.begin(offset, PROGRAM, now))
    }

    fn begin(&mut self, offset: usize, duration: Time, now: Time) -> Time {
        self.operations += 1;
        self.busy_until = now + duration;
        self.status |= EOP;
        if offset < BANK_LEN { duration } else { 0 }
    }

    /// True while an operation runs.
    pub fn is_busy(&self, now: Time) -> bool {
        now < self.busy_until
    }

    /// Value of a register.
    pub fn read(&self, offset: usize, now: Time) -> u32 {
        match offset {
            ACR => self.acr,
            SR if self.is_busy(now) => self.status & !EOP | BSY,
            SR => self.status,
            CR => self.cr,
            OPTCR => self.optcr,
            _ => 0,
        }
    }

    /// Sets a register; an erase that it starts, and for how long the core stands still by it.
    pub fn write(&mut self, offset: usize, value: u32, now: Time) -> Option<(Change, Time)> {
        match offset {
            ACR => {
                for (reset, enable) in [(ICRST, ICEN), (DCRST, DCEN)] {
                    self.violations += u64::from(value & reset != 0 && (self.acr | value) & enable != 0);
                }
                self.acr = value;
            }
            KEYR => {
                // Both keys in order unlock; a wrong one locks until the next reset, which no image of ours needs.
                self.keys = if KEYS.get(self.keys) == Some(&value) { self.keys + 1 } else { 0 };
                if self.keys == KEYS.len() {
                    self.keys = 0;
                    self.cr &= !LOCK;
                }
            }
            OPTKEYR => {
                self.option_keys =
                    if OPTION_KEYS.get(self.option_keys) == Some(&value) { self.option_keys + 1 } else { 0 };
                if self.option_keys == OPTION_KEYS.len() {
                    self.option_keys = 0;
                    self.optcr &= !OPTLOCK;
                }
            }
            OPTCR if self.optcr & OPTLOCK == 0 => {
                self.optcr = value & !OPTSTRT;
                // At once: it is a debugger that writes them, whose halted core lets no time pass.
                if value & OPTSTRT != 0 && !self.is_busy(now) {
                    self.options = value & !(OPTLOCK | OPTSTRT);
                }
            }
            SR => self.status &= !value,
            CR if self.cr & LOCK == 0 || value & LOCK != 0 => {
                self.cr = value & !STRT;
                if value & STRT != 0 && value & SER != 0 && !self.is_busy(now) {
                    let (at, length) = Flash::sector(value >> 3 & 0x1f)?;
                    if !self.may_begin() {
                        return None;
                    }
                    let (_, duration) = ERASE.into_iter().find(|(kib, _)| kib * 1024 == length)?;
                    return Some((Change::Erase(at, length), self.begin(at, duration, now)));
                }
            }
            _ => {}
        }
        None
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn unlocked() -> Flash {
        let mut flash = Flash::new();
        for key in KEYS {
            flash.write(KEYR, key, 0);
        }
        flash
    }

    #[test]
    fn a_locked_or_unprepared_controller_changes_nothing_and_says_so() {
        let mut flash = Flash::new();
        assert_eq!(flash.program(0x10_0000, 4, 7, 1, 0).0, Change::Word(0x10_0000, 7));
        assert_eq!(flash.read(SR, 0) & PGSERR, PGSERR);
        let mut flash = unlocked();
        flash.write(CR, PG, 0);
        assert_eq!(flash.program(0x10_0000, 4, 7, 1, 0).0, Change::Word(0x10_0000, 7));
        assert_eq!((flash.read(SR, 0) & PGPERR, flash.operations), (PGPERR, 0));
    }

    #[test]
    fn programming_clears_bits_takes_its_time_and_stalls_only_its_own_bank() {
        let mut flash = unlocked();
        flash.write(CR, PG | 2 << 8, 0);
        assert_eq!(flash.program(0x10_0000, 4, 0xff00, 0x1234, 0), (Change::Word(0x10_0000, 0x1200), 0));
        assert_eq!(flash.read(SR, PROGRAM - 1) & BSY, BSY);
        assert_eq!(flash.read(SR, PROGRAM) & (BSY | EOP), EOP);
        assert_eq!(flash.program(0xc_0000, 4, !0, 5, PROGRAM), (Change::Word(0xc_0000, 5), PROGRAM));
    }

    #[test]
    fn with_the_data_cache_on_nothing_is_written_and_every_try_is_counted() {
        let mut flash = unlocked();
        flash.write(ACR, DCEN, 0);
        flash.write(CR, PG | 2 << 8, 0);
        assert_eq!(flash.program(0x10_0000, 4, !0, 1, 0), (Change::Word(0x10_0000, !0), 0));
        assert_eq!(flash.read(SR, 0) & (PGSERR | BSY), PGSERR);
        assert_eq!(flash.write(CR, SER | STRT | 16 << 3 | 2 << 8, 0), None);
        assert_eq!((flash.violations, flash.operations), (2, 0));
        flash.write(ACR, DCEN | DCRST, 0);
        assert_eq!(flash.violations, 3);
        flash.write(ACR, 0, 0);
        flash.write(ACR, DCRST | ICRST, 0);
        assert_eq!(flash.violations, 3);
    }

    #[test]
    fn sectors_lie_where_the_manual_says() {
        let mut flash = unlocked();
        let mut erase = |sector: u32| {
            let at = u64::from(sector) * 2000 * MILLISECOND;
            flash.write(CR, SER | STRT | sector << 3 | 2 << 8, at)
        };
        assert_eq!(erase(4).unwrap().0, Change::Erase(0x1_0000, 0x1_0000));
        assert_eq!(erase(11).unwrap(), (Change::Erase(0xe_0000, 0x2_0000), 1000 * MILLISECOND));
        assert_eq!(erase(13), None);
        assert_eq!(erase(16).unwrap(), (Change::Erase(0x10_0000, 0x4000), 0));
        assert_eq!(erase(27).unwrap().0, Change::Erase(0x1e_0000, 0x2_0000));
    }
}
