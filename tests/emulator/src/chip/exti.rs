//! External interrupt lines: masks, edges, pending bits (RM0090 section 12.3). Of the lines only
//! that of the voltage detector ever moves.

const IMR: usize = 0x00;
const RTSR: usize = 0x08;
const FTSR: usize = 0x0c;
const PR: usize = 0x14;

/// Line of the voltage detector.
pub const PVD_LINE: u32 = 16;

/// The registers and the levels of the lines.
#[derive(Debug, Clone, Copy, Default)]
pub struct Exti {
    words: [u32; 6],
    levels: u32,
}

impl Exti {
    /// Sets the level of a line; an edge that is asked for pends it.
    pub fn set_level(&mut self, line: u32, high: bool) {
        let bit = 1 << line;
        if high == (self.levels & bit != 0) {
            return;
        }
        self.levels ^= bit;
        let edges = self.words[if high { RTSR } else { FTSR } / 4];
        self.words[PR / 4] |= bit & edges;
    }

    /// True while a line asks for its interrupt.
    pub fn line(&self, line: u32) -> bool {
        self.words[PR / 4] & self.words[IMR / 4] & 1 << line != 0
    }

    /// Value of a register.
    pub fn read(&self, offset: usize) -> u32 {
        self.words.get(offset / 4).copied().unwrap_or(0)
    }

    /// Sets a register; pending bits are cleared by writing ones.
    pub fn write(&mut self, offset: usize, value: u32) {
        match self.words.get_mut(offset / 4) {
            Some(pending) if offset == PR => *pending &= !value,
            Some(word) => *word = value,
            None => {}
        }
    }
}
