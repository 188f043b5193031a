//! The brown-out level of the chip's option bytes: below it the chip is held in reset, and its
//! outputs float.
//!
//! A chip from the factory has none: it runs on at voltages at which neither its flash nor its
//! clocks are specified. Option bytes are written as a whole, so what is read is changed in the
//! level's two bits alone (RM0090 section 3.7). The read protection is never touched: a wrong value
//! there locks the chip for ever.

use std::time::Duration;

use probe_rs::probe::list::Lister;
use probe_rs::{Core, MemoryInterface, Permissions};

use super::{FlashingError, choose};

/// Registers of the flash controller (RM0090 section 3.9).
const OPTKEYR: u64 = 0x4002_3c08;
const SR: u64 = 0x4002_3c0c;
const OPTCR: u64 = 0x4002_3c14;

/// Keys that unlock the option bytes (RM0090 section 3.7.2).
const KEYS: [u32; 2] = [0x0819_2a3b, 0x4c5d_6e7f];

const BUSY: u32 = 1 << 16;
const ERRORS: u32 = 0xf << 4;

const LOCK: u32 = 1;
const START: u32 = 1 << 1;
const LEVEL: u32 = 0b11 << 2;
const READ_PROTECTION: u32 = 0xff << 8;

/// Read protection level 0: none.
const UNPROTECTED: u32 = 0xaa << 8;

/// Longest time for the option bytes: an erase of 16 KiB takes at most 0.5 s (data sheet, flash
/// programming by words).
const POLLS: usize = 200;
const POLL: Duration = Duration::from_millis(5);

/// How the brown-out level was found and left.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum BrownOut {
    /// It was level 3 already.
    Already,
    /// It is level 3 now.
    Written,
    /// It is as it was: the answer was no.
    Declined,
}

/// Why the option bytes are left alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum OptionRefusal {
    /// The chip is read-protected.
    #[error("the chip is read-protected (RDP {0:#04x}): its option bytes are left as they are")]
    Protected(u8),
    /// They did not take the new value.
    #[error(
        "option bytes read {found:#010x} after they were written, expected {expected:#010x}: power the board off and on and try again"
    )]
    Unchanged {
        /// What is there.
        found: u32,
        /// What was written.
        expected: u32,
    },
    /// The controller stays busy.
    #[error("the flash controller stays busy: power the board off and on and try again")]
    Busy,
}

/// The option control register with brown-out level 3 in place of what was read; `None` if it is
/// that already.
///
/// # Errors
/// [`OptionRefusal::Protected`] unless the chip is free of read protection.
pub fn level_3(read: u32) -> Result<Option<u32>, OptionRefusal> {
    if read & READ_PROTECTION != UNPROTECTED {
        return Err(OptionRefusal::Protected((read >> 8) as u8));
    }
    // Level 3 is 0b00 (RM0090 table 17).
    Ok((read & LEVEL != 0).then_some(read & !(LEVEL | LOCK | START)))
}

/// Words of the chip's memory, as a probe or a test gives them.
pub trait Words {
    /// What can go wrong.
    type Error: From<OptionRefusal>;

    /// A word.
    ///
    /// # Errors
    /// Those of the way to the chip.
    fn read(&mut self, address: u64) -> Result<u32, Self::Error>;

    /// Sets a word.
    ///
    /// # Errors
    /// As [`Words::read`].
    fn write(&mut self, address: u64, word: u32) -> Result<(), Self::Error>;

    /// Lets a little time pass.
    fn pause(&mut self) {}
}

/// Sets level 3 after `agreed` has said so to the level that was found (0 is none); reads it back.
///
/// # Errors
/// A refusal, or a way to the chip that fails.
pub fn raise<W: Words>(chip: &mut W, agreed: impl FnOnce(u8) -> bool) -> Result<BrownOut, W::Error> {
    let read = chip.read(OPTCR)?;
    let Some(wanted) = level_3(read)? else {
        return Ok(BrownOut::Already);
    };
    // 0b11 is none, 0b10 level 1.
    if !agreed(3 - ((read & LEVEL) >> 2) as u8) {
        return Ok(BrownOut::Declined);
    }
    idle(chip)?;
    for key in KEYS {
        chip.write(OPTKEYR, key)?;
    }
    chip.write(SR, ERRORS)?;
    chip.write(OPTCR, wanted)?;
    chip.write(OPTCR, wanted | START)?;
    let done = idle(chip);
    chip.write(OPTCR, wanted | LOCK)?;
    done?;
    let found = chip.read(OPTCR)? & !(LOCK | START);
    let failed = chip.read(SR)? & ERRORS != 0;
    if failed || found != wanted {
        return Err(OptionRefusal::Unchanged { found, expected: wanted }.into());
    }
    Ok(BrownOut::Written)
}

fn idle<W: Words>(chip: &mut W) -> Result<(), W::Error> {
    for _ in 0..POLLS {
        if chip.read(SR)? & BUSY == 0 {
            return Ok(());
        }
        chip.pause();
    }
    Err(OptionRefusal::Busy.into())
}

