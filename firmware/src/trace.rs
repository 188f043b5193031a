//! What the last run left behind: its latest changes of state and why it ended, in RAM that a reset
//! does not clear.
//!
//! All of it is words, so that whatever RAM holds after power has come can be read; magic number
//! and CRC-32 tell a record from noise. A run that ended without a reason of its own (a hang, the
//! reset pin) leaves its changes alone.

use heapless::{String, Vec};
use protocol::frame::CRC32;
use protocol::message::{CHANGES, FILE_LEN, LastRun, RunEnd, State, StateChange};

/// "PLPT", and the layout's version below it.
const MAGIC: u32 = 0x504c_5401;

/// Places of the words: magic, changes so far, changes (time in ms and state), kind of the end, its
/// numbers, length and bytes of its text, CRC.
const COUNT: usize = 1;
const RING: usize = 2;
const KIND: usize = RING + 2 * CHANGES;
const NUMBERS: usize = KIND + 1;
const TEXT_LEN: usize = NUMBERS + 3;
const TEXT: usize = TEXT_LEN + 1;
const CRC: usize = TEXT + FILE_LEN / 4;
/// Words of a record.
pub const WORDS: usize = CRC + 1;

/// States by their number in a record.
const STATES: [State; 6] = [State::Idle, State::Approach, State::Contact, State::Retract, State::Display, State::Fault];

/// Why a run ended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum End {
    /// A panic and its place.
    Panic {
        /// Source file, the last [`FILE_LEN`] bytes of its path.
        file: String<FILE_LEN>,
        /// Line.
        line: u32,
    },
    /// A HardFault.
    HardFault {
        /// Program counter of the frame that was pushed.
        pc: u32,
        /// Link register of the same frame.
        lr: u32,
        /// Configurable fault status register (ARMv7-M ARM, B3.2.15).
        cfsr: u32,
    },
    /// The 8 MHz clock stopped.
    ClockLost,
    /// The 3.3 V supply sagged.
    SupplyLow,
    /// An interrupt or exception without a handler.
    Interrupt {
        /// Its number; exceptions of the core are negative.
        number: i32,
    },
}

impl End {
    /// The end by a panic at a place.
    pub fn panic(file: &str, line: u32) -> Self {
        let from = (file.len().saturating_sub(FILE_LEN)..=file.len()).find(|at| file.is_char_boundary(*at));
        let tail = from.and_then(|at| file.get(at..)).unwrap_or("");
        End::Panic { file: String::try_from(tail).unwrap_or_default(), line }
    }
}

/// What a run left behind.
#[derive(Debug, Clone, PartialEq)]
pub struct Last {
    /// Why it ended; `None` if it was reset without knowing why.
    pub end: Option<End>,
    /// Its latest changes of state, oldest first.
    pub changes: Vec<StateChange, CHANGES>,
}

impl From<&Last> for LastRun {
    fn from(last: &Last) -> Self {
        let mut run = LastRun { known: true, ..LastRun::NONE };
        run.end = match &last.end {
            None => RunEnd::Unknown,
            Some(End::Panic { file, line }) => {
                run.file = file.bytes().collect();
                RunEnd::Panic { line: *line }
            }
            Some(End::HardFault { pc, lr, cfsr }) => RunEnd::HardFault { pc: *pc, lr: *lr, cfsr: *cfsr },
            Some(End::ClockLost) => RunEnd::ClockLost,
            Some(End::SupplyLow) => RunEnd::SupplyLow,
            Some(End::Interrupt { number }) => RunEnd::Interrupt { number: *number as u32 },
        };
        run.changes = last.changes.clone();
        run
    }
}

/// The record as it lies in RAM. Every content of the words is allowed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(transparent)]
pub struct Trace([u32; WORDS]);

impl Trace {
    /// No record.
    pub const EMPTY: Trace = Trace([0; WORDS]);

    /// What lay in RAM, e.g. as a debug probe reads it.
    pub const fn from_words(words: [u32; WORDS]) -> Self {
        Trace(words)
    }

    /// At start: takes what the last run left, if there is a whole record, and begins a new one.
    pub fn begin(&mut self) -> Option<Last> {
        let whole = self.0[0] == MAGIC && self.0[CRC] == self.crc();
        let last = whole.then(|| Last { end: self.read_end(), changes: self.read_changes() });
        self.0 = Trace::EMPTY.0;
        self.0[0] = MAGIC;
        self.seal();
        last
    }

    /// Notes a change of state.
    pub fn change(&mut self, change: StateChange) {
        let at = RING + 2 * (self.0[COUNT] as usize % CHANGES);
        self.0[at] = change.time_ms;
        self.0[at + 1] = change.state as u32;
        self.0[COUNT] = self.0[COUNT].wrapping_add(1);
        self.seal();
    }

