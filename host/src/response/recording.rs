//! Recordings of an actuator as CSV: of any program, and those of `palpate log`.

use std::path::{Path, PathBuf};

use super::fit::Record;
use super::push::Pushed;

/// Names that a column of each kind is known by, the surest first; letters of either case.
const TIME: [&str; 6] = ["time_s", "t_s", "time", "t", "seconds", "time (s)"];
const COMMAND: [&str; 8] =
    ["drive_actuator_v", "command_v", "u_v", "command", "actuator_v", "voltage_v", "u", "belief_shaft_target_mm"];
const POSITION: [&str; 8] =
    ["sensor_shaft_mm", "position_mm", "shaft_mm", "x_mm", "y_mm", "position", "displacement_mm", "x"];
const FORCE: [&str; 6] = ["force_n", "f_n", "sensor_fsr_n", "load_n", "force", "load_cell_n"];
/// Fewest rows that anything can be read from.
const LEAST_ROWS: usize = 100;

/// Which columns hold what; none is found by its name.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Columns {
    /// Stamps, s.
    pub time: Option<String>,
    /// Command, V.
    pub command: Option<String>,
    /// Position, mm.
    pub position: Option<String>,
    /// Force, N.
    pub force: Option<String>,
    /// A signal that the force of a pushed actuator may follow.
    pub beside: Option<String>,
}

/// What a file holds.
#[derive(Debug, Clone, PartialEq)]
pub enum Recorded {
    /// Command and position, with the command's column.
    Commanded(Record, String),
    /// Position and force of an actuator that is pushed.
    Pushed(Pushed),
}

/// What is wrong with a recording, and where. The texts are part of the interface.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum RecordingError {
    /// The operating system, or no CSV.
    #[error("{}: {cause}", file.display())]
    Unreadable {
        /// The file.
        file: PathBuf,
        /// Why.
        cause: String,
    },
    /// A column that must be there.
    #[error("{}: no column for the {what} among {found}; expected one of {expected}", file.display())]
    #[diagnostic(help("--columns {key}=NAME names the column"))]
    Missing {
        /// The file.
        file: PathBuf,
        /// Quantity.
        what: &'static str,
        /// Its word in `--columns`.
        key: &'static str,
        /// The header.
        found: String,
        /// Names that are known.
        expected: String,
    },
    /// A cell that is no number.
    #[error("{}, line {line}, column {column}: \"{value}\"; expected a number", file.display())]
    Cell {
        /// The file.
        file: PathBuf,
        /// Line, from 1.
        line: u64,
        /// Name of the column.
        column: String,
        /// What stands there.
        value: String,
    },
    /// Time that goes back.
    #[error("{}, line {line}: time goes from {before} s to {after} s; expected stamps that rise", file.display())]
    #[diagnostic(help("cut the recording where the clock was set"))]
    Back {
        /// The file.
        file: PathBuf,
        /// Line, from 1.
        line: u64,
        /// Stamp before.
        before: f64,
        /// Stamp there.
        after: f64,
    },
    /// Too few rows.
    #[error("{}: {rows} rows with numbers; expected at least {LEAST_ROWS}", file.display())]
    Short {
        /// The file.
        file: PathBuf,
        /// How many there are.
        rows: usize,
    },
    /// A signal that never changes.
    #[error("{}: the {what} is {value} in every row; expected one that moves", file.display())]
    Still {
        /// The file.
        file: PathBuf,
        /// Which.
        what: &'static str,
        /// Its value.
        value: f64,
    },
}

/// Reads a recording. Rows with an empty cell in a column that is read are left out; rows that repeat a stamp as well.
///
/// # Errors
/// [`RecordingError`].
pub fn read(file: &Path, columns: &Columns) -> Result<Recorded, RecordingError> {
    let text = std::fs::read(file)
        .map_err(|cause| RecordingError::Unreadable { file: file.to_owned(), cause: cause.to_string() })?;
    parse(file, &text, columns)
}

