//! Sheets of workbooks (xlsx, xlsb, xls, ods) to cells.

use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use calamine::{Data, DataRef, ExcelDateTime, Reader, Sheets};
use jiff::ToSpan;
use jiff::civil::Date;

use super::super::error::{ExperimentError, Problem};
use super::super::format::{Format, Part};
use super::content::Content;
use super::table::Table;

/// Columns of a sheet that are read; a spreadsheet has no more.
const MOST_COLUMNS: u32 = 16_384;

/// An opened workbook.
pub(crate) struct Workbook<'a> {
    path: &'a Path,
    sheets: Sheets<Cursor<&'a [u8]>>,
}

impl<'a> Workbook<'a> {
    /// Opens the bytes of a file.
    pub fn open(path: &'a Path, bytes: &'a [u8]) -> Result<Self, ExperimentError> {
        let what = match Content::of(bytes) {
            Content::Compound => "an old Excel workbook, or one with a password (begins with D0CF11E0)",
            _ => "an Excel or OpenDocument workbook (begins with PK)",
        };
        let opened = guarded(|| calamine::open_workbook_auto_from_rs(Cursor::new(bytes)).map_err(|e| e.to_string()));
        match opened {
            Ok(sheets) => Ok(Self { path, sheets }),
            Err(cause) => Err(ExperimentError::of_file(path, Problem::Workbook { what, cause })),
        }
    }

    /// Names of the sheets.
    pub fn names(&self) -> Vec<String> {
        self.sheets.sheet_names()
    }

    /// The cells of a sheet; numbers are written with the decimal sign `decimal`, times as clock times.
    pub fn table(&mut self, name: &str, decimal: char) -> Result<Table, ExperimentError> {
        let sheets = &mut self.sheets;
        guarded(|| match sheets {
            Sheets::Xlsx(book) => {
                // Cell by cell: a single cell in the far corner must not make a table of that size.
                let mut reader = book.worksheet_cells_reader(name).map_err(|cause| cause.to_string())?;
                let mut filler = Filler::new(decimal);
                while let Some(cell) = reader.next_cell().map_err(|cause| cause.to_string())? {
                    let ((row, column), value) = (cell.get_position(), cell.get_value());
                    match value {
                        DataRef::SharedString(text) => filler.put(row, column, text),
                        other => filler.add(row, column, &Data::from(other.clone())),
                    }
                }
                Ok(filler.finish())
            }
            other => {
                let range = other.worksheet_range(name).map_err(|cause| cause.to_string())?;
                let (top, left) = range.start().unwrap_or((0, 0));
                let mut filler = Filler::new(decimal);
                for (row, column, value) in range.used_cells() {
                    let place = |at: usize, from: u32| u32::try_from(at).unwrap_or(u32::MAX).saturating_add(from);
                    filler.add(place(row, top), place(column, left), value);
                }
                Ok(filler.finish())
            }
        })
        .map_err(|cause| ExperimentError::of_file(self.path, Problem::Unreadable(format!("sheet \"{name}\": {cause}"))))
    }
}

/// The cells of the sheet that the format asks for, or of the only one that is not empty.
pub(super) fn table(path: &Path, bytes: &[u8], format: &Format) -> Result<Table, ExperimentError> {
    let mut book = Workbook::open(path, bytes)?;
    let names = book.names();
    let unknown = |part: &Part| {
        let problem = Problem::UnknownPart { what: "sheet", part: part.clone(), known: names.clone() };
        ExperimentError::of_file(path, problem)
    };
    let table = match &format.sheet {
        Some(part) => {
            let name = match part {
                Part::Number(number) => number.checked_sub(1).and_then(|at| names.get(at)),
                Part::Name(name) => names.iter().find(|n| n.trim() == name),
            };
            book.table(name.ok_or_else(|| unknown(part))?, format.decimal)?
        }
        None => {
            let mut filled = Vec::new();
            for name in &names {
                let table = book.table(name, format.decimal)?;
                if table.len() > 0 {
                    filled.push((name, table));
                }
            }
            if filled.len() > 1 {
                let names = filled.iter().map(|(name, _)| (*name).clone()).collect();
                return Err(ExperimentError::of_file(path, Problem::ManySheets(names)));
            }
            filled.pop().map(|(_, table)| table).unwrap_or_default()
        }
    };
    let table = below(&table, format.skip_lines);
    if table.len() == 0 {
        return Err(ExperimentError::of_file(path, Problem::Empty("header line".to_owned())));
    }
    Ok(table)
}