    /// Notes why the run ends.
    pub fn end(&mut self, end: &End) {
        let (kind, numbers, text) = match end {
            End::Panic { file, line } => (1, [*line, 0, 0], file.as_str()),
            End::HardFault { pc, lr, cfsr } => (2, [*pc, *lr, *cfsr], ""),
            End::ClockLost => (3, [0; 3], ""),
            End::SupplyLow => (4, [0; 3], ""),
            End::Interrupt { number } => (5, [*number as u32, 0, 0], ""),
        };
        self.0[KIND] = kind;
        self.0[NUMBERS..TEXT_LEN].copy_from_slice(&numbers);
        self.0[TEXT_LEN] = text.len() as u32;
        for (word, bytes) in self.0[TEXT..CRC].iter_mut().zip(text.as_bytes().chunks(4)) {
            *word = bytes.iter().rev().fold(0, |word, byte| word << 8 | u32::from(*byte));
        }
        self.seal();
    }

    fn read_end(&self) -> Option<End> {
        let [a, b, c] = [self.0[NUMBERS], self.0[NUMBERS + 1], self.0[NUMBERS + 2]];
        match self.0[KIND] {
            1 => {
                let bytes: Vec<u8, FILE_LEN> = self.0[TEXT..CRC].iter().flat_map(|word| word.to_le_bytes()).collect();
                let text = bytes.get(..self.0[TEXT_LEN] as usize)?;
                Some(End::panic(core::str::from_utf8(text).ok()?, a))
            }
            2 => Some(End::HardFault { pc: a, lr: b, cfsr: c }),
            3 => Some(End::ClockLost),
            4 => Some(End::SupplyLow),
            5 => Some(End::Interrupt { number: a as i32 }),
            _ => None,
        }
    }

    fn read_changes(&self) -> Vec<StateChange, CHANGES> {
        let count = self.0[COUNT] as usize;
        let kept = (count.saturating_sub(CHANGES)..count).filter_map(|number| {
            let at = RING + 2 * (number % CHANGES);
            let state = STATES.get(self.0[at + 1] as usize)?;
            Some(StateChange { time_ms: self.0[at], state: *state })
        });
        kept.collect()
    }

    fn crc(&self) -> u32 {
        let mut digest = CRC32.digest();
        for word in &self.0[..CRC] {
            digest.update(&word.to_le_bytes());
        }
        digest.finalize()
    }

    fn seal(&mut self) {
        self.0[CRC] = self.crc();
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn begun() -> Trace {
        let mut trace = Trace::EMPTY;
        assert_eq!(trace.begin(), None);
        trace
    }

    #[test]
    fn noise_and_a_record_with_any_bit_changed_are_no_record() {
        let noise: [u32; WORDS] = core::array::from_fn(|i| (i as u32).wrapping_mul(2_654_435_761));
        assert_eq!(Trace(noise).begin(), None);
        let mut trace = begun();
        trace.change(StateChange { time_ms: 5, state: State::Display });
        for bit in 0..32 * WORDS {
            let mut broken = trace;
            broken.0[bit / 32] ^= 1 << (bit % 32);
            assert_eq!(broken.begin(), None, "bit {bit}");
        }
        assert!(trace.begin().is_some());
    }

    #[test]
    fn every_end_is_told_once_and_after_it_the_record_is_new() {
        let ends = [
            End::panic("firmware/src/board/mod.rs", 42),
            End::HardFault { pc: 0x0800_1234, lr: 0xffff_fff9, cfsr: 1 << 9 },
            End::ClockLost,
            End::SupplyLow,
            End::Interrupt { number: -2 },
        ];
        for end in ends {
            let mut trace = begun();
            trace.end(&end);
            assert_eq!(trace.begin().unwrap().end, Some(end));
            assert_eq!(trace.begin().unwrap(), Last { end: None, changes: Vec::new() });
        }
    }

    #[test]
    fn the_latest_sixteen_changes_are_kept_in_order() {
        let mut trace = begun();
        for number in 0..40_u32 {
            trace.change(StateChange { time_ms: 20 * number, state: STATES[number as usize % STATES.len()] });
        }
        let last = trace.begin().unwrap();
        let times: std::vec::Vec<u32> = last.changes.iter().map(|change| change.time_ms).collect();
        assert_eq!(times, (24..40).map(|number| 20 * number).collect::<std::vec::Vec<_>>());
        assert_eq!(last.changes[0].state, STATES[24 % STATES.len()]);
        assert_eq!(last.end, None);
    }

    #[test]
    fn a_long_path_keeps_its_end_and_splits_no_character() {
        let End::Panic { file, .. } = End::panic(&std::format!("{}/board.rs", "\u{e4}".repeat(60)), 1) else {
            unreachable!()
        };
        // 48 bytes: nine of the name, then whole characters of two bytes.
        assert_eq!(file.as_str(), std::format!("{}/board.rs", "\u{e4}".repeat(19)));
        assert_eq!(End::panic("a.rs", 7), End::Panic { file: String::try_from("a.rs").unwrap(), line: 7 });
    }

    #[test]
    fn every_state_has_its_number() {
        for (number, state) in STATES.into_iter().enumerate() {
            // No arm for a new state: it does not compile before it has a number.
            match state {
                State::Idle | State::Approach | State::Contact | State::Retract | State::Display | State::Fault => {}
            }
            assert_eq!(state as usize, number);
        }
    }
}
