//! The independent watchdog (RM0090 section 21).

use crate::time::{SECOND, Time};

const KR: usize = 0x00;
const PR: usize = 0x04;
const RLR: usize = 0x08;
const SR: usize = 0x0c;

const RVU: u32 = 1 << 1;

/// Clocks of the oscillator until a new reload value counts (RM0090 section 21.3.3: up to five). The prescaler, which is written once before the start, is
/// taken over at once.
const UPDATE_CLOCKS: u64 = 5;

/// Its counter, on the chip's RC oscillator.
#[derive(Debug, Clone)]
pub struct Watchdog {
    /// Frequency of the RC oscillator, Hz: 17,000 to 47,000 (STM32F429 data sheet, LSI characteristics), typically 32,000.
    oscillator_hz: u64,
    prescaler: u32,
    reload: u32,
    /// A new reload value, and when it is taken over.
    update: Option<(u32, Time)>,
    unlocked: bool,
    expires: Option<Time>,
}

impl Watchdog {
    /// Not started.
    pub fn new(oscillator_hz: u64) -> Self {
        Watchdog { oscillator_hz, prescaler: 0, reload: 0xfff, update: None, unlocked: false, expires: None }
    }

    /// Frequency of the oscillator, Hz.
    pub fn oscillator_hz(&self) -> u64 {
        self.oscillator_hz
    }

    fn timeout(&self) -> Time {
        let divider = 4 << self.prescaler.min(6);
        (u64::from(self.reload) + 1) * divider * SECOND / self.oscillator_hz
    }

    /// When it resets the chip.
    pub fn next_event(&self) -> Option<Time> {
        self.expires
    }

    /// Takes over a new reload value when its time has come.
    fn sync(&mut self, now: Time) {
        if let Some((reload, _)) = self.update.take_if(|(_, at)| *at <= now) {
            self.reload = reload;
        }
    }

    /// Value of a register.
    pub fn read(&mut self, offset: usize, now: Time) -> u32 {
        self.sync(now);
        match offset {
            PR => self.prescaler,
            RLR => self.reload,
            SR if self.update.is_some() => RVU,
            _ => 0,
        }
    }

    /// Sets a register.
    pub fn write(&mut self, offset: usize, value: u32, now: Time) {
        self.sync(now);
        match (offset, value) {
            (KR, 0x5555) => self.unlocked = true,
            (KR, 0xcccc) => self.expires = Some(now + self.timeout()),
            (KR, 0xaaaa) => {
                self.unlocked = false;
                self.expires = self.expires.map(|_| now + self.timeout());
            }
            (PR, _) if self.unlocked => self.prescaler = value & 7,
            (RLR, _) if self.unlocked => {
                self.update = Some((value & 0xfff, now + UPDATE_CLOCKS * SECOND / self.oscillator_hz))
            }
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::board::LSI_HZ;

    #[test]
    fn it_expires_unless_it_is_fed_and_ignores_locked_writes() {
        let mut dog = Watchdog::new(LSI_HZ);
        dog.write(RLR, 7, 0);
        assert_eq!(dog.read(RLR, SECOND), 0xfff);
        for (offset, value) in [(KR, 0x5555), (PR, 1), (RLR, 399)] {
            dog.write(offset, value, 0);
        }
        let taken = 5 * SECOND / LSI_HZ;
        assert_eq!((dog.read(SR, taken - 1), dog.read(SR, taken)), (RVU, 0));
        dog.write(KR, 0xcccc, taken);
        // 400 counts of 8 clocks of 32 kHz are 100 ms.
        assert_eq!(dog.next_event(), Some(taken + SECOND / 10));
        dog.write(KR, 0xaaaa, taken + 1000);
        assert_eq!(dog.next_event(), Some(taken + 1000 + SECOND / 10));
    }
}
