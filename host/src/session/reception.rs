//! What comes from the board: decoded, counted and sorted.

use protocol::message::Report;
use protocol::rescue;

use super::{Event, Incoming, Session, SessionError};
use crate::link::Link;

/// More frames than any board sends in a second: a larger gap in their numbers is a board that counts anew.
const MOST_FRAMES_PER_S: f64 = 500.0;

impl<L: Link> Session<L> {
    /// Takes bytes from the link until `deadline_s` and decodes them.
    pub(super) fn receive(&mut self, deadline_s: f64) -> Result<(), SessionError> {
        let mut bytes = std::mem::take(&mut self.bytes);
        bytes.clear();
        let received = self.link.receive(&mut bytes, deadline_s);
        for &byte in &bytes {
            match self.decoder.push(byte) {
                None => {}
                Some(Err(_)) => self.traffic.frames_damaged += 1,
                Some(Ok(frame)) => {
                    let incoming = if frame.kind == rescue::KIND {
                        rescue::Answer::from_bytes(frame.body).map(Incoming::Rescue)
                    } else {
                        Report::decode(frame.kind, frame.body).ok().map(Incoming::Report)
                    };
                    let seq = frame.seq;
                    self.count(seq, incoming.as_ref());
                    match incoming {
                        Some(incoming) => self.arrived.push_back(incoming),
                        None => self.traffic.frames_unknown += 1,
                    }
                }
            }
        }
        self.bytes = bytes;
        Ok(received?)
    }

    /// Counts a frame and those missing before it. One that shows that the board counts anew has none before it.
    fn count(&mut self, seq: u16, incoming: Option<&Incoming>) {
        let report = match incoming {
            Some(Incoming::Report(report)) => Some(report),
            _ => None,
        };
        let elapsed_s = (self.link.now_s() - self.counted_s).max(0.0);
        let too_many = f64::from(self.sequence.gap_before(seq)) > MOST_FRAMES_PER_S * (1.0 + elapsed_s);
        let begins_again = report.is_some_and(|report| self.clock.begins_again(report));
        if too_many || begins_again {
            // Frames of the restarted board that said nothing of the time were counted as if they followed.
            self.sequence.lost = self.clock.lost;
            self.sequence.begin_again();
            self.jumped = true;
        }
        if begins_again && self.clock_before.is_none() {
            self.last_tick = None;
            self.clock_before = Some(std::mem::take(&mut self.clock));
            self.arrived.push_back(Incoming::Restart);
        }
        self.sequence.see(seq);
        self.counted_s = self.link.now_s();
        if report.is_some_and(|report| self.clock.see(report)) {
            (self.clock.lost, self.clock.heard_s) = (self.sequence.lost, self.counted_s);
        }
    }

    pub(super) fn sort_arrived(&mut self) {
        while let Some(incoming) = self.arrived.pop_front() {
            match incoming {
                Incoming::Report(report) => self.keep(report),
                Incoming::Restart => self.gap_begins(None),
                Incoming::Rescue(_) => {}
            }
        }
    }

    /// Keeps what was not asked for; late answers to repeated requests say nothing new.
    pub(super) fn keep(&mut self, report: Report) {
        match report {
            Report::Telemetry(record) => {
                let step = self.last_tick.map_or(0, |last| record.tick.wrapping_sub(last));
                self.traffic.telemetry_received += 1;
                // A step back is a restarted board, not a loss.
                if step < u32::MAX / 2 {
                    self.traffic.telemetry_lost += u64::from((step / self.divider).saturating_sub(1));
                }
                self.last_tick = Some(record.tick);
                self.record_s = self.link.now_s();
                // While the board is greeted anew, the jump is what tells a restart.
                self.jumped &= self.gap_open;
                self.events.push_back(Event::Telemetry(record));
            }
            Report::Halves(halves) => self.events.push_back(Event::Halves(halves)),
            Report::Estimate(estimate) => self.events.push_back(Event::Estimate(estimate)),
            Report::Verdict(verdict) => self.events.push_back(Event::Verdict(verdict)),
            Report::Fault(fault) => self.events.push_back(Event::Fault(fault)),
            Report::Status(status) => self.latest_status = Some(status),
            _ => {}
        }
    }
}