/// A core behind a probe, and the chip's name for messages.
struct Probed<'a, 'b>(&'a mut Core<'b>, &'a str);

impl Probed<'_, '_> {
    fn failed(&self, what: &'static str, source: probe_rs::Error) -> FlashingError {
        FlashingError::Chip { chip: self.1.into(), what, source: source.into() }
    }
}

impl Words for Probed<'_, '_> {
    type Error = FlashingError;

    fn read(&mut self, address: u64) -> Result<u32, FlashingError> {
        self.0.read_word_32(address).map_err(|e| self.failed("read the option bytes", e))
    }

    fn write(&mut self, address: u64, word: u32) -> Result<(), FlashingError> {
        self.0.write_word_32(address, word).map_err(|e| self.failed("write the option bytes", e))
    }

    fn pause(&mut self) {
        std::thread::sleep(POLL);
    }
}

/// Sets the brown-out level of the chip behind a probe, if `agreed` says so to the level that was
/// found; the board is reset and stands still meanwhile, and starts again.
///
/// # Errors
/// [`FlashingError`].
pub fn set_up(
    lister: &Lister,
    serial: Option<&str>,
    chip: &str,
    agreed: impl FnOnce(u8) -> bool,
) -> Result<BrownOut, FlashingError> {
    let failed = |what, source: Box<dyn std::error::Error + Send + Sync>| FlashingError::Chip {
        chip: chip.into(),
        what,
        source,
    };
    let probe = choose(lister, serial)?;
    let mut session = lister
        .open(&probe)
        .map_err(|e| failed("open the probe", e.into()))?
        .attach(chip, Permissions::default())
        .map_err(|e| failed("attach", e.into()))?;
    let mut core = session.core(0).map_err(|e| failed("attach", e.into()))?;
    core.reset_and_halt(Duration::from_secs(1)).map_err(|e| failed("stop the chip", e.into()))?;
    let outcome = raise(&mut Probed(&mut core, chip), agreed);
    core.reset().map_err(|e| failed("restart", e.into()))?;
    outcome
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// As it comes from the factory (RM0090 section 3.9.10), locked.
    const FACTORY: u32 = 0x0fff_aaed;

    /// A chip that keeps what is started while it is unlocked, and every word written to it.
    struct Chip {
        optcr: u32,
        stored: u32,
        keys: Vec<u32>,
        busy: usize,
        written: Vec<(u64, u32)>,
    }

    impl Chip {
        fn new(optcr: u32) -> Self {
            Chip { optcr, stored: optcr & !(LOCK | START), keys: vec![], busy: 0, written: vec![] }
        }
    }

    impl Words for Chip {
        type Error = OptionRefusal;

        fn read(&mut self, address: u64) -> Result<u32, OptionRefusal> {
            self.busy = self.busy.saturating_sub(1);
            Ok(match address {
                SR if self.busy > 0 => BUSY,
                OPTCR => self.optcr,
                _ => 0,
            })
        }

        fn write(&mut self, address: u64, word: u32) -> Result<(), OptionRefusal> {
            self.written.push((address, word));
            match address {
                OPTKEYR => {
                    self.keys.push(word);
                    if self.keys == KEYS {
                        self.optcr &= !LOCK;
                    }
                }
                OPTCR if self.optcr & LOCK == 0 => {
                    self.optcr = word & !START;
                    if word & START != 0 {
                        self.stored = word & !(LOCK | START);
                        self.busy = 20;
                    }
                }
                _ => {}
            }
            Ok(())
        }
    }

    #[test]
    fn only_the_level_changes_and_the_chip_is_locked_again() {
        let mut chip = Chip::new(FACTORY);
        assert_eq!(raise(&mut chip, |level| level == 0), Ok(BrownOut::Written));
        assert_eq!(chip.stored ^ FACTORY, LEVEL | LOCK);
        assert_eq!(chip.optcr & LOCK, LOCK);
        assert!(chip.written.iter().all(|(at, word)| *at != OPTCR || word & READ_PROTECTION == UNPROTECTED));
        let written = chip.written.len();
        // A second time there is nothing to ask or to write.
        assert_eq!(raise(&mut chip, |_| unreachable!()), Ok(BrownOut::Already));
        assert_eq!(chip.written.len(), written);
    }

    #[test]
    fn without_a_yes_and_on_a_protected_chip_nothing_is_written() {
        let mut chip = Chip::new(FACTORY & !(1 << 2));
        assert_eq!(raise(&mut chip, |level| level != 1), Ok(BrownOut::Declined));
        assert_eq!(chip.written, []);
        for protection in [0x00, 0x55, 0xcc, 0xff] {
            let mut chip = Chip::new(FACTORY & !READ_PROTECTION | protection << 8);
            let refused = raise(&mut chip, |_| true);
            assert_eq!(refused, Err(OptionRefusal::Protected(protection as u8)));
            assert_eq!(chip.written, []);
        }
    }

    #[test]
    fn a_chip_that_does_not_take_it_or_stays_busy_is_told() {
        struct Deaf(Chip);
        impl Words for Deaf {
            type Error = OptionRefusal;
            fn read(&mut self, address: u64) -> Result<u32, OptionRefusal> {
                self.0.read(address)
            }
            fn write(&mut self, _: u64, _: u32) -> Result<(), OptionRefusal> {
                Ok(())
            }
        }
        let expected = FACTORY & !(LEVEL | LOCK | START);
        let found = FACTORY & !(LOCK | START);
        let refused = raise(&mut Deaf(Chip::new(FACTORY)), |_| true);
        assert_eq!(refused, Err(OptionRefusal::Unchanged { found, expected }));
        let mut busy = Chip::new(FACTORY);
        busy.busy = 2 * POLLS;
        assert_eq!(raise(&mut busy, |_| true), Err(OptionRefusal::Busy));
        assert_eq!(busy.written, []);
    }
}
