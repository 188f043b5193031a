//! The last second before a fault, kept in a file of its own: also where nobody records.

use std::collections::VecDeque;
use std::path::{Path, PathBuf};

use protocol::TICK_HZ;
use protocol::message::{FaultReport, Telemetry};

use super::{CsvLog, LogError, Recorder, names, now_ns};
use crate::session::{Event, Traffic};

/// Holds a second of records in memory; a fault writes them to `fault-NNN.csv`, the first number that is free. Without a fault no file
/// and no folder is made.
#[derive(Debug)]
pub struct Freeze {
    folder: PathBuf,
    last: VecDeque<(Telemetry, Traffic)>,
    /// Waits for the record of its tick: a fault overtakes telemetry in the board's queue.
    fault: Option<FaultReport>,
    /// Tick of the fault that was written last: those that follow within a second belong to it.
    written: Option<u32>,
    files: Vec<PathBuf>,
}

impl Freeze {
    /// Files go to `folder`.
    #[must_use]
    pub fn new(folder: &Path) -> Self {
        Freeze { folder: folder.into(), last: VecDeque::new(), fault: None, written: None, files: Vec::new() }
    }

    /// Files that were written.
    #[must_use]
    pub fn files(&self) -> &[PathBuf] {
        &self.files
    }

    /// Takes what the board said; the file, when this has completed one.
    ///
    /// # Errors
    /// [`LogError`] when it cannot be written.
    pub fn event(&mut self, event: &Event, traffic: &Traffic) -> Result<Option<PathBuf>, LogError> {
        match event {
            Event::Telemetry(record) => {
                self.last.push_back((record.clone(), *traffic));
                while self.last.front().is_some_and(|(first, _)| record.tick.wrapping_sub(first.tick) > TICK_HZ) {
                    self.last.pop_front();
                }
                if self.fault.as_ref().is_some_and(|fault| record.tick >= fault.tick) { self.write() } else { Ok(None) }
            }
            Event::Fault(fault) => {
                let belongs = self.written.is_some_and(|tick| fault.tick.wrapping_sub(tick) < TICK_HZ);
                if !belongs && self.fault.is_none() {
                    self.fault = Some(fault.clone());
                }
                Ok(None)
            }
            Event::Gap(_) => self.lost(),
            _ => Ok(None),
        }
    }

    /// The board is not heard any more: what a fault has waited for does not come.
    ///
    /// # Errors
    /// [`LogError`] when the file cannot be written.
    pub fn lost(&mut self) -> Result<Option<PathBuf>, LogError> {
        let written = self.write();
        // A board that is heard again may count anew.
        (self.written, self.fault) = (None, None);
        self.last.clear();
        written
    }

    fn write(&mut self) -> Result<Option<PathBuf>, LogError> {
        let Some(fault) = self.fault.take() else { return Ok(None) };
        self.written = Some(fault.tick);
        std::fs::create_dir_all(&self.folder).map_err(|source| LogError::File { path: self.folder.clone(), source })?;
        let mut made = names::first_free(|n| vec![self.folder.join(format!("fault-{n:03}.csv"))])?;
        let Some((path, file)) = made.pop() else { return Ok(None) };
        let newest_s = self.last.back().map_or(0.0, |(record, _)| f64::from(record.tick) / f64::from(TICK_HZ));
        // The newest record has just arrived.
        let zero_ns = Some(now_ns().saturating_sub((newest_s * 1e9) as u64));
        let mut recorder = Recorder { csv: Some(CsvLog::new(path.clone(), file)?), zero_ns, ..Recorder::default() };
        for (record, traffic) in &self.last {
            if record.tick == fault.tick {
                recorder.event(&Event::Fault(fault.clone()), traffic)?;
            }
            recorder.event(&Event::Telemetry(record.clone()), traffic)?;
        }
        if !self.last.iter().any(|(record, _)| record.tick == fault.tick) {
            recorder.event(&Event::Fault(fault), &Traffic::default())?;
        }
        recorder.finish()?;
        self.files.push(path.clone());
        Ok(Some(path))
    }
}

/// Where the second before a fault went.
pub(crate) fn frozen_text(path: &Path) -> String {
    format!("the second before the fault is kept in {}", path.display())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::link::{InProcess, Link, Pace};
    use crate::plant::{Broken, Input, Jitter};
    use crate::session::{Patience, Session};
    use crate::simulated_board::SimulatedBoard;

    /// Three seconds of a board; a wire breaks after two, if it is to. What was kept, and the fault's tick.
    fn kept(folder: &Path, breaks: bool) -> (Vec<PathBuf>, Option<u32>) {
        let link = InProcess::new(SimulatedBoard::new(1, Jitter::NONE), Pace::Free);
        let (mut session, _) = Session::open(link, Patience::default()).unwrap();
        let (mut freeze, mut tick) = (Freeze::new(folder), None);
        let began_s = session.link().now_s();
        for until_s in [2.0, 3.0] {
            while let Some(event) = session.poll(began_s + until_s).unwrap() {
                if let Event::Fault(fault) = &event {
                    tick = tick.or(Some(fault.tick));
                }
                freeze.event(&event, &session.traffic()).unwrap();
            }
            let broken = breaks.then_some(Broken::Low);
            session.link_mut().board_mut().set_broken(Input::LoadCell, broken);
        }
        (freeze.files().to_vec(), tick)
    }

    #[test]
    fn the_second_before_a_fault_ends_with_it_in_a_file_of_its_own() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path().join("faults");
        for number in 1..3 {
            let (files, tick) = kept(&folder, true);
            assert_eq!(files, [folder.join(format!("fault-{number:03}.csv"))]);
            let text = std::fs::read_to_string(&files[0]).unwrap();
            let rows: Vec<&str> = text.lines().skip(1).collect();
            let tick_of = |row: &str| row.split(',').nth(1).unwrap().parse::<u32>().unwrap();
            let (first, last) = (tick_of(rows[0]), tick_of(rows[rows.len() - 1]));
            assert_eq!((rows.len(), Some(last), last - first), (51, tick, TICK_HZ));
            assert!(rows[50].contains("fault load-cell-open at tick "), "{}", rows[50]);
            assert!(rows[..50].iter().all(|row| !row.contains("fault load-cell")));
        }
    }

    #[test]
    fn without_a_fault_nothing_is_made() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path().join("faults");
        assert_eq!(kept(&folder, false), (Vec::new(), None));
        assert!(!folder.exists());
    }

    #[test]
    fn a_board_that_is_lost_with_its_fault_leaves_what_there_is() {
        let place = tempfile::tempdir().unwrap();
        let mut freeze = Freeze::new(place.path());
        let fault = FaultReport { tick: 9, fault: 0, value: 1.0, limit: 0.5 };
        assert_eq!(freeze.event(&Event::Fault(fault), &Traffic::default()).unwrap(), None);
        let path = freeze.lost().unwrap().unwrap();
        assert!(std::fs::read_to_string(path).unwrap().contains(" at tick 9"));
        assert_eq!(freeze.lost().unwrap(), None);
    }
}
