//! Hearing a board again that has restarted, or that was out of reach.

use protocol::TICK_HZ;
use protocol::frame::Decoder;
use protocol::message::Hello;

use super::gap::BoardClock;
use super::{Event, Gap, Session, SessionError};
use crate::link::Link;

/// Silence of a board that answers but sends no records, s, after which they are switched on again.
const STOPPED_S: f64 = 1.0;

/// Statuses without a record between them that make such a silence certain.
const STOPPED_STATUSES: u32 = 3;

/// A board whose clock is behind the host's by more than this after a silence has restarted meanwhile, s. Between a
/// keep-alive and a late answer, and far below the time that anybody needs to pull a plug.
const RESTARTED_S: f64 = 0.6;

impl<L: Link> Session<L> {
    /// Goes on over another `link` after the old one was lost for the reason `why`: greets, switches telemetry on as it
    /// was, and hands out an [`Event::Gap`]. Counters go on. May be repeated with the next link when it fails.
    ///
    /// # Errors
    /// As [`Session::open`].
    pub fn resume(&mut self, link: L, why: &str) -> Result<Hello, SessionError> {
        self.sort_arrived();
        // On the clock of the new link the silence began before zero.
        let turned_s = link.now_s() - self.link.now_s();
        self.record_s += turned_s;
        self.clock.heard_s += turned_s;
        self.counted_s += turned_s;
        self.last_sent_s = link.now_s();
        self.link = link;
        self.decoder = Decoder::new();
        self.gap_begins(Some(why));
        self.hear_again()
    }

    /// Marks the place in the order of events; what happened is filled in when the board has told it.
    pub(super) fn gap_begins(&mut self, link_lost: Option<&str>) {
        let link_lost = link_lost.map(str::to_owned);
        if std::mem::replace(&mut self.gap_open, true) {
            if let Some(gap) = self.last_gap() {
                gap.link_lost = gap.link_lost.take().or(link_lost);
            }
            return;
        }
        let before = self.clock_before.unwrap_or(self.clock);
        let silent_s = self.link.now_s() - self.record_s;
        let gap = Gap { silent_s, after_tick: before.tick, uptime_s: before.uptime_s(), restarted: None, link_lost };
        self.events.push_back(Event::Gap(gap));
    }

    fn last_gap(&mut self) -> Option<&mut Gap> {
        self.events.iter_mut().rev().find_map(|event| match event {
            Event::Gap(gap) => Some(gap),
            _ => None,
        })
    }

    /// Greets the board anew, switches its telemetry on as it was, and completes the gap that was begun.
    pub(super) fn hear_again(&mut self) -> Result<Hello, SessionError> {
        let (record_s, known, lost) = (self.record_s, self.clock_before.take(), self.sequence.lost);
        let before = known.unwrap_or(self.clock);
        self.clock = BoardClock { lost, ..BoardClock::default() };
        self.last_tick = None;
        let greeted = self.greet().and_then(|hello| {
            self.set_telemetry(self.wanted)?;
            // Answers come in order: this status is none of those that lay in the line.
            Ok((hello, f64::from(self.status()?.uptime_ms) * 1e-3))
        });
        let now_s = self.link.now_s();
        self.clock_before = None;
        // What the gap has swallowed is told as the gap.
        self.sequence.lost = lost;
        self.clock.lost = lost;
        let (hello, uptime_s) = match greeted {
            Ok(told) => told,
            Err(error) => {
                // The next attempt compares with what was known before.
                self.record_s = record_s;
                self.clock_before = known;
                self.clock = before;
                return Err(error);
            }
        };
        self.record_s = now_s;
        self.gap_open = false;
        let advanced_s = uptime_s - before.uptime_s();
        let behind = advanced_s < (now_s - before.heard_s - RESTARTED_S).max(0.0);
        let restarted = std::mem::take(&mut self.jumped) || known.is_some() || behind;
        if let Some(gap) = self.last_gap() {
            (gap.silent_s, gap.uptime_s) = (now_s - record_s, uptime_s);
            gap.restarted = restarted.then_some(hello.reset_cause);
        }
        Ok(hello)
    }

    /// A board that answers and has stopped its records was not told to: it has restarted.
    pub(super) fn records_have_stopped(&self) -> bool {
        let expected_s = 2.0 * f64::from(self.wanted) / f64::from(TICK_HZ);
        self.wanted > 0
            && self.clock.statuses >= STOPPED_STATUSES
            && self.link.now_s() - self.record_s > STOPPED_S + expected_s
    }
}
