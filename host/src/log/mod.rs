//! Logs of a conversation with a board: CSV for tables, MCAP for tools, and the live view of a terminal.
//!
//! Three kinds of signals never mix: what a *sensor* read, what the controller *believes*, and the *true* physics
//! (known of a simulated board only). What is logged is on disk, complete to a line and to a chunk, at most
//! [`KEEP_S`] later, so that a killed process loses less than a second. Files are always new: an existing recording is never
//! opened for writing, [`Recorder::create_new`] takes the next free name.

mod about;
mod csv;
mod error;
mod freeze;
mod listening;
mod live;
mod mcap;
mod names;
mod recovery;
mod whole;

use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::time::{Instant, SystemTime, UNIX_EPOCH};

use protocol::TICK_HZ;

pub use about::About;
pub(crate) use csv::quoted;
pub use csv::{COLUMNS, CsvLog};
pub use error::LogError;
pub use freeze::Freeze;
pub(crate) use freeze::frozen_text;
pub use listening::{ListenError, Listening, Terms};
pub use live::{CurveNews, LiveView, Plain, Screen, estimate_text, library_names, live_view, verdict_text};
pub use mcap::{Channel, McapLog};
pub use recovery::{Recovered, recover_mcap};

use crate::control::ShownTicks;
use crate::plant::Truth;
use crate::session::{Event, Gap, Traffic, gap_text};

/// Longest time between something being logged and being on disk, s.
pub const KEEP_S: f64 = 0.5;

/// A moment of a recording.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct At {
    /// The board's time since its start, s, which goes on by the host's clock when the board restarts.
    pub board_s: f64,
    /// Wall clock, ns since 1970; never goes back.
    pub wall_ns: u64,
}

/// Writes everything a board says to the logs that are wanted.
#[derive(Debug, Default)]
pub struct Recorder {
    csv: Option<CsvLog>,
    mcap: Option<McapLog>,
    truths: VecDeque<Truth>,
    /// Time of the newest record in the recording, s.
    board_s: f64,
    /// Wall clock when the board's time was zero, ns since 1970: known from the first record on. Times of later records keep the
    /// board's distances.
    zero_ns: Option<u64>,
    /// Newest wall clock of the recording.
    wall_ns: u64,
    /// What is added to the board's time: it begins again when the board restarts, the recording's does not.
    offset_s: f64,
    /// Earliest time of the next record after a restart, s.
    resumes_s: Option<f64>,
    /// Time in the recording and wall clock of the last time the files were brought to disk.
    kept_board_s: f64,
    kept: Option<Instant>,
    shown: ShownTicks,
}

impl Recorder {
    /// Starts the logs that have a path, in new files: where one of them exists already, all get the next number that is
    /// free, `rec-2.csv` and `rec-2.mcap`. Folders are made.
    ///
    /// # Errors
    /// [`LogError`] when a file cannot be made.
    pub fn create_new(csv: Option<&Path>, mcap: Option<&Path>) -> Result<Self, LogError> {
        if let (Some(csv), Some(mcap)) = (csv, mcap)
            && csv == mcap
        {
            return Err(LogError::SameFile { path: csv.into() });
        }
        let wanted: Vec<&Path> = csv.into_iter().chain(mcap).collect();
        let mut made = names::create_new(&wanted)?.into_iter();
        Ok(Recorder {
            csv: csv.and_then(|_| made.next()).map(|(path, file)| CsvLog::new(path, file)).transpose()?,
            mcap: mcap.and_then(|_| made.next()).map(|(path, file)| McapLog::new(path, file)).transpose()?,
            ..Recorder::default()
        })
    }

    /// Starts both logs in `folder` with the first number for which neither `NAME-NNN.csv` nor `.mcap` exists.
    ///
    /// # Errors
    /// [`LogError`] when folder or files cannot be made.
    pub fn create_numbered(folder: &Path, name: &str) -> Result<Self, LogError> {
        std::fs::create_dir_all(folder).map_err(|source| LogError::File { path: folder.into(), source })?;
        let both = |n| ["csv", "mcap"].map(|kind| folder.join(format!("{name}-{n:03}.{kind}"))).to_vec();
        let mut made = names::first_free(both)?.into_iter();
        Ok(Recorder {
            csv: made.next().map(|(path, file)| CsvLog::new(path, file)).transpose()?,
            mcap: made.next().map(|(path, file)| McapLog::new(path, file)).transpose()?,
            ..Recorder::default()
        })
    }

    /// The CSV file.
    #[must_use]
    pub fn csv_path(&self) -> Option<&Path> {
        self.csv.as_ref().map(CsvLog::path)
    }

    /// The MCAP file.
    #[must_use]
    pub fn mcap_path(&self) -> Option<&Path> {
        self.mcap.as_ref().map(McapLog::path)
    }

    /// How many of the records were of a display, and departed from its material.
    #[must_use]
    pub const fn shown(&self) -> ShownTicks {
        self.shown
    }

    /// All files of the recording.
    #[must_use]
    pub fn paths(&self) -> Vec<PathBuf> {
        [self.csv_path(), self.mcap_path()].into_iter().flatten().map(Path::to_path_buf).collect()
    }

