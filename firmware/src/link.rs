//! The link's two ends: frames in, and a bounded queue of frames out.

use protocol::frame::{self, Decoder, Frame, FrameError, MAX_FRAME};
use protocol::message::Report;
use protocol::rescue;

/// The board's links.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LinkId {
    /// CDC-ACM on the user's USB port.
    Usb,
    /// USART3 to the ST-LINK's serial port.
    Uart,
}

impl LinkId {
    /// Both.
    pub const ALL: [LinkId; 2] = [LinkId::Usb, LinkId::Uart];
}

/// Bytes of the transmit queue: 40 ticks of telemetry.
pub const QUEUE_LEN: usize = 4096;

/// Bytes kept free for answers: telemetry is dropped before they are used up.
pub const RESERVE_LEN: usize = 4 * MAX_FRAME;

/// Frames waiting to be sent. Telemetry that does not fit is dropped and counted; nothing waits.
#[derive(Debug, Clone)]
pub struct Transmitter {
    ring: [u8; QUEUE_LEN],
    /// Next byte to send, and how many there are.
    from: usize,
    len: usize,
    seq: u16,
    /// Frames that were not queued for want of room.
    pub dropped: u32,
}

/// How a frame uses the queue.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Priority {
    /// Answers, verdicts and faults: may fill the queue.
    Answer,
    /// Telemetry: leaves [`RESERVE_LEN`] free.
    Telemetry,
}

impl Default for Transmitter {
    fn default() -> Self {
        Self::new()
    }
}

impl Transmitter {
    /// Empty queue.
    pub const fn new() -> Self {
        Transmitter { ring: [0; QUEUE_LEN], from: 0, len: 0, seq: 0, dropped: 0 }
    }

    /// Queues a report. Every report uses up a sequence number, dropped ones too, so the host counts the loss.
    pub fn report(&mut self, report: &Report, priority: Priority) {
        let mut buffer = [0; MAX_FRAME];
        let seq = self.next_seq();
        match frame::encode_report(report, seq, &mut buffer) {
            Ok(bytes) => self.queue(bytes, priority),
            Err(_) => self.dropped = self.dropped.saturating_add(1),
        }
    }

    /// Queues the answer to the rescue question.
    pub fn rescue(&mut self, answer: rescue::Answer) {
        let mut buffer = [0; MAX_FRAME];
        let seq = self.next_seq();
        match frame::encode_body(rescue::KIND, seq, &answer.to_bytes(), &mut buffer) {
            Ok(bytes) => self.queue(bytes, Priority::Answer),
            Err(_) => self.dropped = self.dropped.saturating_add(1),
        }
    }

    fn next_seq(&mut self) -> u16 {
        let seq = self.seq;
        self.seq = seq.wrapping_add(1);
        seq
    }

    fn queue(&mut self, bytes: &[u8], priority: Priority) {
        let reserve = match priority {
            Priority::Answer => 0,
            Priority::Telemetry => RESERVE_LEN,
        };
        if self.len + bytes.len() + reserve > QUEUE_LEN {
            self.dropped = self.dropped.saturating_add(1);
            return;
        }
        for byte in bytes {
            if let Some(slot) = self.ring.get_mut((self.from + self.len) % QUEUE_LEN) {
                *slot = *byte;
                self.len += 1;
            }
        }
    }

    /// Moves queued bytes into `out`; returns how many.
    pub fn take(&mut self, out: &mut [u8]) -> usize {
        let count = self.len.min(out.len());
        for slot in out.iter_mut().take(count) {
            *slot = self.ring.get(self.from).copied().unwrap_or(0);
            self.from = (self.from + 1) % QUEUE_LEN;
        }
        self.len -= count;
        count
    }

    /// Bytes waiting.
    pub const fn waiting(&self) -> usize {
        self.len
    }
}

/// Frames in; counts what is not one.
#[derive(Debug, Clone, Default)]
pub struct Receiver {
    decoder: Decoder,
    /// Frames that failed CRC or decoding.
    pub rejected: u32,
}

impl Receiver {
    /// Nothing received.
    pub const fn new() -> Self {
        Receiver { decoder: Decoder::new(), rejected: 0 }
    }

    /// Takes a byte; a frame when it completes one.
    pub fn push(&mut self, byte: u8) -> Option<Frame<'_>> {
        let rejected = &mut self.rejected;
        match self.decoder.push(byte)? {
            Ok(frame) => Some(frame),
            Err(FrameError::TooLong | FrameError::TooShort | FrameError::BadCobs | FrameError::BadCrc) => {
                *rejected = rejected.saturating_add(1);
                None
            }
        }
    }
}
