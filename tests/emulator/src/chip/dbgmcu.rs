//! Debug support: which chip, and what stops while the core is halted (RM0090 sections 38.6.1 and
//! 38.16).

const IDCODE: usize = 0x00;
const CR: usize = 0x04;
const APB1_FZ: usize = 0x08;
const APB2_FZ: usize = 0x0c;

/// STM32F42x and F43x.
const DEVICE: u32 = 0x419;

/// The registers; a system reset does not touch them.
#[derive(Debug, Clone)]
pub struct Dbgmcu {
    /// REV_ID: 0x1007 is revision 1, 0x2001 revision 3, 0x2003 revision 5.
    pub revision: u16,
    words: [u32; 4],
}

impl Dbgmcu {
    /// As after power on, of a chip of revision 5.
    pub fn new() -> Self {
        Dbgmcu { revision: 0x2003, words: [0; 4] }
    }

    /// Value of a register.
    pub fn read(&self, offset: usize) -> u32 {
        match offset {
            IDCODE => u32::from(self.revision) << 16 | DEVICE,
            CR | APB1_FZ | APB2_FZ => self.words[offset / 4],
            _ => 0,
        }
    }

    /// Sets a register.
    pub fn write(&mut self, offset: usize, value: u32) {
        if matches!(offset, CR | APB1_FZ | APB2_FZ) {
            self.words[offset / 4] = value;
        }
    }

    /// Power has come back.
    pub fn power_on(&mut self) {
        self.words = [0; 4];
    }
}
