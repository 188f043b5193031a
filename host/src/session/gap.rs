//! Stretches in which a board was not heard, and how they ended.

use protocol::TICK_HZ;
use protocol::message::{Report, ResetCause};
use serde::Serialize;

/// Nothing was heard for a while, and then the board again.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Gap {
    /// From the last telemetry record to the moment the board was heard again, s of the host's clock.
    pub silent_s: f64,
    /// Tick of the last record before.
    pub after_tick: Option<u32>,
    /// Time since the board's start when it was heard again, s.
    pub uptime_s: f64,
    /// Cause of the restart, if the board has restarted meanwhile.
    pub restarted: Option<ResetCause>,
    /// Why the link was lost, if it was.
    pub link_lost: Option<String>,
}

/// The cause of a start in words.
pub const fn cause_text(cause: ResetCause) -> &'static str {
    match cause {
        ResetCause::PowerOn => "power on or brown-out",
        ResetCause::Pin => "reset button or debugger",
        ResetCause::Software => "software",
        ResetCause::Watchdog => "watchdog",
        ResetCause::Other => "unknown",
    }
}

/// A gap in one sentence: how long, after which tick, why, and where the ticks stand now.
pub fn gap_text(gap: &Gap) -> String {
    let after = gap.after_tick.map_or(String::new(), |tick| format!(" after tick {tick}"));
    let lost = gap.link_lost.as_ref().map_or(String::new(), |why| format!("link lost ({why}) and open again, "));
    let board = match (gap.restarted, &gap.link_lost) {
        (Some(cause), _) => format!("board restarted (cause: {}), ticks begin again", cause_text(cause)),
        (None, Some(_)) => "board went on meanwhile".to_owned(),
        (None, None) => "telemetry had stopped".to_owned(),
    };
    format!("gap of {:.2} s{after}: {lost}{board}; telemetry is on again, board up {:.2} s", gap.silent_s, gap.uptime_s)
}

/// What the board's own clocks said last, to tell a restart from a delay. Restarts show as a step back; records and
/// statuses are compared each with its own kind, because an answer overtakes telemetry in the board's queue.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct BoardClock {
    /// Tick of the last record.
    pub(super) tick: Option<u32>,
    pub(super) uptime_ms: Option<u32>,
    /// When either was heard, s of link time.
    pub(super) heard_s: f64,
    /// Lost frames counted when the clock was last seen going on.
    pub(super) lost: u64,
    /// Statuses since the last record.
    pub(super) statuses: u32,
}

/// Two numbers of a counter that wraps: the second is behind the first.
fn behind(last: Option<u32>, new: u32) -> bool {
    last.is_some_and(|last| last != new && last.wrapping_sub(new) < u32::MAX / 2)
}

impl BoardClock {
    /// True when `report` shows that the board counts from its start again.
    pub(super) fn begins_again(&self, report: &Report) -> bool {
        match report {
            Report::Telemetry(t) => behind(self.tick, t.tick),
            Report::Status(s) => behind(self.uptime_ms, s.uptime_ms),
            _ => false,
        }
    }

    /// Takes what `report` says of the time; true when it says something.
    pub(super) fn see(&mut self, report: &Report) -> bool {
        match report {
            Report::Telemetry(t) => (self.tick, self.statuses) = (Some(t.tick), 0),
            Report::Status(s) => {
                self.uptime_ms = Some(s.uptime_ms);
                self.statuses = self.statuses.saturating_add(1);
            }
            _ => return false,
        }
        true
    }

    /// Newest time since start that was heard, s.
    pub(super) fn uptime_s(&self) -> f64 {
        let by_tick = self.tick.map_or(0.0, |tick| f64::from(tick) / f64::from(TICK_HZ));
        self.uptime_ms.map_or(0.0, |ms| f64::from(ms) * 1e-3).max(by_tick)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_back_is_a_restart_and_a_wrap_is_none() {
        let at = |tick| BoardClock { tick: Some(tick), ..BoardClock::default() };
        assert!(behind(at(300).tick, 1) && !behind(at(300).tick, 300) && !behind(at(300).tick, 301));
        // 49.7 days: the milliseconds begin again by themselves.
        assert!(!behind(Some(u32::MAX - 10), 5) && !behind(None, 0));
    }

    #[test]
    fn a_gap_says_how_long_why_and_what_is_new() {
        let mut gap = Gap {
            silent_s: 0.456,
            after_tick: Some(300),
            uptime_s: 0.2,
            restarted: Some(ResetCause::Watchdog),
            link_lost: None,
        };
        assert_eq!(
            gap_text(&gap),
            "gap of 0.46 s after tick 300: board restarted (cause: watchdog), ticks begin again; telemetry is on again, \
             board up 0.20 s"
        );
        gap.link_lost = Some("serial:/dev/ttyACM0 closed the connection".into());
        gap.restarted = None;
        assert_eq!(
            gap_text(&gap),
            "gap of 0.46 s after tick 300: link lost (serial:/dev/ttyACM0 closed the connection) and open again, \
             board went on meanwhile; telemetry is on again, board up 0.20 s"
        );
    }
}