/// The rows below so many.
fn below(table: &Table, skip_lines: usize) -> Table {
    let mut kept = Table::default();
    for row in table.rows_from(0).filter(|row| row.line > skip_lines) {
        row.cells().for_each(|cell| kept.push(cell));
        kept.end_row(row.line);
    }
    kept
}

/// Runs what others wrote; a panic of theirs is an error.
fn guarded<T>(read: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(read)).unwrap_or_else(|_| Err("its contents are damaged".to_owned()))
}

/// Cells in the order of rows to rows of a table; rows without any are left out.
struct Filler {
    table: Table,
    decimal: char,
    /// Row that is being filled and its next column.
    at: Option<(u32, u32)>,
}

impl Filler {
    fn new(decimal: char) -> Self {
        Self { table: Table::default(), decimal, at: None }
    }

    fn add(&mut self, row: u32, column: u32, value: &Data) {
        match value {
            Data::Empty => {}
            Data::String(text) | Data::DateTimeIso(text) => self.put(row, column, text),
            Data::DurationIso(text) => self.put(row, column, &duration(text).unwrap_or_else(|| text.clone())),
            Data::DateTime(time) => self.put(row, column, &clock(time)),
            Data::Float(number) if self.decimal == ',' => self.put(row, column, &number.to_string().replace('.', ",")),
            other => self.put(row, column, &other.to_string()),
        }
    }

    fn put(&mut self, row: u32, column: u32, text: &str) {
        if text.trim().is_empty() || column >= MOST_COLUMNS {
            return;
        }
        let mut next = match self.at {
            Some((current, next)) if current == row => next,
            Some((current, _)) => {
                self.table.end_row(current as usize + 1);
                0
            }
            None => 0,
        };
        while next < column {
            self.table.push("");
            next += 1;
        }
        self.table.push(text);
        self.at = Some((row, next + 1));
    }

    fn finish(mut self) -> Table {
        if let Some((row, _)) = self.at {
            self.table.end_row(row as usize + 1);
        }
        self.table
    }
}

/// A time of a spreadsheet as text, to the microsecond; without a date where it counts from zero.
fn clock(time: &ExcelDateTime) -> String {
    let days = time.as_f64();
    let whole = if time.is_duration() { 0.0 } else { days.floor() };
    let microseconds = ((days - whole) * 86_400e6).round();
    let (seconds, rest) = ((microseconds / 1e6).floor(), microseconds % 1e6);
    let (hours, minutes, seconds) =
        ((seconds / 3600.0).floor(), (seconds / 60.0).floor() % 60.0, seconds % 60.0 + rest / 1e6);
    let time = format!("{hours:02}:{minutes:02}:{seconds:09.6}");
    let date = Date::new(1899, 12, 30).ok().and_then(|zero| zero.checked_add((whole as i64).days()).ok());
    match date.filter(|_| (1.0..3e6).contains(&whole)) {
        Some(date) if hours < 24.0 => format!("{date} {time}"),
        _ => time,
    }
}

/// "PT00H00M01.5S", as OpenDocument writes durations, as a clock time.
fn duration(text: &str) -> Option<String> {
    let (hours, rest) = text.strip_prefix("PT")?.split_once('H')?;
    let (minutes, seconds) = rest.split_once('M')?;
    Some(format!("{hours}:{minutes}:{}", seconds.strip_suffix('S')?))
}