/// Reads a recording that is already in memory.
///
/// # Errors
/// As [`read`].
pub fn parse(file: &Path, bytes: &[u8], columns: &Columns) -> Result<Recorded, RecordingError> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let mut reader =
        csv::ReaderBuilder::new().trim(csv::Trim::All).flexible(true).comment(Some(b'#')).from_reader(bytes);
    let unreadable = |cause: csv::Error| RecordingError::Unreadable { file: file.to_owned(), cause: cause.to_string() };
    let header: Vec<String> = reader.headers().map_err(unreadable)?.iter().map(str::to_owned).collect();
    let head = Header { file, header: &header };
    let time = head.need("time", "time", columns.time.as_deref(), &TIME)?;
    let position = head.need("position", "position", columns.position.as_deref(), &POSITION)?;
    let command = head.find("command", columns.command.as_deref(), &COMMAND)?;
    let mut places = vec![time, position];
    match command {
        Some(command) => places.push(command),
        None => {
            let Some(force) = head.find("force", columns.force.as_deref(), &FORCE)? else {
                return Err(head.missing("command", "command", &COMMAND));
            };
            places.push(force);
            places.extend(columns.beside.as_deref().map(|name| head.named("beside", name)).transpose()?);
        }
    }
    let rows = rows(file, &header, &places, reader)?;
    let column = |k: usize| -> Vec<f64> { rows.iter().map(|row| row[k]).collect() };
    moves(file, "position", &column(1))?;
    match command {
        Some(command) => {
            moves(file, "command", &column(2))?;
            let record = Record { time_s: column(0), command_v: column(2), position_mm: column(1) };
            Ok(Recorded::Commanded(record, header[command].clone()))
        }
        None => {
            let beside = (places.len() > 3).then(|| column(3));
            Ok(Recorded::Pushed(Pushed { time_s: column(0), position_mm: column(1), force_n: column(2), beside }))
        }
    }
}

fn moves(file: &Path, what: &'static str, values: &[f64]) -> Result<(), RecordingError> {
    let first = values.first().copied().unwrap_or(0.0);
    if values.iter().all(|value| *value == first) {
        return Err(RecordingError::Still { file: file.to_owned(), what, value: first });
    }
    Ok(())
}

struct Header<'a> {
    file: &'a Path,
    header: &'a [String],
}

impl Header<'_> {
    fn at(&self, name: &str) -> Option<usize> {
        self.header.iter().position(|cell| cell.eq_ignore_ascii_case(name))
    }

    fn named(&self, key: &'static str, name: &str) -> Result<usize, RecordingError> {
        self.at(name).ok_or_else(|| RecordingError::Missing {
            file: self.file.to_owned(),
            what: key,
            key,
            found: self.header.join(", "),
            expected: format!("\"{name}\", which --columns names"),
        })
    }

    fn find(&self, key: &'static str, asked: Option<&str>, known: &[&str]) -> Result<Option<usize>, RecordingError> {
        match asked {
            Some(name) => self.named(key, name).map(Some),
            None => Ok(known.iter().find_map(|name| self.at(name))),
        }
    }

    fn need(
        &self,
        what: &'static str,
        key: &'static str,
        asked: Option<&str>,
        known: &[&str],
    ) -> Result<usize, RecordingError> {
        self.find(key, asked, known)?.ok_or_else(|| self.missing(what, key, known))
    }

    fn missing(&self, what: &'static str, key: &'static str, known: &[&str]) -> RecordingError {
        let found = self.header.join(", ");
        RecordingError::Missing { file: self.file.to_owned(), what, key, found, expected: known.join(", ") }
    }
}

