//! What the force sensor and the reader of the depth did wrong: readings that are none, told with their lines.
//!
//! Single readings far off their neighbours and codes for "no reading" are left out. A run ends where its sensor
//! stands at its limit. Columns that count compression negative are turned, or refused where only one of them does.

mod code;
mod direction;
mod edit;
mod glitch;
mod limit;

use std::fmt;

use super::Recording;
use super::error::Problem;

/// A column that a trouble is in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Signal {
    /// Depth, mm.
    Depth,
    /// Force, N.
    Force,
}

impl Signal {
    /// Its name in the contract.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Signal::Depth => "depth_mm",
            Signal::Force => "force_N",
        }
    }

    fn of(self, recording: &Recording) -> &[f64] {
        match self {
            Signal::Depth => &recording.depth_mm,
            Signal::Force => &recording.force_n,
        }
    }
}

/// One reading: line of the file, and value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// Line, from 1.
    pub line: usize,
    /// Value in the contract's unit.
    pub value: f64,
}

/// Something that was wrong with the readings of a run, and was dealt with.
#[derive(Debug, Clone, PartialEq)]
pub enum Trouble {
    /// Readings far off their neighbours, at most two in a row; left out.
    Glitches {
        /// Where.
        signal: Signal,
        /// The readings.
        readings: Vec<Reading>,
    },
    /// A number that stands for "no reading", such as 9999; left out.
    Code {
        /// Where.
        signal: Signal,
        /// The readings, all of one value.
        readings: Vec<Reading>,
    },
    /// The force stands at one value while the ball goes deeper; the run ends before it.
    Limit {
        /// First reading at the limit.
        first: Reading,
        /// Number of readings that were left out.
        left_out: usize,
        /// How much deeper the ball goes meanwhile, mm.
        deeper_mm: f64,
    },
    /// Both columns counted compression negative; both were turned.
    Turned,
    /// Numbers that are likely in another unit; the question, with the key that answers it.
    Unit(String),
}

impl Trouble {
    /// Stable code in answers.
    #[must_use]
    pub fn code(&self) -> &'static str {
        match self {
            Trouble::Glitches { .. } => "glitch",
            Trouble::Code { .. } => "overload-code",
            Trouble::Limit { .. } => "saturated",
            Trouble::Turned => "turned",
            Trouble::Unit(_) => "unit",
        }
    }
}

impl fmt::Display for Trouble {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Trouble::Glitches { signal, readings } => write!(
                f,
                "{}, far off {} neighbours: a glitch of the sensor; left out",
                named(*signal, readings),
                if readings.len() == 1 { "its" } else { "their" }
            ),
            Trouble::Code { signal, readings } => {
                write!(f, "{}, a code of the device for \"no reading\"; left out", named(*signal, readings))
            }
            Trouble::Limit { first, left_out, deeper_mm } => write!(
                f,
                "the force sensor is saturated: from line {} on it stands at {} N while the ball goes {deeper_mm:.2} mm \
                 deeper; the run is used up to there, {left_out} readings are left out",
                first.line, first.value
            ),
            Trouble::Unit(question) => f.write_str(question),
            Trouble::Turned => write!(
                f,
                "depth and force fall as the ball goes in, so compression counts negative: both are turned \
                 (sign = -1 for `depth_mm` and `force_N` in [columns] says so)"
            ),
        }
    }
}

/// Lines that a message lists before it only counts.
const LISTED: usize = 4;

/// The readings with their lines: "line 57: force_N is 20.05".
fn named(signal: Signal, readings: &[Reading]) -> String {
    match readings {
        [one] => format!("line {}: {} is {}", one.line, signal.name(), one.value),
        many => {
            let lines: Vec<String> = many.iter().take(LISTED).map(|reading| reading.line.to_string()).collect();
            let more = if many.len() > LISTED { ", ..." } else { "" };
            let largest = many.iter().fold(0.0, |most: f64, r| if r.value.abs() > most.abs() { r.value } else { most });
            format!("lines {}{more}: {} readings of {}, up to {largest}", lines.join(", "), many.len(), signal.name())
        }
    }
}

/// Takes out of a run of a specimen what is no reading, and says what that was.
///
/// # Errors
/// Columns of which one alone counts compression negative, with the key that turns it.
pub(super) fn cleaned(recording: &mut Recording) -> Result<Vec<Trouble>, Problem> {
    let mut troubles = Vec::new();
    for signal in [Signal::Depth, Signal::Force] {
        for found in code::found(signal.of(recording)) {
            troubles.push(Trouble::Code { signal, readings: taken_out(recording, signal, &found) });
        }
        let found = glitch::found(recording, signal);
        if !found.is_empty() {
            troubles.push(Trouble::Glitches { signal, readings: taken_out(recording, signal, &found) });
        }
    }
    if direction::turns(recording)? {
        recording.turn();
        troubles.push(Trouble::Turned);
    }
    if let Some(limit) = limit::found(recording) {
        let first = Reading { line: recording.line[limit.first], value: recording.force_n[limit.first] };
        let left_out = recording.len() - limit.first;
        recording.end_before(limit.first);
        troubles.push(Trouble::Limit { first, left_out, deeper_mm: limit.deeper_mm });
    }
    Ok(troubles)
}

/// Takes samples out of a recording; their readings.
fn taken_out(recording: &mut Recording, signal: Signal, at: &[usize]) -> Vec<Reading> {
    let reading = |at: &usize| Reading { line: recording.line[*at], value: signal.of(recording)[*at] };
    let readings = at.iter().map(reading).collect();
    recording.leave_out(at);
    readings
}

#[cfg(test)]
mod tests;
