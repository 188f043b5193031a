//! GPIO ports A to K (RM0090 section 8): outputs as the program sets them; inputs read low unless something drives them.

/// One port.
#[derive(Debug, Clone, Copy, Default)]
pub struct Port {
    words: [u32; 10],
    output: u32,
    /// Pins that the surroundings drive high.
    input: u32,
}

const MODER: usize = 0x00;
const ODR: usize = 0x14;
/// Levels of the pins.
pub const IDR: usize = 0x10;
const BSRR: usize = 0x18;

impl Port {
    /// True if the pin is a general-purpose output that is driven high.
    pub fn high(&self, pin: u32) -> bool {
        self.words[MODER / 4] >> (2 * pin) & 3 == 1 && self.output >> pin & 1 != 0
    }

    /// The pins of `levels` that are given to a peripheral (alternate function).
    pub fn alternate(&self, levels: u32) -> u32 {
        (0..16).filter(|pin| self.words[MODER / 4] >> (2 * pin) & 3 == 2).map(|pin| levels & 1 << pin).sum()
    }

    /// Drives a pin from outside, high or low.
    pub fn drive(&mut self, pin: u32, high: bool) {
        self.input = self.input & !(1 << pin) | u32::from(high) << pin;
    }

    /// Value of a register.
    pub fn read(&self, offset: usize) -> u32 {
        match offset {
            ODR => self.output,
            IDR => self.output | self.input,
            _ => self.words.get(offset / 4).copied().unwrap_or(0),
        }
    }

    /// Sets a register.
    pub fn write(&mut self, offset: usize, value: u32) {
        match offset {
            ODR => self.output = value & 0xffff,
            // Setting wins over resetting.
            BSRR => self.output = (self.output & !(value >> 16)) | (value & 0xffff),
            _ => {
                if let Some(word) = self.words.get_mut(offset / 4) {
                    *word = value;
                }
            }
        }
    }
}