    /// Says whose recording it is: again when the board may have changed.
    ///
    /// # Errors
    /// [`LogError`] when writing fails.
    pub fn about(&mut self, about: &About) -> Result<(), LogError> {
        if let Some(csv) = &mut self.csv {
            csv.about(about.line());
        }
        match &mut self.mcap {
            Some(mcap) => mcap.about(about),
            None => Ok(()),
        }
    }

    /// The moment `board_s` of the recording.
    fn at(&mut self, board_s: f64) -> At {
        let after_zero_ns = (board_s.max(0.0) * 1e9).round() as u64;
        let wall_ns = self.zero_ns.map_or_else(now_ns, |zero_ns| zero_ns.saturating_add(after_zero_ns));
        self.wall_ns = self.wall_ns.max(wall_ns);
        At { board_s, wall_ns: self.wall_ns }
    }

    /// The moment of a record, by which all others are measured.
    fn at_record(&mut self, board_s: f64) -> At {
        let after_zero_ns = (board_s.max(0.0) * 1e9).round() as u64;
        self.zero_ns.get_or_insert_with(|| now_ns().saturating_sub(after_zero_ns));
        self.at(board_s)
    }

    /// Logs true physics. It belongs to the telemetry record of the same tick, which must come later.
    ///
    /// # Errors
    /// [`LogError`] when writing fails.
    pub fn truth(&mut self, truth: Truth) -> Result<(), LogError> {
        let at = self.at_record(self.offset_s + truth.time_s);
        if let Some(mcap) = &mut self.mcap {
            mcap.write(Channel::Truth, at, &truth)?;
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
        let at = self.at(self.board_s);
        match event {
            Event::Telemetry(record) => {
                self.shown.add(record);
                self.board_s = self.time_of(record.tick);
                let at = self.at_record(self.board_s);
                while self.truths.front().is_some_and(|t| t.tick < record.tick) {
                    self.truths.pop_front();
                }
                let truth = self.truths.front().filter(|t| t.tick == record.tick);
                if let Some(csv) = &mut self.csv {
                    csv.telemetry(at, record, truth, traffic)?;
                }
                if let Some(mcap) = &mut self.mcap {
                    mcap.telemetry(at, record, traffic)?;
                }
            }
            Event::Halves(halves) => {
                if let Some(mcap) = &mut self.mcap {
                    mcap.write(Channel::Halves, at, halves)?;
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
                    mcap.write(Channel::Estimate, at, e)?;
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
                    mcap.write(Channel::Verdict, at, verdict)?;
                }
            }
            Event::Fault(fault) => {
                if let Some(csv) = &mut self.csv {
                    csv.note(crate::session::fault_text(fault));
                }
                if let Some(mcap) = &mut self.mcap {
                    mcap.fault(at, fault)?;
                }
            }
            Event::Gap(gap) => self.gap(gap)?,
        }
        self.keep_if_due()
    }

    /// Time of a tick in the recording, s.
    fn time_of(&mut self, tick: u32) -> f64 {
        let tick_s = f64::from(tick) / f64::from(TICK_HZ);
        if let Some(resumes_s) = self.resumes_s.take() {
            let earliest_s = self.board_s + 1.0 / f64::from(TICK_HZ);
            // Times of the recording stay whole ticks.
            self.offset_s = ((resumes_s.max(earliest_s) - tick_s) * f64::from(TICK_HZ)).round() / f64::from(TICK_HZ);
        }
        self.offset_s + tick_s
    }

    fn gap(&mut self, gap: &Gap) -> Result<(), LogError> {
        let ends_s = self.board_s + gap.silent_s;
        if gap.restarted.is_some() {
            self.resumes_s = Some(ends_s);
        }
        if let Some(csv) = &mut self.csv {
            csv.note(gap_text(gap));
        }
        let at = self.at(ends_s);
        match &mut self.mcap {
            Some(mcap) => mcap.gap(at, gap),
            None => Ok(()),
        }
    }

    /// Logs that nothing is heard any more, and why; [`Event::Gap`] tells how it ends.
    ///
    /// # Errors
    /// [`LogError`] when writing fails.
    pub fn gap_begins(&mut self, why: &str) -> Result<(), LogError> {
        if let Some(csv) = &mut self.csv {
            csv.note(why.to_owned());
        }
        let at = self.at(self.board_s);
        if let Some(mcap) = &mut self.mcap {
            mcap.gap_begins(at, why)?;
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
        if wall_due {
            self.kept = Some(Instant::now());
        }
        // A file that takes no more must not keep the other from being written.
        let csv = self.csv.as_mut().map_or(Ok(()), |csv| csv.keep(wall_due));
        let mcap = self.mcap.as_mut().map_or(Ok(()), |mcap| mcap.keep(wall_due));
        csv.and(mcap)
    }

    /// Ends the logs properly; each of them also where the other one fails.
    ///
    /// # Errors
    /// [`LogError`] when writing fails.
    pub fn finish(mut self) -> Result<(), LogError> {
        let csv = self.csv.as_mut().map_or(Ok(()), CsvLog::finish);
        let mcap = self.mcap.map_or(Ok(()), McapLog::finish);
        csv.and(mcap)
    }
}

/// Wall clock, ns since 1970.
fn now_ns() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_nanos() as u64)
}