/// Numbers of the columns at `places`; the first is the time.
fn rows(
    file: &Path,
    header: &[String],
    places: &[usize],
    mut reader: csv::Reader<&[u8]>,
) -> Result<Vec<Vec<f64>>, RecordingError> {
    let mut rows: Vec<Vec<f64>> = Vec::new();
    for record in reader.records() {
        let record =
            record.map_err(|cause| RecordingError::Unreadable { file: file.to_owned(), cause: cause.to_string() })?;
        let line = record.position().map_or(0, csv::Position::line);
        let cells: Vec<&str> = places.iter().map(|place| record.get(*place).unwrap_or("")).collect();
        if cells.iter().any(|cell| cell.is_empty()) {
            continue;
        }
        let number = |(cell, place): (&&str, &usize)| {
            let number = cell.parse::<f64>().ok().filter(|number| number.is_finite());
            let column = || header.get(*place).cloned().unwrap_or_default();
            number.ok_or_else(|| RecordingError::Cell {
                file: file.to_owned(),
                line,
                column: column(),
                value: (*cell).to_owned(),
            })
        };
        let row = cells.iter().zip(places).map(number).collect::<Result<Vec<f64>, _>>()?;
        match rows.last().map(|last| last[0]) {
            Some(before) if row[0] < before => {
                return Err(RecordingError::Back { file: file.to_owned(), line, before, after: row[0] });
            }
            Some(before) if row[0] == before => {}
            _ => rows.push(row),
        }
    }
    if rows.len() < LEAST_ROWS {
        return Err(RecordingError::Short { file: file.to_owned(), rows: rows.len() });
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::panic)]
    use super::*;

    fn text(header: &str, row: impl Fn(usize) -> String) -> String {
        let rows: String = (0..120).map(|k| row(k) + "\n").collect();
        format!("{header}\n{rows}")
    }

    fn parsed(text: &str) -> Result<Recorded, RecordingError> {
        parse(Path::new("a.csv"), text.as_bytes(), &Columns::default())
    }

    #[test]
    fn columns_are_found_by_their_names() {
        let commanded = text("T_s,note,u_V,position_mm", |k| format!("{},,{},{}", k as f64 * 0.01, k % 7, k));
        let Recorded::Commanded(record, column) = parsed(&commanded).unwrap() else { panic!() };
        assert_eq!((record.time_s.len(), record.command_v[8], column.as_str()), (120, 1.0, "u_V"));
        let pushed = text("t_s,x_mm,F_N", |k| format!("{},{},{}", k, k % 9, 5));
        assert!(matches!(parsed(&pushed).unwrap(), Recorded::Pushed(_)));
    }

    #[test]
    fn mistakes_are_told_with_their_place() {
        let word = text("t,u,x", |k| format!("{k},{},{}", k % 3, if k == 5 { "high".into() } else { k.to_string() }));
        assert_eq!(parsed(&word).unwrap_err().to_string(), "a.csv, line 7, column x: \"high\"; expected a number");
        let back = text("t,u,x", |k| format!("{},{},{k}", if k == 9 { 1 } else { k }, k % 3));
        assert!(parsed(&back).unwrap_err().to_string().starts_with("a.csv, line 11: time goes from 8 s to 1 s"));
        let still = text("t,u,x", |k| format!("{k},2,{k}"));
        assert_eq!(
            parsed(&still).unwrap_err().to_string(),
            "a.csv: the command is 2 in every row; expected one that moves"
        );
        let none = text("t,x,z", |k| format!("{k},{k},{k}"));
        assert!(parsed(&none).unwrap_err().to_string().starts_with("a.csv: no column for the command among t, x, z;"));
        let short = "t,u,x\n0,1,2\n1,2,3\n";
        assert_eq!(parsed(short).unwrap_err().to_string(), "a.csv: 2 rows with numbers; expected at least 100");
        let nan = text("t,u,x", |k| format!("{k},{},NaN", k % 2));
        assert!(parsed(&nan).unwrap_err().to_string().contains("line 2, column x: \"NaN\""));
    }
}
