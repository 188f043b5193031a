//! Rows of a segment to the numbers of a recording.

use std::ops::Range;

use super::super::Recording;
use super::super::error::{ExperimentError, Problem};
use super::super::format::Pace;
use super::super::unit::{Quantity, parted, unit};
use super::clock::Clock;
use super::field::Field;
use super::number::{Digits, NotNumber};
use super::row_hint;
use super::segment::{Plan, Segment};
use super::table::{Row, Table};

/// The part of a file's clock that is read.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Window {
    /// First time, s.
    pub from_s: Option<f64>,
    /// Last time, s.
    pub to_s: Option<f64>,
}

/// What a row is read with.
pub(super) struct Reader<'a> {
    pub plan: &'a Plan<'a>,
    pub table: &'a Table,
    pub segment: &'a Segment,
    pub digits: Digits,
}

/// The samples in the window.
pub(super) fn recording(
    plan: &Plan<'_>,
    table: &Table,
    segment: &Segment,
    window: Window,
) -> Result<Recording, ExperimentError> {
    let reader = Reader { plan, table, segment, digits: Digits::of(plan.format) };
    reader.check_units()?;
    let rows = reader.without_empty_end();
    if rows.is_empty() {
        return Err(ExperimentError::of_file(plan.path, Problem::Empty("rows below its header".into())));
    }
    let times = reader.times(rows.clone())?;
    let inside = match inside(&times, window) {
        Some(inside) => rows.start + inside.start..rows.start + inside.end,
        // No row lies there: the caller says so, with the first and the last time.
        None => {
            let known: Vec<f64> = times.into_iter().filter(|time| !time.is_nan()).collect();
            let ends: Vec<f64> = known.first().into_iter().chain(known.last()).copied().collect();
            return Ok(Recording { line: vec![0; ends.len()], time_s: ends, ..Recording::default() });
        }
    };
    let mut recording = reader.numbers(inside.clone())?;
    if reader.has_time() {
        recording.time_s = times[inside.start - rows.start..inside.end - rows.start].to_vec();
        reader.check_time(&recording)?;
    }
    Ok(recording)
}

/// Rows from the first in the window to the last before what is outside: a later time, another segment, a line under the data.
/// What lies between times that are inside is inside, whatever it holds.
fn inside(times: &[f64], window: Window) -> Option<Range<usize>> {
    let end = times.len();
    if window.from_s.is_none() && window.to_s.is_none() {
        return Some(0..end);
    }
    if times.iter().all(|time| time.is_nan()) {
        return Some(0..end);
    }
    let start = match window.from_s {
        Some(from_s) => times.iter().position(|time| *time >= from_s)?,
        None => 0,
    };
    let Some(to_s) = window.to_s else { return Some(start..end) };
    let mut last = f64::NEG_INFINITY;
    // First of the rows without a time since the last row with one.
    let mut gap = None;
    for (at, time) in times.iter().enumerate().skip(start) {
        if time.is_nan() {
            gap = gap.or(Some(at));
        } else if *time > to_s || (gap.is_some() && *time < last) {
            let end = gap.unwrap_or(at);
            return (end > start).then_some(start..end);
        } else {
            (last, gap) = (*time, None);
        }
    }
    let end = gap.unwrap_or(end);
    (end > start).then_some(start..end)
}

