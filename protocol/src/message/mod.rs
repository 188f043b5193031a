//! The interface between host and board as one table.
//!
//! Every message has a number that never changes and is never reused; new messages are appended.
//! Requests (host to board) are below `0x80`, reports (board to host) from `0x80` on. Every request is
//! answered by the report named beside it, or by [`Refused`].

mod board;
mod halves;
mod identification;
mod last_run;
mod setup;
mod table;
mod telemetry;

pub use board::{
    Build, CalibrationState, Fitted, Hello, HelloRequest, Holder, Mode, ModeRequest, ResetCause, State, Status,
};
pub use halves::{
    Curve, DisplayMode, DisplayRequest, DisplayState, Halves, PalpationMode, PalpationRequest, Parts, Rule,
};
pub use identification::{Estimate, Outcome, Recognition, Verdict};
pub use last_run::{CHANGES, FILE_LEN, LastRun, RunEnd, StateChange};
pub use setup::{Actuator, Calibration, Gains, LoadCell, ProbePosition, ResistiveSensor, Surface};
pub use table::{CHUNK_LEN, Slot, TableBegin, TableChunk, TableState};
pub use telemetry::{FaultReport, Raw, Shown, Telemetry};

use crate::wire::{FNV_BASIS, Wire, fold, fold_number, messages, wire};

wire! {
    /// No content.
    pub struct Empty {}
    /// The request was carried out.
    pub struct Accepted {
        /// Number of the request's kind.
        pub of: u8,
        /// Sequence number of the request.
        pub seq: u16,
    }
    /// The request was not carried out; nothing has changed.
    pub struct Refused {
        /// Number of the request's kind.
        pub of: u8,
        /// Sequence number of the request.
        pub seq: u16,
        /// Why.
        pub reason: Refusal,
    }
    /// Every how many control ticks telemetry is sent.
    pub struct TelemetryRate {
        /// 0: none; 1: every tick (50 Hz); n: every n-th.
        pub divider: u8,
    }
}

wire! {
    /// Why a request was refused.
    pub enum Refusal {
        /// This version does not know the message.
        Unknown,
        /// The body does not decode.
        Malformed,
        /// Not in this mode: outputs are on, or a palpation is running.
        Busy,
        /// A fault is latched; clear it first.
        Faulted,
        /// The fault's cause is still present.
        CauseRemains,
        /// No valid table is active.
        NoTable,
        /// A value is outside the board's own limits.
        OutOfRange,
        /// A table chunk that does not continue the upload.
        OutOfOrder,
        /// The table is larger than a slot.
        TooLarge,
        /// The table does not pass its checks.
        TableRejected,
        /// Flash erase or write failed.
        FlashFailed,
        /// Host and board were built from different message tables.
        SchemaMismatch,
        /// Another link holds the motion.
        Held,
        /// The stop button is pressed.
        Stopped,
        /// The stored calibration cannot be read: a tare would hide it behind the default.
        CalibrationLost,
        /// No palpator is fitted.
        NoPalpator,
        /// Neither actuator nor coil of the display are fitted.
        NoDisplay,
        /// The table has no library, or no axes of mu and alpha, to interpolate between its materials.
        NotBetween,
    }
}

impl Refusal {
    /// The reason in words, with what to do.
    pub const fn describe(self) -> &'static str {
        match self {
            Refusal::Unknown => "the board does not know this message: its firmware is older than this tool",
            Refusal::Malformed => "the board could not decode the message",
            Refusal::Busy => "the board is busy: set mode idle first",
            Refusal::Faulted => "a fault is latched: clear it first",
            Refusal::CauseRemains => "the cause of the fault is still present",
            Refusal::NoTable => "the board holds no valid table: upload one",
            Refusal::OutOfRange => "a value is outside the board's own limits",
            Refusal::OutOfOrder => "the table chunk does not continue the upload",
            Refusal::TooLarge => "the table is larger than the board's slot",
            Refusal::TableRejected => "the table did not pass the board's checks",
            Refusal::FlashFailed => "the board could not write its flash",
            Refusal::SchemaMismatch => "tool and firmware were built from different message tables",
            Refusal::Stopped => "the board's stop button is pressed: release it",
            Refusal::Held => "another link holds the board: stop it there, or set mode idle from here first",
            Refusal::CalibrationLost => {
                "the stored calibration cannot be read: load one first (palpate board calibrate --load FILE)"
            }
            Refusal::NoPalpator => "no palpator is fitted to this board (palpate board fit)",
            Refusal::NoDisplay => {
                "neither actuator nor coil, or not the one that is asked for, are fitted to this board (palpate board fit)"
            }
            Refusal::NotBetween => {
                "the table has no library, or no axes of mu and alpha, to find a place between its materials"
            }
        }
    }
}

