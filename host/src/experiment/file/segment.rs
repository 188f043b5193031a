//! Headers in a file, and the rows below each.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;

use super::super::error::{ExperimentError, Problem};
use super::super::format::{Format, Mapping, Part, Source};
use super::field::{Field, fields};
use super::header_hint;
use super::need::Need;
use super::number::Digits;
use super::table::{Row, Table};

/// The rows below a header and the columns that it names.
pub(crate) struct Segment {
    /// Row of the header; `None`: the file has none.
    pub header: Option<usize>,
    /// Rows of data, and whatever follows them.
    pub rows: Range<usize>,
    /// Columns that are read.
    pub fields: Vec<Field>,
}

/// What the segments of a file are found by.
pub(crate) struct Plan<'a> {
    pub path: &'a Path,
    pub need: &'a Need,
    pub columns: &'a BTreeMap<String, Mapping>,
    pub format: &'a Format,
}

/// Segments that an error lists.
const LISTED: usize = 12;

impl Plan<'_> {
    /// The segment that the format asks for, or the only one.
    pub fn segment(&self, table: &Table) -> Result<Segment, ExperimentError> {
        let found = match &self.format.segment {
            None => self.only(table)?,
            Some(part) => self.chosen(table, part)?,
        };
        let last = table.len().saturating_sub(self.format.footer_lines);
        let rows = found.rows.start..found.rows.end.min(last).max(found.rows.start);
        Ok(Segment { rows, ..found })
    }

    fn only(&self, table: &Table) -> Result<Segment, ExperimentError> {
        let first = table.row(0);
        if first.is_blank() {
            return Err(ExperimentError::of_file(self.path, Problem::Empty("header line".to_owned())));
        }
        let digits = Digits::of(self.format);
        let is_data = |row: Row<'_>| {
            let places = self.numbers();
            if places.is_empty() {
                row.cells().any(|cell| digits.are(cell))
            } else {
                places.iter().any(|at| digits.are(row.cell(*at)))
            }
        };
        let header = (!(self.format.by_number && is_data(first))).then_some(0);
        let width = if self.format.by_number { widest(table) } else { first.len() };
        let fields = fields(header.map(|at| table.row(at)), width, self.need, self.columns).map_err(|problem| {
            let problem = header_hint::of_header(self, table, problem);
            ExperimentError::of_row(self.path, first.line, None, problem)
        })?;
        let start = header.map_or(0, |at| at + 1) + usize::from(self.format.units_row);
        Ok(Segment { header, rows: start.min(table.len())..table.len(), fields })
    }

    /// Places of the needed columns that are given by number.
    fn numbers(&self) -> Vec<usize> {
        let number = |name: &str| match self.columns.get(name)?.source {
            Source::Number(number) => number.checked_sub(1),
            Source::Name { .. } => None,
        };
        self.need.columns.iter().filter_map(|(name, _)| number(name)).collect()
    }

    /// Columns below a row, if it is a header.
    pub fn below(&self, table: &Table, at: usize) -> Option<Vec<Field>> {
        let row = table.row(at);
        let digits = Digits::of(self.format);
        // Most rows are data; this is asked of millions.
        let first = self.need.columns.first().map(|(name, _)| (*name, self.columns.get(*name).map(|m| &m.source)));
        let maybe = match first? {
            (_, Some(Source::Number(number))) => !digits.are(row.cell(number.saturating_sub(1))),
            (_, Some(Source::Name { name, .. })) => row.cells().any(|cell| cell == name),
            (name, None) => row.cells().any(|cell| cell == name),
        };
        if !maybe {
            return None;
        }
        let found = fields(Some(row), row.len(), self.need, self.columns).ok()?;
        let named = |field: &&Field| field.required && !row.cell(field.index).is_empty();
        if !found.iter().any(|field| field.required) || found.iter().filter(|f| f.required).any(|f| !named(&f)) {
            return None;
        }
        if found.iter().filter(|f| f.required).any(|f| digits.are(row.cell(f.index))) {
            return None;
        }
        // Numbers name no column: data must follow, perhaps after a row of units.
        let data = |at: usize| at < table.len() && is_data(table.row(at), &found, digits);
        (self.numbers().is_empty() || data(at + 1) || data(at + 2)).then_some(found)
    }

    fn chosen(&self, table: &Table, part: &Part) -> Result<Segment, ExperimentError> {
        let mut headers: Vec<(usize, Vec<Field>)> = Vec::new();
        for at in 0..table.len() {
            // Two headers in a row are a header and its units by number.
            let after_header = headers.last().is_some_and(|(last, _)| last + 1 == at && !self.numbers().is_empty());
            if let Some(fields) = self.below(table, at).filter(|_| !after_header) {
                headers.push((at, fields));
            }
        }
        if headers.is_empty() {
            let first = table.row(0);
            let problem = fields(Some(first), first.len(), self.need, self.columns).err();
            let problem = problem.unwrap_or_else(|| Problem::Empty("segment with a header above its rows".to_owned()));
            return Err(ExperimentError::of_row(
                self.path,
                first.line,
                None,
                header_hint::of_header(self, table, problem),
            ));
        }
        let digits = Digits::of(self.format);
        let mut segments: Vec<(String, Segment)> = Vec::new();
        let mut title = 0;
        for (at, (header, fields)) in headers.iter().enumerate() {
            let next = headers.get(at + 1).map_or(table.len(), |(next, _)| *next);
            let start = (header + 1 + usize::from(self.format.units_row)).min(next);
            // What stands between the last row of data and the next header is that one's title.
            let is_data = |row: &usize| is_data(table.row(*row), fields, digits);
            let end = match headers.get(at + 1) {
                Some(_) => (start..next).rev().find(is_data).map_or(start, |last| last + 1),
                None => next,
            };
            let name = (title..*header).map(|at| words(table.row(at))).collect::<Vec<_>>().join(" ");
            segments.push((name, Segment { header: Some(*header), rows: start..end, fields: fields.clone() }));
            title = end;
        }
        pick(segments, part).map_err(|problem| ExperimentError::of_file(self.path, problem))
    }
}

