//! One link's side of the board: decoder, answers, telemetry, and whether its host speaks the same messages.

use super::FIRMWARE_VERSION;
use crate::link::{Priority, Receiver, Transmitter};
use crate::telemetry::TelemetryClock;
use protocol::PROTOCOL_VERSION;
use protocol::frame::Frame;
use protocol::message::{DecodeError, HelloRequest, Refusal, Refused, Report, Request, SCHEMA_HASH, is_known_schema};
use protocol::rescue;

/// What a link knows by itself. Nothing that arrives here changes another link.
#[derive(Debug, Clone, Default)]
pub struct Talk {
    receiver: Receiver,
    transmitter: Transmitter,
    /// The host was built from another message table.
    schema_mismatch: bool,
    /// The host knows all messages of this table, not only those of an earlier one.
    up_to_date: bool,
    telemetry: TelemetryClock,
}

/// A frame taken out of the decoder's buffer. Lives for one call on the stack, where its size does no harm.
#[allow(clippy::large_enum_variant)]
enum Incoming {
    Rescue,
    Request(Request),
    Refused { kind: u8, reason: Refusal },
    Nothing,
}

impl Talk {
    /// Takes a byte; a request with its sequence number when it completes one that may be carried out.
    pub fn push(&mut self, byte: u8) -> Option<(Request, u16)> {
        let frame = self.receiver.push(byte)?;
        let seq = frame.seq;
        match understand(&frame) {
            Incoming::Rescue => self.transmitter.rescue(rescue::Answer::of_this_build(FIRMWARE_VERSION)),
            Incoming::Request(request) if self.schema_mismatch && !matches!(request, Request::Hello(_)) => {
                self.refuse(request.kind(), seq, Refusal::SchemaMismatch);
            }
            Incoming::Request(request) => return Some((request, seq)),
            Incoming::Refused { kind, reason } => {
                self.receiver.rejected = self.receiver.rejected.saturating_add(1);
                self.refuse(kind, seq, reason);
            }
            Incoming::Nothing => self.receiver.rejected = self.receiver.rejected.saturating_add(1),
        }
        None
    }

    /// The host says who it is: compares its messages with ours, and starts telemetry if they agree.
    pub fn greeted(&mut self, hello: &HelloRequest) {
        self.schema_mismatch = hello.protocol_version != PROTOCOL_VERSION || !is_known_schema(hello.schema_hash);
        self.up_to_date = hello.schema_hash == SCHEMA_HASH;
        if !self.schema_mismatch {
            self.telemetry.set(1);
        }
    }

    /// True for a host that can be told of both halves by themselves.
    pub const fn knows_halves(&self) -> bool {
        self.up_to_date && !self.schema_mismatch
    }

    /// Telemetry every `divider`-th tick; 0 for none.
    pub fn set_telemetry(&mut self, divider: u8) {
        self.telemetry.set(divider);
    }

    /// One tick; true if a record is due.
    pub fn record_is_due(&mut self) -> bool {
        self.telemetry.step()
    }

    /// Queues a report.
    pub fn report(&mut self, report: &Report, priority: Priority) {
        self.transmitter.report(report, priority);
    }

    /// Queues a refusal.
    pub fn refuse(&mut self, of: u8, seq: u16, reason: Refusal) {
        self.report(&Report::Refused(Refused { of, seq, reason }), Priority::Answer);
    }

    /// Moves bytes for the host into `out`; returns how many.
    pub fn take_transmit(&mut self, out: &mut [u8]) -> usize {
        self.transmitter.take(out)
    }

    /// Frames that failed CRC or decoding.
    pub const fn rejected(&self) -> u32 {
        self.receiver.rejected
    }

    /// Frames that were not queued for want of room.
    pub const fn dropped(&self) -> u32 {
        self.transmitter.dropped
    }
}

fn understand(frame: &Frame<'_>) -> Incoming {
    if frame.kind == rescue::KIND {
        return if frame.body.starts_with(&rescue::QUESTION) { Incoming::Rescue } else { Incoming::Nothing };
    }
    match Request::decode(frame.kind, frame.body) {
        Ok(request) => Incoming::Request(request),
        Err(DecodeError::Unknown { kind }) => Incoming::Refused { kind, reason: Refusal::Unknown },
        Err(DecodeError::Malformed { kind }) => Incoming::Refused { kind, reason: Refusal::Malformed },
    }
}
