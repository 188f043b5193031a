//! RCC and PWR: clocks that are ready at once, and reset flags (RM0090 sections 5 and 7).

/// Why the chip was reset.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reset {
    /// Power came back, or had sagged below the brown-out level.
    Power,
    /// The supply sagged below the brown-out level and came back.
    BrownOut,
    /// The independent watchdog expired.
    Watchdog,
    /// The program asked for it.
    Software,
}

/// RCC registers; kept as written except for ready bits, the switch status and the reset flags.
#[derive(Debug, Clone)]
pub struct Rcc {
    words: [u32; 0x24],
    flags: u32,
    /// Injected fault: the 8 MHz clock does not come, or stops.
    pub external_dead: bool,
}

const CR: usize = 0x00;
const PLLCFGR: usize = 0x04;
const CFGR: usize = 0x08;
const CIR: usize = 0x0c;
const BDCR: usize = 0x70;
const CSR: usize = 0x74;

const HSION: u32 = 1;
const HSEON: u32 = 1 << 16;
const HSERDY: u32 = 1 << 17;
const CSSON: u32 = 1 << 19;

/// Flag of the clock security system, and the bit that clears it.
const CSSF: u32 = 1 << 7;
const CSSC: u32 = 1 << 23;

/// Reset flags of CSR.
const BORRSTF: u32 = 1 << 25;
const PINRSTF: u32 = 1 << 26;
const PORRSTF: u32 = 1 << 27;
const SFTRSTF: u32 = 1 << 28;
const IWDGRSTF: u32 = 1 << 29;
const RMVF: u32 = 1 << 24;

impl Rcc {
    /// After a reset; flags of earlier resets stay until the program clears them.
    pub fn new(cause: Reset, earlier: Option<&Rcc>) -> Self {
        // Every reset also pulls the reset pin.
        let flags = PINRSTF
            | match cause {
                Reset::Power => PORRSTF | BORRSTF,
                Reset::BrownOut => BORRSTF,
                Reset::Watchdog => IWDGRSTF,
                Reset::Software => SFTRSTF,
            };
        let kept = if cause == Reset::Power { 0 } else { earlier.map_or(0, |rcc| rcc.flags) };
        let mut words = [0; 0x24];
        words[CR / 4] = 0x83;
        words[PLLCFGR / 4] = 0x2400_3010;
        Rcc { words, flags: flags | kept, external_dead: earlier.is_some_and(|rcc| rcc.external_dead) }
    }

    /// Stops the 8 MHz clock, or lets it come back. A stop that the clock security system watches
    /// switches to the internal clock and sets its flag (RM0090 section 6.2.7).
    pub fn set_external_dead(&mut self, dead: bool) {
        self.external_dead = dead;
        if dead && self.words[CR / 4] & (HSEON | CSSON) == HSEON | CSSON {
            self.words[CR / 4] = (self.words[CR / 4] & !(HSEON | CSSON)) | HSION;
            self.words[CFGR / 4] &= !3;
            self.words[CIR / 4] |= CSSF;
        }
    }

    /// True while the clock security system asks for the non-maskable interrupt.
    pub fn nmi(&self) -> bool {
        self.words[CIR / 4] & CSSF != 0
    }

    /// Core clock, Hz.
    pub fn core_hz(&self) -> u64 {
        // The PLL is not computed: the image's own clocks are 168 MHz from it, or 16 MHz before (HSI).
        if self.words[CFGR / 4] & 3 == 2 { 168_000_000 } else { 16_000_000 }
    }

    /// Value of a register.
    pub fn read(&self, offset: usize) -> u32 {
        let word = self.words.get(offset / 4).copied().unwrap_or(0);
        match offset {
            // Every oscillator and PLL that is on (HSI, HSE, PLL, PLLI2S, PLLSAI) is ready: its next bit.
            CR => (word | (word & 0x1501_0001) << 1) & if self.external_dead { !HSERDY } else { !0 },
            CFGR => (word & !0xc) | (word & 3) << 2,
            BDCR => word | (word & 1) << 1,
            CSR => (word & 0x00ff_ffff) | (word & 1) << 1 | self.flags,
            _ => word,
        }
    }

    /// Sets a register.
    pub fn write(&mut self, offset: usize, value: u32) {
        if offset == CSR && value & RMVF != 0 {
            self.flags = 0;
        }
        if let Some(word) = self.words.get_mut(offset / 4) {
            *word = match offset {
                CSR => value & !RMVF,
                CIR if value & CSSC == 0 => (value & !CSSF) | (*word & CSSF),
                CIR => value & !(CSSC | CSSF),
                _ => value,
            };
        }
    }
}

/// Power control.
#[derive(Debug, Clone, Default)]
pub struct Pwr {
    cr: u32,
    /// The supply lies below the level of the voltage detector.
    pub supply_low: bool,
}

impl Pwr {
    /// Value of a register: voltage scaling and over-drive are ready as soon as they are wanted.
    pub fn read(&self, offset: usize) -> u32 {
        match offset {
            0 => self.cr,
            4 => 1 << 14 | (self.cr & 3 << 16) | u32::from(self.supply_is_seen_low()) << 2,
            _ => 0,
        }
    }

    /// Puts the register to its reset value.
    pub fn reset(&mut self) {
        self.cr = 0;
    }

    /// Output of the voltage detector.
    pub fn supply_is_seen_low(&self) -> bool {
        self.supply_low && self.cr & 1 << 4 != 0
    }

    /// Sets a register.
    pub fn write(&mut self, offset: usize, value: u32) {
        if offset == 0 {
            self.cr = value;
        }
    }
}
