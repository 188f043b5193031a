//! Why a board's last run ended, in words.

use protocol::message::{LastRun, RunEnd};
use serde_json::{Value, json};

/// Why it ended; `None` if nothing is known of it.
fn why(last: &LastRun) -> Option<String> {
    if !last.known {
        return None;
    }
    Some(match last.end {
        RunEnd::Unknown => "reset without a record of why".to_owned(),
        RunEnd::Panic { line } => format!("panic at {}:{line}", String::from_utf8_lossy(&last.file)),
        RunEnd::HardFault { pc, lr, cfsr } => {
            format!("HardFault at {pc:#010x}, called from {lr:#010x}, fault status {cfsr:#010x}")
        }
        RunEnd::ClockLost => "the 8 MHz clock stopped".to_owned(),
        RunEnd::SupplyLow => "the 3.3 V supply sagged".to_owned(),
        RunEnd::Interrupt { number } => format!("interrupt {} without a handler", number as i32),
    })
}

/// Lines for people; nothing if nothing is known.
pub(super) fn text(last: &LastRun) -> String {
    let Some(why) = why(last) else {
        return String::new();
    };
    let mut text = format!("\nlast run   {why}");
    let changes: Vec<String> =
        last.changes.iter().map(|c| format!("{:?} at {:.2} s", c.state, f64::from(c.time_ms) / 1e3)).collect();
    if !changes.is_empty() {
        text += &format!("\n           its states: {}", changes.join(", "));
    }
    text
}

/// The same for programs.
pub(super) fn value(last: &LastRun) -> Value {
    json!({
        "known": last.known,
        "end": last.end,
        "why": why(last),
        "changes": last.changes.iter().map(|c| json!({ "time_ms": c.time_ms, "state": c.state })).collect::<Vec<_>>(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use protocol::message::{State, StateChange};

    #[test]
    fn an_end_is_told_with_its_place_and_the_states_before_it() {
        assert_eq!(text(&LastRun::NONE), "");
        let last = LastRun {
            known: true,
            end: RunEnd::Panic { line: 42 },
            file: b"src/board/mod.rs".iter().copied().collect(),
            changes: [StateChange { time_ms: 1500, state: State::Display }].into_iter().collect(),
        };
        assert_eq!(text(&last), "\nlast run   panic at src/board/mod.rs:42\n           its states: Display at 1.50 s");
        let stray = LastRun { end: RunEnd::Interrupt { number: -2_i32 as u32 }, changes: Default::default(), ..last };
        assert_eq!(text(&stray), "\nlast run   interrupt -2 without a handler");
    }
}
