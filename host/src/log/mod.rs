//! Logs of a conversation with a board: CSV for tables, MCAP for tools, and the live view of a terminal.
//!
//! Three kinds of signals never mix: what a *sensor* read, what the controller *believes*, and the *true* physics
//! (known of a simulated board only). What is logged is on disk, complete to a line and to a chunk, at most
//! [`KEEP_S`] later, so that a killed process loses less than a second.

mod csv;
mod error;
mod live;
mod mcap;
mod recovery;

use std::collections::VecDeque;
use std::path::Path;
use std::time::Instant;

use protocol::TICK_HZ;

pub use csv::{COLUMNS, CsvLog};
pub use error::LogError;
pub use live::{LiveView, Plain, Screen, library_names, live_view, verdict_text};
pub use mcap::{Channel, McapLog};
pub use recovery::{Recovered, recover_mcap};

use crate::plant::Truth;
use crate::session::{Event, Traffic};

/// Longest time between something being logged and being on disk, s.
pub const KEEP_S: f64 = 0.5;

/// Writes everything a board says to the logs that are wanted.
#[derive(Debug, Default)]
pub struct Recorder {
    csv: Option<CsvLog>,
    mcap: Option<McapLog>,
    truths: VecDeque<Truth>,
    /// Board time of the newest record, s.
    board_s: f64,
    /// Board time and wall clock of the last time the files were brought to disk.
    kept_board_s: f64,
    kept: Option<Instant>,
}

impl Recorder {
    /// Starts the logs that have a path; existing files are replaced.
    ///
    /// # Errors
    /// [`LogError`] when a file cannot be made.
    pub fn create(csv: Option<&Path>, mcap: Option<&Path>) -> Result<Self, LogError> {
        Ok(Recorder {
            csv: csv.map(CsvLog::create).transpose()?,
            mcap: mcap.map(McapLog::create).transpose()?,
            ..Recorder::default()
        })
    }

    /// Logs true physics. It belongs to the telemetry record of the same tick, which must come later.
    ///
    /// # Errors
    /// [`LogError`] when writing fails.
    pub fn truth(&mut self, truth: Truth) -> Result<(), LogError> {
        if let Some(mcap) = &mut self.mcap {
            mcap.write(Channel::Truth, truth.time_s, &truth)?;
        }
        if self.csv.is_some() {
            self.truths.push_back(truth);
        }
        Ok(())
    }

    /// Logs something the board said, with the counters at that moment.
    ///
    /// # Errors
    /// [`LogError`] when writing fails.
    pub fn event(&mut self, event: &Event, traffic: &Traffic) -> Result<(), LogError> {
        match event {
            Event::Telemetry(record) => {
                self.board_s = f64::from(record.tick) / f64::from(TICK_HZ);
                while self.truths.front().is_some_and(|t| t.tick < record.tick) {
                    self.truths.pop_front();
                }
                let truth = self.truths.front().filter(|t| t.tick == record.tick);
                if let Some(csv) = &mut self.csv {
                    csv.telemetry(record, truth, traffic)?;
                }
                if let Some(mcap) = &mut self.mcap {
                    mcap.telemetry(self.board_s, record, traffic)?;
                }
            }
            Event::Estimate(e) => {
                if let Some(csv) = &mut self.csv {
                    csv.note(format!(
                        "estimate {} mu_mpa={}+-{} alpha={}+-{} height_mm={}+-{}",
                        e.palpation, e.mu_mpa, e.mu_error_mpa, e.alpha, e.alpha_error, e.height_mm, e.height_error_mm
                    ));
                }
                if let Some(mcap) = &mut self.mcap {
                    mcap.write(Channel::Estimate, self.board_s, e)?;
                }
            }
            Event::Verdict(verdict) => {
                if let Some(csv) = &mut self.csv {
                    csv.note(format!(
                        "verdict {} {:?} mu_mpa={} alpha={} material={}",
                        verdict.palpation, verdict.outcome, verdict.mu_mpa, verdict.alpha, verdict.material.index
                    ));
                }
                if let Some(mcap) = &mut self.mcap {
                    mcap.write(Channel::Verdict, self.board_s, verdict)?;
                }
            }
            Event::Fault(fault) => {
                if let Some(csv) = &mut self.csv {
                    csv.note(crate::session::fault_text(fault));
                }
                if let Some(mcap) = &mut self.mcap {
                    mcap.fault(self.board_s, fault)?;
                }
            }
        }
        self.keep_if_due()
    }

    /// Brings the files to disk when [`KEEP_S`] have passed, by the wall clock or by the board's; to be called
    /// also while nothing arrives.
    ///
    /// # Errors
    /// [`LogError`] when writing fails.
    pub fn keep_if_due(&mut self) -> Result<(), LogError> {
        let wall_due = self.kept.get_or_insert_with(Instant::now).elapsed().as_secs_f64() >= KEEP_S;
        if !wall_due && self.board_s - self.kept_board_s < KEEP_S {
            return Ok(());
        }
        self.kept_board_s = self.board_s;
        if let Some(csv) = &mut self.csv {
            csv.keep(wall_due)?;
        }
        if let Some(mcap) = &mut self.mcap {
            mcap.keep(wall_due)?;
        }
        if wall_due {
            self.kept = Some(Instant::now());
        }
        Ok(())
    }

    /// Ends the logs properly.
    ///
    /// # Errors
    /// [`LogError`] when writing fails.
    pub fn finish(mut self) -> Result<(), LogError> {
        if let Some(csv) = &mut self.csv {
            csv.keep(true)?;
        }
        match self.mcap {
            Some(mcap) => mcap.finish(),
            None => Ok(()),
        }
    }
}
