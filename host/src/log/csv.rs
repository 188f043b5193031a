//! One line a telemetry record.

use std::fmt::Write as _;
use std::fs::File;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use protocol::TICK_HZ;
use protocol::message::Telemetry;

use super::LogError;
use crate::plant::Truth;
use crate::session::Traffic;

/// Columns of the file. `sensor_`: as read; `belief_`: as the controller thinks; `true_`: physics of a simulated
/// board, empty for a real one. Units are in the names; `faults` is the bit set of latched faults.
pub const COLUMNS: &str = "time_s,tick,state,faults,\
sensor_probe_mm,sensor_load_cell_n,sensor_fsr_n,sensor_shaft_mm,sensor_coil_a,\
belief_depth_mm,belief_shaft_target_mm,belief_coil_target_a,belief_coil_c,belief_search_error_n,\
drive_actuator_v,drive_coil_duty,tick_us,\
true_specimen,true_probe_mm,true_depth_mm,true_force_n,true_finger_n,true_shaft_mm,true_coil_a,true_coil_c,true_flux_t,true_yield_kpa,\
frames_lost,note";

/// A CSV log. Lines are collected and written whole, so the file never ends inside a line.
#[derive(Debug)]
pub struct CsvLog {
    path: PathBuf,
    file: File,
    /// Complete lines not yet written.
    lines: String,
    /// Goes into the last column of the next line.
    note: String,
}

impl CsvLog {
    /// Makes the file and writes the header.
    ///
    /// # Errors
    /// [`LogError::File`].
    pub fn create(path: &Path) -> Result<Self, LogError> {
        let file = File::create(path).map_err(|source| LogError::File { path: path.into(), source })?;
        let mut log = CsvLog { path: path.into(), file, lines: format!("{COLUMNS}\n"), note: String::new() };
        log.keep(false)?;
        Ok(log)
    }

    /// Adds a line.
    ///
    /// # Errors
    /// [`LogError::File`] when the collected lines cannot be written.
    pub fn telemetry(&mut self, t: &Telemetry, truth: Option<&Truth>, traffic: &Traffic) -> Result<(), LogError> {
        // Writing to a string cannot fail.
        let _ = write!(
            self.lines,
            "{:.2},{},{:?},{},{},{},{},{},{},{},{},{},{},{},{},{},{},",
            f64::from(t.tick) / f64::from(TICK_HZ),
            t.tick,
            t.state,
            t.faults.0,
            t.probe_mm,
            t.load_cell_n,
            t.fsr_n,
            t.shaft_mm,
            t.coil_a,
            t.depth_mm,
            t.shaft_target_mm,
            t.coil_target_a,
            t.coil_c,
            t.search_error_n,
            t.actuator_v,
            t.coil_duty,
            t.tick_us,
        );
        match truth {
            Some(p) => {
                let _ = write!(
                    self.lines,
                    "{},{:.5},{:.5},{:.5},{:.5},{:.5},{:.5},{:.3},{:.5},{:.4},",
                    p.specimen,
                    p.probe_mm,
                    p.depth_mm,
                    p.force_n,
                    p.finger_n,
                    p.shaft_mm,
                    p.coil_a,
                    p.coil_c,
                    p.flux_t,
                    p.yield_kpa
                );
            }
            None => self.lines.push_str(",,,,,,,,,,"),
        }
        let note = std::mem::take(&mut self.note);
        let _ = writeln!(self.lines, "{},{}", traffic.frames_lost, quoted(&note));
        // A bound on memory; `keep` writes far earlier.
        if self.lines.len() > 1 << 20 {
            self.keep(false)?;
        }
        Ok(())
    }

    /// Puts a remark into the next line.
    pub fn note(&mut self, text: String) {
        if !self.note.is_empty() {
            self.note.push_str("; ");
        }
        self.note.push_str(&text);
    }

    /// Writes the collected lines; with `sync` waits until they are on the disk.
    ///
    /// # Errors
    /// [`LogError::File`].
    pub fn keep(&mut self, sync: bool) -> Result<(), LogError> {
        // A board that reports a fault and then falls silent sends no record that could carry the remark.
        if !self.note.is_empty() {
            let note = std::mem::take(&mut self.note);
            let empty_cells = ",".repeat(COLUMNS.matches(',').count());
            let _ = writeln!(self.lines, "{empty_cells}{}", quoted(&note));
        }
        let failed = |source| LogError::File { path: self.path.clone(), source };
        self.file.write_all(self.lines.as_bytes()).map_err(failed)?;
        self.lines.clear();
        if sync {
            self.file.sync_data().map_err(failed)?;
        }
        Ok(())
    }
}

/// Quotes a cell where commas or quotes ask for it (RFC 4180).
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.into() }
}
