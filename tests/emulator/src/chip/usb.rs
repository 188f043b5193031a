//! USB OTG FS without a cable: the driver finds its core idle, and no host ever comes.

use std::collections::BTreeMap;

const GRSTCTL: usize = 0x10;
const CID: usize = 0x3c;
const GINTSTS: usize = 0x14;

/// The registers as they were written.
#[derive(Debug, Clone, Default)]
pub struct Usb {
    words: BTreeMap<usize, u32>,
}

impl Usb {
    /// Value of a register.
    pub fn read(&self, offset: usize) -> u32 {
        match offset {
            // Idle, and every reset and flush done.
            GRSTCTL => 1 << 31,
            // Core of the STM32F4 (RM0090, 34.16.2).
            CID => 0x1200,
            GINTSTS => 0,
            _ => self.words.get(&offset).copied().unwrap_or(0),
        }
    }

    /// Sets a register.
    pub fn write(&mut self, offset: usize, value: u32) {
        self.words.insert(offset, value);
    }
}