impl Reader<'_> {
    /// Refuses a column whose name, or the row of units, says another unit than the one it is read in.
    fn check_units(&self) -> Result<(), ExperimentError> {
        let quantities = [("time_s", Quantity::Time), ("depth_mm", Quantity::Depth), ("force_N", Quantity::Force)];
        let Some(header) = self.segment.header else { return Ok(()) };
        let below = self.plan.format.units_row.then(|| self.table.row(header + 1));
        for field in self.segment.fields.iter().filter(|field| field.required && !field.scale_is_stated) {
            let Some((_, quantity)) = quantities.iter().find(|(wanted, _)| *wanted == field.wanted) else { continue };
            let told = below.map(|row| row.cell(field.index).to_owned()).filter(|cell| unit(cell).is_some());
            let Some(text) = told.or_else(|| parted(&field.header).1) else { continue };
            let Some((_, scale)) = unit(&text).filter(|(its, scale)| its == quantity && (scale - 1.0).abs() > 1e-9)
            else {
                continue;
            };
            let problem =
                Problem::OtherUnit { header: field.header.clone(), wanted: field.wanted.clone(), unit: text, scale };
            let place = Some((field.index, field.header.as_str()));
            return Err(ExperimentError::of_row(self.plan.path, self.table.row(header).line, place, problem));
        }
        Ok(())
    }

    /// The rows up to the last that has anything in a needed column: specimens side by side are of different lengths.
    fn without_empty_end(&self) -> Range<usize> {
        let required: Vec<usize> = self.segment.fields.iter().filter(|f| f.required).map(|f| f.index).collect();
        let mut rows = self.segment.rows.clone();
        let holds = |at: usize| {
            let row = self.table.row(at);
            required.is_empty() || required.iter().any(|index| !row.cell(*index).is_empty())
        };
        while rows.end > rows.start && !holds(rows.end - 1) {
            rows.end -= 1;
        }
        rows
    }

    fn field(&self, wanted: &str) -> Option<&Field> {
        self.segment.fields.iter().find(|field| field.wanted == wanted)
    }

    /// True if every sample has a time.
    fn has_time(&self) -> bool {
        self.plan.need.pace.is_some() || self.field("time_s").is_some_and(|field| field.required)
    }

    /// Time of each row in s; NaN where it has none.
    fn times(&self, rows: Range<usize>) -> Result<Vec<f64>, ExperimentError> {
        match self.plan.need.pace {
            Some(Pace::Interval(interval_s)) => Ok((0..rows.len()).map(|at| at as f64 * interval_s).collect()),
            Some(Pace::Speed(mm_per_s)) => {
                let Some(depth) = self.field("depth_mm") else {
                    let problem =
                        "`rate_mm_per_s` makes time of depth, which the run does not have; state `interval_s`";
                    return Err(ExperimentError::of_file(self.plan.path, Problem::Contradiction(problem.to_owned())));
                };
                Ok(self.travelled(rows, depth, mm_per_s))
            }
            None => Ok(self.field("time_s").map_or(vec![f64::NAN; rows.len()], |field| self.clock(rows, field))),
        }
    }

    /// Time that the indenter needs for its way at a speed.
    fn travelled(&self, rows: Range<usize>, depth: &Field, mm_per_s: f64) -> Vec<f64> {
        let (mut way_mm, mut last) = (0.0, None);
        let time = |at: usize| match self.digits.number(self.table.row(at).cell(depth.index)) {
            Ok(place) => {
                let place_mm = place * depth.factor;
                way_mm += last.map_or(0.0, |last: f64| (place_mm - last).abs());
                last = Some(place_mm);
                way_mm / mm_per_s
            }
            Err(_) => f64::NAN,
        };
        rows.map(time).collect()
    }

    /// Numbers, or clock times counted from the first row: what the first row that has a time has.
    fn clock(&self, rows: Range<usize>, field: &Field) -> Vec<f64> {
        let cell = |at: usize| self.table.row(at).cell(field.index);
        let number = |cell: &str| self.digits.number(cell).ok().map(|time| time * field.factor);
        let first = rows.clone().map(cell).find(|cell| number(cell).is_some() || super::clock::is_clock(cell));
        if first.is_none_or(|cell| number(cell).is_some()) {
            return rows.map(|at| number(cell(at)).filter(|time| time.is_finite()).unwrap_or(f64::NAN)).collect();
        }
        let mut clock = Clock::default();
        rows.map(|at| clock.seconds(cell(at)).unwrap_or(f64::NAN)).collect()
    }

    /// All columns; every needed cell must hold a number.
    fn numbers(&self, rows: Range<usize>) -> Result<Recording, ExperimentError> {
        let fields = &self.segment.fields;
        let mut values: Vec<Vec<f64>> = fields.iter().map(|_| Vec::with_capacity(rows.len())).collect();
        let mut lines = Vec::with_capacity(rows.len());
        for at in rows {
            let row = self.table.row(at);
            self.check_cells(at, row)?;
            for (field, values) in fields.iter().zip(&mut values) {
                let cell = row.cell(field.index);
                let value = self.digits.number(cell).map(|value| value * field.factor);
                match value {
                    Ok(value) if value.is_finite() => values.push(value),
                    _ if !field.required => values.push(f64::NAN),
                    Err(_) if field.wanted == "time_s" && super::clock::is_clock(cell) => values.push(0.0),
                    Ok(_) => return Err(self.bad(at, field, NotNumber::Infinite)),
                    Err(why) => return Err(self.bad(at, field, why)),
                }
            }
            lines.push(row.line);
        }
        Ok(assembled(fields, values, lines))
    }

    /// A cell that is no number, with what may be the cause.
    fn bad(&self, at: usize, field: &Field, why: NotNumber) -> ExperimentError {
        let row = self.table.row(at);
        let place = Some((field.index, field.header.as_str()));
        let problem = row_hint::of_row(self, at, field, why.problem(row.cell(field.index)));
        ExperimentError::of_row(self.plan.path, row.line, place, problem)
    }

    /// A row that ends before a needed cell, or goes on past the header.
    fn check_cells(&self, at: usize, row: Row<'_>) -> Result<(), ExperimentError> {
        let Some(header) = self.segment.header.map(|at| self.table.row(at).len()) else { return Ok(()) };
        let cut = self.segment.fields.iter().any(|field| field.required && field.index >= row.len());
        // A delimiter at the end of a row opens a cell that nobody meant.
        let longer = !self.plan.format.by_number && (header..row.len()).any(|at| !row.cell(at).is_empty());
        if !(cut || longer) {
            return Ok(());
        }
        let problem = row_hint::of_cells(self, at, Problem::Ragged { found: row.len(), expected: header });
        Err(ExperimentError::of_row(self.plan.path, row.line, None, problem))
    }

    fn check_time(&self, recording: &Recording) -> Result<(), ExperimentError> {
        let Some(at) = recording.time_s.windows(2).position(|pair| pair[1] < pair[0]) else {
            return Ok(());
        };
        let (before, now) = (recording.time_s[at], recording.time_s[at + 1]);
        let place = self.field("time_s").map(|field| (field.index, field.header.as_str()));
        let problem = Problem::TimeBackwards { before, now };
        Err(ExperimentError::of_row(self.plan.path, recording.line[at + 1], place, problem))
    }
}

fn assembled(fields: &[Field], values: Vec<Vec<f64>>, line: Vec<usize>) -> Recording {
    let mut recording = Recording { line, ..Recording::default() };
    for (field, values) in fields.iter().zip(values) {
        let is_number = field.required || values.iter().all(|value| value.is_finite());
        match field.wanted.as_str() {
            "time_s" if is_number => recording.time_s = values,
            "depth_mm" if is_number => {
                recording.depth_field = Some((field.index, field.header.clone()));
                recording.depth_mm = values;
            }
            "force_N" if is_number => recording.force_n = values,
            _ if values.iter().any(|value| value.is_finite()) => {
                recording.others.insert(field.wanted.clone(), values);
            }
            _ => {}
        }
    }
    recording
}
