//! Interrupt controller and the system control block's registers that the image uses (ARMv7-M ARM, B3).

/// Number of the non-maskable interrupt.
pub const NMI: u32 = 2;

/// Number of the HardFault exception.
pub const HARD_FAULT: u32 = 3;

/// Exception number of external interrupt 0.
const EXTERNAL: u32 = 16;

/// Priority of thread mode: anything preempts it.
const THREAD: i32 = 256;

/// Pending, enabled and active interrupts.
#[derive(Debug, Clone)]
pub struct Nvic {
    enabled: u128,
    pending: u128,
    lines: u128,
    priorities: [u8; 128],
    /// Exceptions being served, innermost last.
    active: Vec<u32>,
    /// The line of the non-maskable interrupt, which the clock security system holds.
    pub nmi: bool,
    vector_table: u32,
    words: [u32; 0x40],
    /// The program asked for a reset.
    pub reset_requested: bool,
}

const ICSR: usize = 0xd04;
const VTOR: usize = 0xd08;
const AIRCR: usize = 0xd0c;
const CCR: usize = 0xd14;
const CFSR: usize = 0xd28;

impl Nvic {
    /// After a reset: all off.
    pub fn new() -> Self {
        Nvic {
            enabled: 0,
            pending: 0,
            lines: 0,
            priorities: [0; 128],
            active: Vec::new(),
            nmi: false,
            vector_table: 0,
            words: [0; 0x40],
            reset_requested: false,
        }
    }

    /// Where the vectors are.
    pub fn vector_table(&self) -> u32 {
        self.vector_table
    }

    /// Takes the levels of the interrupt lines; a line that rises pends its interrupt.
    pub fn set_lines(&mut self, lines: u128) {
        self.pending |= lines & !self.lines;
        self.lines = lines;
    }

    fn priority(&self, exception: u32) -> i32 {
        match exception {
            NMI => -2,
            HARD_FAULT => -1,
            // Four bits are implemented.
            n => i32::from(self.priorities[(n - EXTERNAL) as usize] & 0xf0),
        }
    }

    /// Priority at which the core runs; lower is more urgent.
    pub fn running(&self) -> i32 {
        self.active.iter().map(|e| self.priority(*e)).min().unwrap_or(THREAD)
    }

    /// The exception that preempts what runs, if there is one.
    pub fn deliverable(&self) -> Option<u32> {
        if self.nmi && self.running() > self.priority(NMI) {
            return Some(NMI);
        }
        let mut waiting = self.pending & self.enabled;
        let mut best: Option<(i32, u32)> = None;
        while waiting != 0 {
            let exception = EXTERNAL + waiting.trailing_zeros();
            let candidate = (self.priority(exception), exception);
            best = Some(best.map_or(candidate, |b| b.min(candidate)));
            waiting &= waiting - 1;
        }
        best.filter(|(priority, _)| *priority < self.running()).map(|(_, exception)| exception)
    }

    /// An exception begins to be served.
    pub fn enter(&mut self, exception: u32) {
        if exception >= EXTERNAL {
            self.pending &= !(1 << (exception - EXTERNAL));
        }
        self.active.push(exception);
    }

    /// Notes in the fault status register why a fault is entered.
    pub fn set_fault_status(&mut self, bits: u32) {
        self.words[(CFSR - 0xd00) / 4] |= bits;
    }

    /// The innermost exception has been served; a line that is still high pends it again.
    pub fn leave(&mut self) -> Option<u32> {
        let left = self.active.pop()?;
        if left >= EXTERNAL {
            self.pending |= self.lines & 1 << (left - EXTERNAL);
        }
        Some(left)
    }

    /// Number of nested exceptions.
    pub fn depth(&self) -> usize {
        self.active.len()
    }

    /// The exception being served; 0 in thread mode.
    pub fn serving(&self) -> u32 {
        self.active.last().copied().unwrap_or(0)
    }

    /// Value of a register, by offset from 0xE000E000.
    pub fn read(&self, offset: usize) -> u32 {
        let part = |bits: u128| (bits >> (32 * (offset % 16 / 4))) as u32;
        match offset {
            0x100..0x110 | 0x180..0x190 => part(self.enabled),
            0x200..0x210 | 0x280..0x290 => part(self.pending),
            0x300..0x310 => {
                part(self.active.iter().filter(|e| **e >= EXTERNAL).fold(0, |a, e| a | 1 << (e - EXTERNAL)))
            }
            0x400..0x480 => u32::from_le_bytes(std::array::from_fn(|i| self.priorities[(offset - 0x400) + i])),
            ICSR => self.serving(),
            VTOR => self.vector_table,
            AIRCR => 0xfa05_0000,
            CCR => 1 << 9,
            0xd00..0xe00 => self.words[(offset - 0xd00) / 4],
            _ => 0,
        }
    }

    /// Sets a register, by offset from 0xE000E000.
    pub fn write(&mut self, offset: usize, value: u32) {
        let bits = u128::from(value) << (32 * (offset % 16 / 4));
        match offset {
            0x100..0x110 => self.enabled |= bits,
            0x180..0x190 => self.enabled &= !bits,
            0x200..0x210 => self.pending |= bits,
            // A line that is high pends its interrupt again at once.
            0x280..0x290 => self.pending &= !bits | self.lines,
            0x400..0x480 => {
                for (i, byte) in value.to_le_bytes().into_iter().enumerate() {
                    self.priorities[offset - 0x400 + i] = byte;
                }
            }
            VTOR => self.vector_table = value & !0x7f,
            AIRCR if value >> 16 == 0x05fa => self.reset_requested = value & 4 != 0,
            0xf00 => self.pending |= 1 << (value & 0x7f),
            0xd00..0xe00 => self.words[(offset - 0xd00) / 4] = value,
            _ => {}
        }
    }
}

impl Default for Nvic {
    fn default() -> Self {
        Nvic::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_more_urgent_interrupt_preempts_and_a_high_line_comes_back() {
        let mut nvic = Nvic::new();
        nvic.write(0x100, 1 << 5 | 1 << 7);
        nvic.write(0x404, 0x60 << 8 | 0x40 << 24);
        assert_eq!(nvic.deliverable(), None);
        nvic.set_lines(1 << 5);
        assert_eq!(nvic.deliverable(), Some(21));
        nvic.enter(21);
        assert_eq!(nvic.deliverable(), None);
        nvic.write(0x200, 1 << 7);
        assert_eq!(nvic.deliverable(), Some(23));
        nvic.enter(23);
        assert_eq!((nvic.leave(), nvic.leave()), (Some(23), Some(21)));
        // Nobody lowered the line of interrupt 5.
        assert_eq!(nvic.deliverable(), Some(21));
    }
}
