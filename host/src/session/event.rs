//! What a board says unasked.

use protocol::fault::Fault;
use protocol::message::{Estimate, FaultReport, Halves, Telemetry, Verdict};

use super::Gap;

/// Something the board said by itself.
#[derive(Debug, Clone, PartialEq)]
pub enum Event {
    /// One control tick.
    Telemetry(Telemetry),
    /// What both halves did in the tick of the record before it; only while one is on that was asked for by itself.
    Halves(Halves),
    /// What the Kalman filter made of the palpation whose verdict follows.
    Estimate(Estimate),
    /// The end of a palpation.
    Verdict(Verdict),
    /// A fault was latched.
    Fault(FaultReport),
    /// The board was not heard for a while: it has restarted, or the link was lost. What follows came after it.
    Gap(Gap),
}

/// A fault in words: what, when, the value and its limit, and what to do.
pub fn fault_text(report: &FaultReport) -> String {
    match Fault::from_bit(report.fault) {
        Some(fault) => format!(
            "fault {} at tick {}: {} ({:.4}, limit {:.4}); {}",
            fault.code(),
            report.tick,
            fault.describe(),
            report.value,
            report.limit,
            fault.advice(),
        ),
        None => format!(
            "fault number {} at tick {} ({:.4}, limit {:.4}): unknown to this version",
            report.fault, report.tick, report.value, report.limit,
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fault_says_what_and_what_to_do() {
        let report = FaultReport { tick: 120, fault: Fault::ForceLimit as u8, value: 21.25, limit: 20.0 };
        assert_eq!(
            fault_text(&report),
            "fault force-limit at tick 120: force above the limit of the load cell (21.2500, limit 20.0000); \
             raise the probe, then clear the fault"
        );
        let newer = FaultReport { fault: 31, ..report };
        assert!(fault_text(&newer).ends_with("unknown to this version"));
    }
}
