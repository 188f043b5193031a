//! What may be the cause of a mistake in a row, and the key that would help.

use super::super::error::Problem;
use super::super::format::Pace;
use super::super::unit::is_unit;
use super::clock;
use super::field::Field;
use super::number::Digits;
use super::rows::Reader;
use super::segment::is_data;

/// Rows below a bad one in which a repeated header is looked for.
const TITLE: usize = 6;
/// Most rows under the data that are called a footer.
const FOOTER: usize = 50;

/// A row that ends too early or too late.
pub(super) fn of_cells(reader: &Reader<'_>, at: usize, problem: Problem) -> Problem {
    let row = reader.table.row(at);
    let header = reader.segment.header.map_or(0, |at| reader.table.row(at).len());
    let commas = (row.len() == 2 * header && reader.plan.format.delimiter == b',').then(|| {
        "are these decimal commas? Then the file needs another character between its cells, such as delimiter = \";\", and \
         decimal = \",\" in [format]"
            .to_owned()
    });
    problem.with(commas.or_else(|| of_place(reader, at)))
}

/// A needed cell that holds no number.
pub(super) fn of_row(reader: &Reader<'_>, at: usize, field: &Field, problem: Problem) -> Problem {
    let cell = reader.table.row(at).cell(field.index);
    let hint = units(reader, at)
        .or_else(|| of_place(reader, at))
        .or_else(|| decimals(reader.digits, cell))
        .or_else(|| late(reader, at, field))
        .or_else(|| {
            (field.wanted == "time_s" && cell.contains(':'))
                .then(|| "a time of day is written as 14:03:22.5, or 2024-05-01 14:03:22.5".to_owned())
        });
    problem.with(hint)
}

/// A row of units under the header.
fn units(reader: &Reader<'_>, at: usize) -> Option<String> {
    let row = reader.table.row(at);
    let filled = row.cells().filter(|cell| !cell.is_empty()).count();
    let units = row.cells().filter(|cell| is_unit(cell)).count();
    (at == reader.segment.rows.start && reader.segment.header.is_some() && units > 0 && 2 * units >= filled)
        .then(|| format!("line {} is a row of units: write units_row = true in [format]", row.line))
}

/// A repeated header, or lines under the data.
fn of_place(reader: &Reader<'_>, at: usize) -> Option<String> {
    let (table, segment) = (reader.table, reader.segment);
    let is_data = |at: usize| is_data(table.row(at), &segment.fields, reader.digits);
    if at > segment.rows.start && segment.header.is_some() {
        let rest = at..segment.rows.end.min(at + TITLE);
        if let Some(again) = rest.take_while(|at| !is_data(*at)).find(|at| reader.plan.below(table, *at).is_some()) {
            return Some(format!(
                "the header stands again in line {}: the file holds several segments. Say which with segment = 1 in [format], \
                 or end the run before it with to_s",
                table.row(again).line
            ));
        }
    }
    let left = segment.rows.end - at;
    (at > segment.rows.start && left <= FOOTER && matches!(reader.plan.need.pace, None | Some(Pace::Speed(_))))
        .then(|| (at..segment.rows.end).all(|at| !is_data(at)))
        .filter(|footer| *footer && !half_written(reader, at, left))
        .map(|_| {
            let lines = left + reader.plan.format.footer_lines;
            format!(
                "no line from here on holds data: write footer_lines = {lines} in [format], or end the run with to_s"
            )
        })
}

/// A last row whose time is there: a damaged sample, no line under the data.
fn half_written(reader: &Reader<'_>, at: usize, left: usize) -> bool {
    let time = reader.segment.fields.iter().find(|field| field.wanted == "time_s" && field.required);
    left == 1 && time.is_some_and(|field| reader.digits.are(reader.table.row(at).cell(field.index)))
}

/// Decimal signs and marks between thousands that the format does not state.
fn decimals(digits: Digits, cell: &str) -> Option<String> {
    let is = |decimal, thousands| Digits { decimal, thousands }.are(cell);
    let with_marks = [(',', '.'), ('.', ','), ('.', '\''), (',', ' '), ('.', ' ')];
    if digits.decimal == '.' && is(',', None) {
        return Some("is this a decimal comma? Write decimal = \",\" in [format]".to_owned());
    }
    if digits.decimal == ',' && is('.', None) && !is(',', Some('.')) {
        return Some("is this a decimal point? Write decimal = \".\" in [format]".to_owned());
    }
    let (decimal, mark) = with_marks.into_iter().find(|(decimal, mark)| is(*decimal, Some(*mark)))?;
    let sign = if decimal == digits.decimal { String::new() } else { format!("decimal = \"{decimal}\" and ") };
    Some(format!("are these thousands? Write {sign}thousands = \"{mark}\" in [format]"))
}

/// A sensor that was not ready: all rows before are bad as well, and good ones follow.
fn late(reader: &Reader<'_>, at: usize, field: &Field) -> Option<String> {
    let rows = &reader.segment.rows;
    let good = |at: &usize| reader.digits.are(reader.table.row(*at).cell(field.index));
    if at != rows.start || field.wanted == "time_s" {
        return None;
    }
    let first = (at..rows.end).find(good)?;
    let time = reader.segment.fields.iter().find(|field| field.wanted == "time_s")?;
    let cell = reader.table.row(first).cell(time.index);
    (first > at && reader.digits.are(cell) && !clock::is_clock(cell)).then(|| {
        format!("the first number stands in line {}: write from_s = {cell} in [[run]]", reader.table.row(first).line)
    })
}
