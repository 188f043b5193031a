//! ADC1: regular scans started by software or TIM3, each conversion a DMA request (RM0090 section 13).

use crate::time::{SECOND, Time};

const SR: usize = 0x00;
const CR2: usize = 0x08;
const SMPR1: usize = 0x0c;
const SMPR2: usize = 0x10;
const SQR1: usize = 0x2c;
const SQR3: usize = 0x34;
const DR: usize = 0x4c;

const EOC: u32 = 1 << 1;
const STRT: u32 = 1 << 4;
const OVR: u32 = 1 << 5;

const ADON: u32 = 1;
const DMA: u32 = 1 << 8;
const SWSTART: u32 = 1 << 30;

/// External trigger 8 is TIM3_TRGO (RM0090 table 70).
const TIM3_TRGO: u32 = 8;

/// Clock of the converter: PCLK2 of 84 MHz over 4.
const CLOCK: Time = SECOND / 21_000_000;

/// Clocks of the sample times of SMPR, and of the conversion itself at 12 bit.
const SAMPLE: [Time; 8] = [3, 15, 28, 56, 84, 112, 144, 480];
const CONVERT: Time = 12;

/// Inputs of the converter.
pub const INPUTS: usize = 19;

/// The converter.
#[derive(Debug, Clone, Default)]
pub struct Adc {
    words: [u32; 0x14],
    status: u32,
    /// Codes of the scan in progress, and when it ends.
    scan: Option<(Vec<u16>, Time)>,
    /// Requests that DMA did not serve, since the reset.
    pub overruns: u64,
    /// Injected fault: triggers and starts are ignored.
    pub dead: bool,
}

impl Adc {
    /// Channels of a scan, in order.
    fn sequence(&self) -> impl Iterator<Item = usize> + '_ {
        let length = (self.words[SQR1 / 4] >> 20 & 0xf) as usize + 1;
        // Only the first six places (SQR3) are used by the image.
        (0..length.min(6)).map(|i| (self.words[SQR3 / 4] >> (5 * i) & 0x1f) as usize)
    }

    fn duration(&self) -> Time {
        self.sequence().map(|channel| CLOCK * (CONVERT + self.sample_clocks(channel))).sum()
    }

    fn sample_clocks(&self, channel: usize) -> Time {
        let (word, at) = if channel <= 9 { (SMPR2, channel) } else { (SMPR1, channel - 10) };
        SAMPLE[(self.words[word / 4] >> (3 * at) & 7) as usize]
    }

    /// True if an update of TIM3 starts a scan now.
    pub fn is_triggered(&self) -> bool {
        let cr2 = self.words[CR2 / 4];
        let armed = cr2 >> 28 & 3 == 1 && cr2 >> 24 & 0xf == TIM3_TRGO;
        armed && self.can_start()
    }

    fn can_start(&self) -> bool {
        // A converter that overran waits until the flag is cleared.
        self.words[CR2 / 4] & ADON != 0 && self.scan.is_none() && self.status & OVR == 0 && !self.dead
    }

    /// Starts a scan of voltages given as codes, not yet rounded.
    pub fn start(&mut self, now: Time, voltages: &[f64; INPUTS]) {
        // The first transition lies at half a code (STM32F429 data sheet): a code stands for the voltages about its own.
        let code = |channel: usize| voltages.get(channel).map_or(0, |v| v.round().clamp(0.0, 4095.0) as u16);
        let codes = self.sequence().map(code).collect();
        self.status |= STRT;
        self.scan = Some((codes, now + self.duration()));
    }

    /// When the scan in progress ends.
    pub fn next_event(&self) -> Option<Time> {
        self.scan.as_ref().map(|(_, end)| *end)
    }

    /// Codes of a scan that has ended, one DMA request each; empty if none, or if DMA is off.
    pub fn finish(&mut self, now: Time) -> Vec<u16> {
        match self.scan.take_if(|(_, end)| *end <= now) {
            Some((codes, _)) => {
                self.status |= EOC;
                self.words[DR / 4] = codes.last().copied().unwrap_or(0).into();
                if self.words[CR2 / 4] & DMA != 0 { codes } else { Vec::new() }
            }
            None => Vec::new(),
        }
    }

    /// A request that the DMA stream did not serve.
    pub fn overrun(&mut self) {
        self.status |= OVR;
        self.overruns += 1;
    }

    /// Value of a register.
    pub fn read(&mut self, offset: usize) -> u32 {
        match offset {
            SR => self.status,
            DR => {
                self.status &= !EOC;
                self.words[DR / 4]
            }
            _ => self.words.get(offset / 4).copied().unwrap_or(0),
        }
    }

    /// Sets a register; true if the program starts a scan by it.
    pub fn write(&mut self, offset: usize, value: u32) -> bool {
        match offset {
            SR => self.status &= value,
            CR2 => {
                self.words[CR2 / 4] = value & !SWSTART;
                if value & ADON == 0 {
                    self.scan = None;
                }
                return value & SWSTART != 0 && self.can_start();
            }
            _ => {
                if let Some(word) = self.words.get_mut(offset / 4) {
                    *word = value;
                }
            }
        }
        false
    }
}
