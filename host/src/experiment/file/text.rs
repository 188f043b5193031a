//! Text files to cells.

use std::path::Path;

use super::super::error::{ExperimentError, Problem};
use super::super::format::Format;
use super::content::{Content, utf16};
use super::table::Table;

/// The cells of a text file below the lines to skip.
pub(crate) fn table(path: &Path, bytes: &[u8], format: &Format) -> Result<Table, ExperimentError> {
    let text = decoded(path, bytes, &format.encoding)?;
    let (text, first_line) = without_preamble(path, &text, format.skip_lines)?;
    if format.delimiter == b' ' {
        return Ok(by_blanks(text, first_line));
    }
    delimited(text, first_line, format.delimiter)
        .map_err(|(line, problem)| ExperimentError::of_row(path, line, None, problem))
}

/// The text in the stated encoding, or in that of its mark.
pub(crate) fn decoded(path: &Path, bytes: &[u8], label: &str) -> Result<String, ExperimentError> {
    let encoding = encoding_rs::Encoding::for_label(label.as_bytes())
        .ok_or_else(|| ExperimentError::of_file(path, Problem::UnknownEncoding(label.to_owned())))?;
    let wide = encoding == encoding_rs::UTF_16LE || encoding == encoding_rs::UTF_16BE;
    if !wide && encoding_rs::Encoding::for_bom(bytes).is_none() {
        if let Some(found) = utf16(bytes) {
            return Err(ExperimentError::of_file(path, Problem::LooksWide(found)));
        }
        if Content::of(bytes) == Content::Other {
            return Err(ExperimentError::of_file(path, Problem::NotText));
        }
    }
    let (text, _, damaged) = encoding.decode(bytes);
    if damaged {
        let problem = Problem::Encoding(encoding.name().to_owned());
        return Err(ExperimentError::of_file(path, problem));
    }
    Ok(text.into_owned())
}

/// The text from the header on, and the number of the header's line.
fn without_preamble<'a>(path: &Path, text: &'a str, skip_lines: usize) -> Result<(&'a str, usize), ExperimentError> {
    let mut rest = text;
    let mut line = 1;
    for _ in 0..skip_lines {
        let Some(end) = rest.find('\n') else {
            let what = format!("line after the {skip_lines} to skip");
            return Err(ExperimentError::of_file(path, Problem::Empty(what)));
        };
        rest = &rest[end + 1..];
        line += 1;
    }
    if rest.trim().is_empty() {
        return Err(ExperimentError::of_file(path, Problem::Empty("header line".to_owned())));
    }
    // The first row of the table is the first line that is not blank.
    while let Some(end) = rest.find('\n') {
        if !rest[..end].trim().is_empty() {
            break;
        }
        rest = &rest[end + 1..];
        line += 1;
    }
    Ok((rest, line))
}

/// Rows of cells with one character between them; an error with its line.
pub(crate) fn delimited(text: &str, first_line: usize, delimiter: u8) -> Result<Table, (usize, Problem)> {
    let mut reader =
        csv::ReaderBuilder::new().delimiter(delimiter).has_headers(false).flexible(true).from_reader(text.as_bytes());
    let mut counter = LineCounter { text: text.as_bytes(), at: 0, line: first_line };
    let mut table = Table::default();
    let mut row = csv::StringRecord::new();
    let mut line = first_line;
    loop {
        match reader.read_record(&mut row) {
            Ok(false) => return Ok(table),
            Ok(true) => {}
            Err(cause) => return Err((line + 1, Problem::Unreadable(cause.to_string()))),
        }
        line = row.position().map_or(line + 1, |place| counter.line_at(place.byte() as usize));
        row.iter().for_each(|cell| table.push(cell));
        table.end_row(line);
    }
}

/// Rows of cells with any number of blanks between them; quotes hold blanks together.
pub(crate) fn by_blanks(text: &str, first_line: usize) -> Table {
    let mut table = Table::default();
    for (line, text) in (first_line..).zip(text.lines()) {
        let mut rest = text.trim();
        if rest.is_empty() {
            continue;
        }
        while !rest.is_empty() {
            let quoted = rest.strip_prefix('"').and_then(|inner| inner.split_once('"'));
            let (cell, after) = quoted.unwrap_or_else(|| rest.split_once(char::is_whitespace).unwrap_or((rest, "")));
            table.push(cell);
            rest = after.trim_start();
        }
        table.end_row(line);
    }
    table
}

/// Line numbers as an editor shows them, blank lines and either line end included. (A csv reader
/// places a row before the line ends that precede it.)
struct LineCounter<'a> {
    text: &'a [u8],
    at: usize,
    line: usize,
}

impl LineCounter<'_> {
    /// Line of the row that starts at or after a byte; bytes must not fall from call to call.
    fn line_at(&mut self, byte: usize) -> usize {
        while let Some(letter) = self.text.get(self.at) {
            if self.at >= byte && !matches!(letter, b'\r' | b'\n') {
                break;
            }
            self.line += usize::from(*letter == b'\n');
            self.at += 1;
        }
        self.line
    }
}
