//! USART3: bytes at the pace of the line (RM0090 section 30).

use std::collections::VecDeque;

use crate::time::{SECOND, Time};

const SR: usize = 0x00;
const DR: usize = 0x04;
const BRR: usize = 0x08;
const CR1: usize = 0x0c;

const ORE: u32 = 1 << 3;
const IDLE: u32 = 1 << 4;
const RXNE: u32 = 1 << 5;
const TC: u32 = 1 << 6;
const TXE: u32 = 1 << 7;

const RE: u32 = 1 << 2;
const TE: u32 = 1 << 3;
const UE: u32 = 1 << 13;

/// PCLK1 of 42 MHz.
const CLOCK: Time = SECOND / 42_000_000;

/// Bits of a character 8N1.
const BITS: Time = 10;

/// The transceiver and its line.
#[derive(Debug, Clone)]
pub struct Usart {
    words: [u32; 7],
    status: u32,
    received: u8,
    waiting: Option<u8>,
    /// Byte going out, and when it has left.
    shifting: Option<(u8, Time)>,
    /// Bytes on their way to the board, and when the first of them has arrived.
    coming: VecDeque<u8>,
    arrives: Option<Time>,
    /// When the line will have been silent for a character.
    silent: Option<Time>,
    /// Bytes that have left the board.
    pub sent: Vec<u8>,
}

impl Usart {
    /// After a reset: not enabled.
    pub fn new() -> Self {
        Usart {
            words: [0; 7],
            status: TXE | TC,
            received: 0,
            waiting: None,
            shifting: None,
            coming: VecDeque::new(),
            arrives: None,
            silent: None,
            sent: Vec::new(),
        }
    }

    fn enabled(&self, direction: u32) -> bool {
        self.words[CR1 / 4] & UE != 0 && self.words[CR1 / 4] & direction != 0
    }

    fn character(&self) -> Time {
        CLOCK * BITS * Time::from(self.words[BRR / 4].max(16))
    }

    /// Puts bytes on the line to the board, one after the other.
    pub fn feed(&mut self, bytes: &[u8], now: Time) {
        if !bytes.is_empty() && self.arrives.is_none() {
            self.arrives = Some(now + self.character());
            self.silent = None;
        }
        self.coming.extend(bytes);
    }

    /// When the next byte has arrived or left.
    pub fn next_event(&self) -> Option<Time> {
        [self.arrives, self.shifting.map(|(_, end)| end), self.silent].into_iter().flatten().min()
    }

    /// Lets happen what is due.
    pub fn sync(&mut self, now: Time) {
        while let Some((byte, end)) = self.shifting.filter(|(_, end)| *end <= now) {
            self.sent.push(byte);
            self.shifting = self.waiting.take().map(|next| (next, end + self.character()));
            self.status |= if self.shifting.is_some() { TXE } else { TXE | TC };
        }
        while let Some(at) = self.arrives.filter(|at| *at <= now) {
            let byte = self.coming.pop_front();
            if let Some(byte) = byte.filter(|_| self.enabled(RE)) {
                if self.status & RXNE != 0 {
                    // The byte before was not fetched: this one is lost.
                    self.status |= ORE;
                } else {
                    self.received = byte;
                    self.status |= RXNE;
                }
            }
            self.arrives = (!self.coming.is_empty()).then(|| at + self.character());
            self.silent = self.arrives.is_none().then(|| at + self.character());
        }
        if self.silent.is_some_and(|at| at <= now) {
            self.silent = None;
            self.status |= IDLE;
        }
    }

    /// True while the interrupt is asked for.
    pub fn line(&self) -> bool {
        let cr1 = self.words[CR1 / 4];
        let wanted = |flag: u32, enable: u32| self.status & flag != 0 && cr1 & 1 << enable != 0;
        wanted(IDLE, 4) || wanted(RXNE | ORE, 5) || wanted(TC, 6) || wanted(TXE, 7)
    }

    /// Value of a register.
    pub fn read(&mut self, offset: usize, now: Time) -> u32 {
        self.sync(now);
        match offset {
            SR => self.status,
            DR => {
                // The program has read SR before, which completes the clearing sequence of the error flags.
                self.status &= !(RXNE | ORE | IDLE);
                u32::from(self.received)
            }
            _ => self.words.get(offset / 4).copied().unwrap_or(0),
        }
    }

    /// Sets a register.
    pub fn write(&mut self, offset: usize, value: u32, now: Time) {
        self.sync(now);
        match offset {
            SR => self.status &= value | !(TC | RXNE),
            DR if self.enabled(TE) => {
                self.status &= !TC;
                if self.shifting.is_none() {
                    self.shifting = Some((value as u8, now + self.character()));
                } else {
                    self.waiting = Some(value as u8);
                    self.status &= !TXE;
                }
            }
            DR => {}
            _ => {
                if let Some(word) = self.words.get_mut(offset / 4) {
                    *word = value;
                }
            }
        }
    }
}

impl Default for Usart {
    fn default() -> Self {
        Usart::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A character of 1,000 units: 42 MHz over 12.5 is not whole, so the divider is taken for what it is.
    fn line() -> (Usart, Time) {
        let mut usart = Usart::new();
        usart.write(BRR, 365, 0);
        usart.write(CR1, UE | TE | RE, 0);
        let character = usart.character();
        // 115200 baud within the rounding of the divider, 1 of 365.
        assert!((character as f64 / (SECOND as f64 * 10.0 / 115_200.0) - 1.0).abs() < 1.0 / 365.0);
        (usart, character)
    }

    #[test]
    fn two_bytes_leave_one_after_the_other() {
        let (mut usart, character) = line();
        usart.write(DR, 1, 0);
        assert_eq!(usart.read(SR, 0) & (TXE | TC), TXE);
        usart.write(DR, 2, 0);
        assert_eq!(usart.read(SR, 0) & (TXE | TC), 0);
        assert_eq!(usart.read(SR, character) & (TXE | TC), TXE);
        assert_eq!(usart.read(SR, 2 * character) & (TXE | TC), TXE | TC);
        assert_eq!(usart.sent, [1, 2]);
    }

    #[test]
    fn a_byte_that_is_not_fetched_costs_the_next() {
        let (mut usart, character) = line();
        usart.feed(&[7, 8, 9], 0);
        assert_eq!(usart.read(SR, character - 1) & RXNE, 0);
        assert_eq!(usart.read(SR, 2 * character) & (RXNE | ORE), RXNE | ORE);
        assert_eq!(usart.read(DR, 2 * character), 7);
        assert_eq!(usart.read(DR, 3 * character), 9);
        assert_eq!(usart.read(SR, 3 * character) & IDLE, 0);
        assert_eq!(usart.read(SR, 4 * character) & IDLE, IDLE);
    }
}