/// The cells of a row of a title, parted by a mark that [`pick`] knows.
fn words(row: Row<'_>) -> String {
    row.cells().filter(|cell| !cell.is_empty()).collect::<Vec<_>>().join("\u{1f}")
}

fn pick(mut segments: Vec<(String, Segment)>, part: &Part) -> Result<Segment, Problem> {
    let at = match part {
        Part::Number(number) => number.checked_sub(1).filter(|at| *at < segments.len()),
        Part::Name(name) => {
            let name = name.to_lowercase();
            let lower = |title: &str| title.to_lowercase();
            let is = |(title, _): &(String, Segment)| {
                let plain = lower(title).replace('\u{1f}', ",");
                plain == name
                    || lower(title).split(['\u{1f}', ' ']).any(|w| w == name)
                    || lower(title).split('\u{1f}').any(|w| w == name)
            };
            let holds = |(title, _): &(String, Segment)| lower(title).replace('\u{1f}', ",").contains(&name);
            let all = |test: &dyn Fn(&(String, Segment)) -> bool| {
                segments.iter().enumerate().filter(|(_, s)| test(s)).map(|(at, _)| at).collect::<Vec<_>>()
            };
            match (&all(&is)[..], &all(&holds)[..]) {
                ([one], _) | ([], [one]) => Some(*one),
                _ => None,
            }
        }
    };
    match at {
        Some(at) => Ok(segments.swap_remove(at).1),
        None => {
            let shown = |(at, (title, _)): (usize, &(String, Segment))| match title.as_str() {
                "" => (at + 1).to_string(),
                title => format!("{} \"{}\"", at + 1, title.replace('\u{1f}', ",")),
            };
            let mut known: Vec<String> = segments.iter().enumerate().take(LISTED).map(shown).collect();
            if segments.len() > LISTED {
                known.push(format!("... {}", segments.len()));
            }
            Err(Problem::UnknownPart { what: "segment", part: part.clone(), known })
        }
    }
}

/// Every required column of the row holds a number or a time.
pub(super) fn is_data(row: Row<'_>, fields: &[Field], digits: Digits) -> bool {
    let mut required = fields.iter().filter(|field| field.required).peekable();
    required.peek().is_some()
        && required.all(|field| {
            let cell = row.cell(field.index);
            digits.are(cell) || (field.wanted == "time_s" && super::clock::is_clock(cell))
        })
}

/// Most cells in a row.
fn widest(table: &Table) -> usize {
    table.rows_from(0).map(Row::len).max().unwrap_or(0)
}
