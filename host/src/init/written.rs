//! How a text file is written: encoding, character between cells, decimal sign.

use std::path::Path;

use crate::experiment::ExperimentError;
use crate::experiment::file::content::utf16;
use crate::experiment::file::number::Digits;
use crate::experiment::file::table::{Row, Table};
use crate::experiment::file::{clock, text};

/// Lines that are tried with every delimiter.
const TRIED: usize = 3000;

/// What was found, and the cells that follow from it.
pub(super) struct Written {
    /// Label to state; `None` where the default reads the file.
    pub encoding: Option<&'static str>,
    /// Character between cells.
    pub delimiter: u8,
    /// Signs in numbers.
    pub digits: Digits,
    /// All rows.
    pub table: Table,
}

/// True for a cell that a column of data may hold.
pub(super) fn is_value(digits: Digits, cell: &str) -> bool {
    digits.are(cell) || clock::is_clock(cell) || cell.eq_ignore_ascii_case("nan")
}

/// Cells of a row that hold values, and those that hold anything.
pub(super) fn counts(digits: Digits, row: Row<'_>) -> (usize, usize) {
    row.cells()
        .filter(|cell| !cell.is_empty())
        .fold((0, 0), |(values, filled), cell| (values + usize::from(is_value(digits, cell)), filled + 1))
}

/// Looks at the bytes of a text file.
pub(super) fn written(path: &Path, bytes: &[u8]) -> Result<Written, ExperimentError> {
    let marked = encoding_rs::Encoding::for_bom(bytes).is_some();
    let encoding = match utf16(bytes) {
        _ if marked => None,
        Some(label) => Some(label),
        None => std::str::from_utf8(bytes).is_err().then_some("latin1"),
    };
    let text = text::decoded(path, bytes, encoding.unwrap_or("utf-8"))?;
    let end = text.match_indices('\n').nth(TRIED).map_or(text.len(), |(at, _)| at);
    let mut best: Option<(f64, u8, Digits)> = None;
    for (delimiter, digits) in ways() {
        let Some(table) = cells(&text[..end], delimiter) else { continue };
        let score = table.rows_from(0).map(|row| clarity(digits, row)).sum();
        if best.is_none_or(|(most, ..)| score > most * 1.001) {
            best = Some((score, delimiter, digits));
        }
    }
    let (_, delimiter, digits) = best.unwrap_or((0.0, b',', Digits { decimal: '.', thousands: None }));
    let table = cells(&text, delimiter).unwrap_or_default();
    Ok(Written { encoding, delimiter, digits, table })
}

/// Delimiters and signs, the commonest first: what comes first wins where both read all.
fn ways() -> impl Iterator<Item = (u8, Digits)> {
    let signs = [('.', None), (',', None), (',', Some('.')), ('.', Some(','))];
    signs.into_iter().flat_map(|(decimal, thousands)| {
        let delimiters = [b'\t', b';', b',', b'|', b' '];
        let apart = move |delimiter: &u8| {
            let mark = *delimiter as char;
            mark != decimal && (thousands != Some(mark))
        };
        delimiters.into_iter().filter(apart).map(move |delimiter| (delimiter, Digits { decimal, thousands }))
    })
}

fn cells(text: &str, delimiter: u8) -> Option<Table> {
    match delimiter {
        b' ' => Some(text::by_blanks(text, 1)),
        _ => text::delimited(text, 1, delimiter).ok(),
    }
}

/// How much of a row is numbers, squared over its cells: one wrong cut costs more than a column of words.
fn clarity(digits: Digits, row: Row<'_>) -> f64 {
    let (values, filled) = counts(digits, row);
    if values < 2 || 2 * values < filled { 0.0 } else { (values * values) as f64 / filled as f64 }
}