messages! {
    SCHEMA_HASH;
    /// From host to board.
    pub enum Request {
        /// Who are you? Answered by [`Report::Hello`].
        0x01 Hello(HelloRequest),
        /// Answered by [`Report::Status`]. Also keeps the link alive.
        0x02 Status(Empty),
        /// Answered by [`Report::Accepted`]. Any link may ask for idle; while a link holds the motion, only
        /// that one may ask for more.
        0x03 SetMode(ModeRequest),
        /// PID gains. Answered by [`Report::Accepted`].
        0x04 SetGains(Gains),
        /// Answered by [`Report::Calibration`].
        0x05 GetCalibration(Empty),
        /// Answered by [`Report::Accepted`]; only in idle.
        0x06 SetCalibration(Calibration),
        /// Takes the load cell's present reading as zero. Answered by [`Report::Accepted`]; only in idle.
        0x07 Tare(Empty),
        /// Answered by [`Report::Accepted`].
        0x08 ClearFaults(Empty),
        /// Answered by [`Report::Accepted`].
        0x09 SetTelemetry(TelemetryRate),
        /// For the next mode that this link asks for. Answered by [`Report::Accepted`]; only in idle.
        0x0a ExpectSurface(Surface),
        /// Stored with the calibration. Answered by [`Report::Accepted`]; only in idle.
        0x0b SetFitted(Fitted),
        /// Palpation, whatever the display does. Answered by [`Report::Accepted`]; otherwise as
        /// [`Request::SetMode`].
        0x0c SetPalpation(PalpationRequest),
        /// Display, whatever palpation does. Answered by [`Report::Accepted`]; otherwise as
        /// [`Request::SetMode`].
        0x0d SetDisplay(DisplayRequest),
        /// Answered by [`Report::Halves`].
        0x0e GetHalves(Empty),
        /// Until the next reset. Answered by [`Report::Accepted`]; only in idle.
        0x0f SetActuator(Actuator),
        /// Erases the inactive slot. Answered by [`Report::TableState`]; only in idle.
        0x10 TableBegin(TableBegin),
        /// Answered by [`Report::TableState`].
        0x11 TableChunk(TableChunk),
        /// Checks and activates the uploaded table. Answered by [`Report::TableState`].
        0x12 TableCommit(Empty),
        /// Answered by [`Report::TableState`]. After a lost link: where to continue.
        0x13 TableQuery(Empty),
        /// Why the run before this one ended. Answered by [`Report::LastRun`].
        0x14 GetLastRun(Empty),
    }
    /// From board to host.
    pub enum Report {
        /// Who the board is.
        0x81 Hello(Hello),
        /// Mode, state, faults, counters.
        0x82 Status(Status),
        /// A request was carried out.
        0x83 Accepted(Accepted),
        /// A request was refused.
        0x84 Refused(Refused),
        /// One control tick.
        0x85 Telemetry(Telemetry),
        /// The end of a palpation.
        0x86 Verdict(Verdict),
        /// A fault was latched.
        0x87 Fault(FaultReport),
        /// The upload, and the active table.
        0x88 TableState(TableState),
        /// The calibration in use.
        0x89 Calibration(Calibration),
        /// Parameters with standard errors, right before the verdict.
        0x8a Estimate(Estimate),
        /// Why the run before this one ended.
        0x8b LastRun(LastRun),
        /// What both halves do.
        0x8c Halves(Halves),
    }
}

/// Schema hashes of earlier tables of this version. The present table only adds to them: whoever was built
/// from one of these is understood, and is told nothing that came later.
pub const EARLIER: [u64; 3] = [0x8504_e3d0_9c49_3aeb, 0xd7c4_0a1b_9ea6_51a0, 0xac16_63a6_845a_7696];

/// True for the present table and for those that it adds to.
pub fn is_known_schema(hash: u64) -> bool {
    hash == SCHEMA_HASH || EARLIER.contains(&hash)
}

/// Why bytes with a valid CRC are not a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum DecodeError {
    /// No message has this number: the other side is newer, or speaks another direction.
    Unknown {
        /// The number.
        kind: u8,
    },
    /// The body is not one of this kind.
    Malformed {
        /// The message's number.
        kind: u8,
    },
}

impl core::fmt::Display for DecodeError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            DecodeError::Unknown { kind } => write!(
                f,
                "unknown message 0x{kind:02x}: the other side speaks a newer protocol than version {}",
                crate::PROTOCOL_VERSION
            ),
            DecodeError::Malformed { kind } => {
                write!(f, "message 0x{kind:02x} does not decode: the other side was built from another message table")
            }
        }
    }
}

impl core::error::Error for DecodeError {}
