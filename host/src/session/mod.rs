//! The host's side of a conversation with a board, over any [`Link`].
//!
//! Every request is repeated until it is answered or the attempts are used up; what the board says unasked
//! (telemetry, verdicts, faults) is kept in order and handed out by [`Session::poll`], also what arrives while
//! an answer is awaited. Damaged and lost frames are counted, never hidden. A board that restarts while the line stays
//! open is greeted again by [`Session::poll`], which tells the [`Gap`]; [`Session::resume`] goes on over another link.

mod error;
mod event;
mod gap;
mod greeting;
mod reception;
mod requests;
mod resumption;
mod upload;

use std::collections::VecDeque;

use protocol::frame::{self, Decoder, LossCounter, MAX_FRAME};
use protocol::message::{Empty, Report, Request, Status};
use protocol::rescue;

pub use error::SessionError;
pub use event::{Event, fault_text};
pub use gap::{Gap, cause_text, gap_text};
pub use greeting::commit_text;
pub use upload::Progress;

use crate::link::Link;

/// How long and how often to ask.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Patience {
    /// Wait for an answer, s of link time.
    pub answer_s: f64,
    /// Wait for the answer to a request that erases flash, s: 8 sectors of 128 KB at up to 2 s each (STM32F429
    /// data sheet, table of flash programming times).
    pub erase_s: f64,
    /// Attempts before a board counts as silent.
    pub attempts: u32,
    /// Silence after which the session sends a status request by itself, so that the board does not
    /// take the link for lost, s.
    pub keep_alive_s: f64,
}

impl Default for Patience {
    fn default() -> Self {
        Patience { answer_s: 0.25, erase_s: 20.0, attempts: 4, keep_alive_s: 0.2 }
    }
}

/// What went over the link so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
pub struct Traffic {
    /// Frames received.
    pub frames_received: u64,
    /// Frames that never arrived, from the gaps in their sequence numbers.
    pub frames_lost: u64,
    /// Frames that arrived damaged (CRC, COBS, length); they are also among the lost ones.
    pub frames_damaged: u64,
    /// Intact frames that no message of this version explains.
    pub frames_unknown: u64,
    /// Requests that had to be repeated.
    pub requests_repeated: u64,
    /// Telemetry records received.
    pub telemetry_received: u64,
    /// Telemetry records missing, from the numbers of the control ticks.
    pub telemetry_lost: u64,
}

impl Traffic {
    /// Fraction of frames lost, 0 to 1.
    pub fn loss(&self) -> f64 {
        let all = self.frames_received + self.frames_lost;
        if all == 0 { 0.0 } else { self.frames_lost as f64 / all as f64 }
    }
}

/// An open conversation.
#[derive(Debug)]
pub struct Session<L> {
    link: L,
    patience: Patience,
    decoder: Decoder,
    bytes: Vec<u8>,
    seq: u16,
    last_sent_s: f64,
    /// When the last frame was counted, s of link time.
    counted_s: f64,
    sequence: LossCounter,
    traffic: Traffic,
    /// Tick of the last telemetry record and the ticks between two of them.
    last_tick: Option<u32>,
    divider: u32,
    /// Telemetry as it was asked for last: the greeting switches it on.
    wanted: u8,
    /// What the board's clocks said last, and when the last record came, s of link time.
    clock: gap::BoardClock,
    record_s: f64,
    /// What they had said before the board counted from its start again; it has not been greeted since.
    clock_before: Option<gap::BoardClock>,
    /// Sequence numbers have jumped farther than any loss explains, and no record has followed.
    jumped: bool,
    /// A gap has begun, and the board has not been heard again.
    gap_open: bool,
    arrived: VecDeque<Incoming>,
    events: VecDeque<Event>,
    latest_status: Option<Status>,
}

/// An intact frame. Few wait at a time, so the size of the largest does no harm.
#[derive(Debug)]
#[allow(clippy::large_enum_variant)]
enum Incoming {
    Report(Report),
    Rescue(rescue::Answer),
    /// What follows comes from a board that has restarted.
    Restart,
}

/// Name of a request in the table of messages.
fn request_name(request: &Request) -> &'static str {
    let kind = request.kind();
    Request::TABLE.iter().find(|(number, _)| *number == kind).map_or("request", |(_, name)| name)
}

impl<L: Link> Session<L> {
    /// A conversation over `link` before any word is said; [`Session::open`] also greets.
    pub fn unopened(link: L, patience: Patience) -> Self {
        Session {
            last_sent_s: link.now_s(),
            record_s: link.now_s(),
            link,
            patience,
            decoder: Decoder::new(),
            bytes: Vec::new(),
            seq: 0,
            counted_s: 0.0,
            sequence: LossCounter::default(),
            traffic: Traffic::default(),
            last_tick: None,
            divider: 1,
            wanted: 1,
            clock: gap::BoardClock::default(),
            clock_before: None,
            jumped: false,
            gap_open: false,
            arrived: VecDeque::new(),
            events: VecDeque::new(),
            latest_status: None,
        }
    }

    /// The link.
    pub fn link(&self) -> &L {
        &self.link
    }

    /// The link, to change what it leads to (a simulated specimen, say).
    pub fn link_mut(&mut self) -> &mut L {
        &mut self.link
    }

    /// Counters of this conversation.
    pub fn traffic(&self) -> Traffic {
        Traffic { frames_received: self.sequence.received, frames_lost: self.sequence.lost, ..self.traffic }
    }

