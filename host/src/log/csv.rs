//! One line a telemetry record.

use std::fmt::Write as _;
use std::fs::File;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use protocol::message::Telemetry;

use super::whole::{WholeFile, whole_lines};
use super::{At, LogError};
use crate::plant::Truth;
use crate::session::Traffic;

/// Columns of the file. `time_s`: the board's time, which goes on by the host's clock when the board restarts, so that it
/// never goes back; `tick` begins again then. `utc` is the same moment on the host's wall clock. `sensor_`: as read; `belief_`: as the
/// controller thinks; `raw_`: the converter, 65,535ths of the reference voltage; `true_`: physics of a simulated board, empty for a real
/// one. Units are in the names; `faults` is the bit set of latched faults. `belief_unreachable` and the three after it are 1 in ticks whose
/// display departs from the material ([`protocol::message::Shown`]), else 0. `note` says what happened since the row before: verdicts,
/// faults, gaps; in the first row, whose recording it is. A row that repeats the tick before it only carries its note.
pub const COLUMNS: &str = "time_s,tick,state,faults,\
sensor_probe_mm,sensor_load_cell_n,sensor_fsr_n,sensor_shaft_mm,sensor_coil_a,\
belief_depth_mm,belief_shaft_target_mm,belief_coil_target_a,belief_coil_c,belief_search_error_n,\
belief_unreachable,belief_coil_limited,belief_shaft_limited,belief_actuator_only,\
drive_actuator_v,drive_coil_duty,tick_us,\
raw_load_cell,raw_fsr,raw_potentiometer,raw_probe_position,raw_coil_current,\
true_specimen,true_probe_mm,true_depth_mm,true_force_n,true_finger_n,true_shaft_mm,true_coil_a,true_coil_c,true_flux_t,true_yield_kpa,\
frames_lost,utc,note";

/// A CSV log. Lines are collected and written whole, so the file never ends inside a line.
#[derive(Debug)]
pub struct CsvLog {
    path: PathBuf,
    file: WholeFile,
    /// Goes into the last column of the next line.
    note: String,
    /// Whose recording it is, for the first record that comes.
    about: String,
    /// The note was there already when the file was written last.
    note_waits: bool,
    /// The newest line up to its note.
    last: String,
}

/// Memory for lines that are not written yet; [`CsvLog::keep`] writes far earlier.
const MOST_COLLECTED: usize = 1 << 20;

impl CsvLog {
    /// Writes the header to a new file.
    ///
    /// # Errors
    /// [`LogError::File`].
    pub fn new(path: PathBuf, file: File) -> Result<Self, LogError> {
        let (file, last) = (WholeFile::new(file, whole_lines), String::new());
        let mut log = CsvLog { path, file, note: String::new(), about: String::new(), note_waits: false, last };
        log.line(COLUMNS);
        log.keep(false)?;
        Ok(log)
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    fn line(&mut self, text: &str) {
        // Collecting cannot fail.
        let _ = writeln!(self.file, "{text}");
    }

    /// Adds a line, at a time of the recording.
    ///
    /// # Errors
    /// [`LogError::File`] when the collected lines cannot be written.
    pub fn telemetry(
        &mut self,
        at: At,
        t: &Telemetry,
        truth: Option<&Truth>,
        traffic: &Traffic,
    ) -> Result<(), LogError> {
        let mut line = String::new();
        // Writing to a string cannot fail.
        let _ = write!(
            line,
            "{:.2},{},{:?},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},",
            at.board_s,
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
            u8::from(t.shown.unreachable),
            u8::from(t.shown.coil_limited),
            u8::from(t.shown.shaft_limited),
            u8::from(t.shown.actuator_only),
            t.actuator_v,
            t.coil_duty,
            t.tick_us,
            t.raw.load_cell,
            t.raw.fsr,
            t.raw.potentiometer,
            t.raw.probe_position,
            t.raw.coil_current,
        );
        match truth {
            Some(p) => {
                let _ = write!(
                    line,
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
            None => line.push_str(",,,,,,,,,,"),
        }
        let utc = jiff::Timestamp::from_nanosecond(at.wall_ns.into()).unwrap_or_default();
        let _ = write!(line, "{},{utc:.3},", traffic.frames_lost);
        self.last = line;
        if !self.about.is_empty() {
            let note = std::mem::replace(&mut self.note, std::mem::take(&mut self.about));
            self.note.push_str(if note.is_empty() { "" } else { "; " });
            self.note.push_str(&note);
        }
        self.line_with_note();
        if self.file.collected() > MOST_COLLECTED { self.keep(false) } else { Ok(()) }
    }

    /// The newest record with what there is to say.
    fn line_with_note(&mut self) {
        let note = std::mem::take(&mut self.note);
        self.note_waits = false;
        if self.last.is_empty() {
            self.last = ",".repeat(COLUMNS.matches(',').count());
        }
        let line = format!("{}{}", self.last, quoted(&note));
        self.line(&line);
    }

    /// Puts into the next record whose recording it is; without a record there is nothing that it could be of.
    pub fn about(&mut self, text: String) {
        self.about = text;
    }

    /// Puts a remark into the next line.
    pub fn note(&mut self, text: String) {
        if !self.note.is_empty() {
            self.note.push_str("; ");
        }
        self.note.push_str(&text);
        // The row after a gap is where its end is told, also when its beginning has waited long.
        self.note_waits = false;
    }

    /// Writes the collected lines; with `sync` waits until they are on the disk. A remark waits for the next record; a
    /// board that falls silent sends none, and the next call writes the last record again with the remark.
    ///
    /// # Errors
    /// [`LogError::File`].
    pub fn keep(&mut self, sync: bool) -> Result<(), LogError> {
        if !self.note.is_empty() && std::mem::replace(&mut self.note_waits, true) {
            self.line_with_note();
        }
        let flushed = self.file.flush().and_then(|()| if sync { self.file.sync() } else { Ok(()) });
        flushed.map_err(|source| LogError::File { path: self.path.clone(), source })
    }

    /// Writes everything, remarks that wait included, to the disk.
    ///
    /// # Errors
    /// [`LogError::File`].
    pub fn finish(&mut self) -> Result<(), LogError> {
        self.note_waits = true;
        self.keep(true)
    }
}

/// Quotes a cell where commas or quotes ask for it (RFC 4180).
pub(crate) fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.into() }
}