    /// The last status the board sent, asked for or not.
    pub fn latest_status(&self) -> Option<&Status> {
        self.latest_status.as_ref()
    }

    /// The next thing the board said by itself, waiting for it until `deadline_s` of link time.
    ///
    /// # Errors
    /// [`SessionError::Link`] when the way to the board fails; any other when a restarted board does not take up the
    /// conversation again.
    pub fn poll(&mut self, deadline_s: f64) -> Result<Option<Event>, SessionError> {
        loop {
            self.sort_arrived();
            if self.records_have_stopped() {
                self.gap_begins(None);
            }
            if self.gap_open {
                self.hear_again()?;
            }
            if let Some(event) = self.events.pop_front() {
                return Ok(Some(event));
            }
            let now_s = self.link.now_s();
            if now_s >= deadline_s {
                return Ok(None);
            }
            let quiet_until_s = self.last_sent_s + self.patience.keep_alive_s;
            if now_s >= quiet_until_s {
                self.send(&Request::Status(Empty {}))?;
            }
            self.receive(deadline_s.min(now_s + self.patience.keep_alive_s))?;
        }
    }

    /// Asks and waits for the answer; repeats when none comes.
    ///
    /// # Errors
    /// [`SessionError::NoAnswer`], [`SessionError::Refused`], or [`SessionError::Link`].
    pub fn request(&mut self, request: &Request) -> Result<Report, SessionError> {
        let wait_s = match request {
            Request::TableBegin(_) | Request::TableCommit(_) => self.patience.erase_s,
            _ => self.patience.answer_s,
        };
        let first_seq = self.seq;
        let damaged_before = self.traffic.frames_damaged;
        let started_s = self.link.now_s();
        for attempt in 0..self.patience.attempts.max(1) {
            self.traffic.requests_repeated += u64::from(attempt > 0);
            self.send(request)?;
            let deadline_s = self.link.now_s() + wait_s;
            if let Some(answer) = self.answer(request, first_seq, attempt, deadline_s)? {
                return match answer {
                    Report::Refused(refused) => Err(SessionError::Refused {
                        board: self.link.name().into(),
                        request: request_name(request),
                        reason: refused.reason,
                    }),
                    answer => Ok(answer),
                };
            }
        }
        Err(SessionError::NoAnswer {
            board: self.link.name().into(),
            request: request_name(request),
            waited_ms: ((self.link.now_s() - started_s) * 1e3).round() as u64,
            attempts: self.patience.attempts.max(1),
            rejected: self.traffic.frames_damaged - damaged_before,
        })
    }

    /// Waits for what answers `request`, whose attempts carry sequence numbers from `first_seq` on.
    fn answer(
        &mut self,
        request: &Request,
        first_seq: u16,
        attempt: u32,
        deadline_s: f64,
    ) -> Result<Option<Report>, SessionError> {
        let (of, seqs) = (request.kind(), attempt as u16);
        let ours = |seq: u16| seq.wrapping_sub(first_seq) <= seqs;
        loop {
            while let Some(incoming) = self.arrived.pop_front() {
                let report = match incoming {
                    Incoming::Report(report) => report,
                    Incoming::Restart => {
                        self.gap_begins(None);
                        continue;
                    }
                    Incoming::Rescue(_) => continue,
                };
                let answers = match (&report, request) {
                    (Report::Accepted(a), _) => a.of == of && ours(a.seq),
                    (Report::Refused(r), _) => r.of == of && ours(r.seq),
                    (Report::Hello(_), Request::Hello(_))
                    | (Report::Status(_), Request::Status(_))
                    | (Report::LastRun(_), Request::GetLastRun(_))
                    | (Report::Halves(_), Request::GetHalves(_))
                    | (Report::Calibration(_), Request::GetCalibration(_)) => true,
                    // A late answer to an earlier chunk says less than this chunk's end.
                    (Report::TableState(state), Request::TableChunk(chunk)) => {
                        state.next_offset as usize >= chunk.offset as usize + chunk.data.len()
                    }
                    (Report::TableState(state), Request::TableBegin(begin)) => {
                        state.length == begin.length && state.next_offset == 0
                    }
                    // A finished upload leaves none behind.
                    (Report::TableState(state), Request::TableCommit(_)) => state.length == 0,
                    (Report::TableState(_), Request::TableQuery(_)) => true,
                    _ => false,
                };
                if answers {
                    if let Report::Status(status) = &report {
                        self.latest_status = Some(status.clone());
                    }
                    return Ok(Some(report));
                }
                self.keep(report);
            }
            if self.link.now_s() >= deadline_s {
                return Ok(None);
            }
            self.receive(deadline_s)?;
        }
    }

    /// Frames and sends one request.
    fn send(&mut self, request: &Request) -> Result<(), SessionError> {
        let mut buffer = [0u8; MAX_FRAME];
        let seq = self.seq;
        self.seq = self.seq.wrapping_add(1);
        self.last_sent_s = self.link.now_s();
        // No message of the table is longer than a frame (golden bytes in `protocol`).
        if let Ok(bytes) = frame::encode_request(request, seq, &mut buffer) {
            self.link.send(bytes)?;
        }
        Ok(())
    }

    /// The answers of a board that the message table does not allow count as none.
    fn no_sense(&self, request: &'static str) -> SessionError {
        SessionError::NoAnswer {
            board: self.link.name().into(),
            request,
            waited_ms: 0,
            attempts: 1,
            rejected: self.traffic.frames_damaged,
        }
    }
}
