//! One data file: cells to numbers, with the place of every cell that is none.

use std::collections::BTreeMap;
use std::path::Path;

use super::error::{ExperimentError, Problem};
use super::{Format, Mapping, Test};

/// The samples of a run. The vectors that a kind of test does not have are empty, all others
/// have the same length.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Recording {
    /// Time in s, not falling.
    pub time_s: Vec<f64>,
    /// Position of the indenter in mm, growing into the specimen; its zero is not trusted.
    pub depth_mm: Vec<f64>,
    /// Force into the specimen in N.
    pub force_n: Vec<f64>,
    /// All other columns that hold numbers, by name; NaN where a cell holds none.
    pub others: BTreeMap<String, Vec<f64>>,
    /// Line of the file (from 1) that each sample stands in.
    pub line: Vec<usize>,
    depth_field: Option<(usize, String)>,
}

impl Recording {
    /// A recording made in memory, for models and tests.
    ///
    /// Vectors of different lengths are cut to the shortest.
    pub fn from_samples(time_s: Vec<f64>, depth_mm: Vec<f64>, force_n: Vec<f64>) -> Self {
        let count = time_s.len().min(depth_mm.len()).min(force_n.len());
        let cut = |mut samples: Vec<f64>| {
            samples.truncate(count);
            samples
        };
        Self {
            time_s: cut(time_s),
            depth_mm: cut(depth_mm),
            force_n: cut(force_n),
            line: (2..count + 2).collect(),
            ..Self::default()
        }
    }

    /// The numbers of a column by its name in the contract.
    #[must_use]
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        let found = match name {
            "time_s" => &self.time_s,
            "depth_mm" => &self.depth_mm,
            "force_N" => &self.force_n,
            other => self.others.get(other)?,
        };
        (!found.is_empty()).then_some(found.as_slice())
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.line.len()
    }

    /// No samples at all.
    pub fn is_empty(&self) -> bool {
        self.line.is_empty()
    }

    /// Keeps the samples from a time to another (s).
    pub(super) fn keep_between(&mut self, from_s: f64, to_s: f64) {
        let start = self.time_s.partition_point(|t| *t < from_s);
        let end = self.time_s.partition_point(|t| *t <= to_s).max(start);
        let keep = |values: &mut Vec<f64>| {
            if !values.is_empty() {
                *values = values[start..end].to_vec();
            }
        };
        keep(&mut self.depth_mm);
        keep(&mut self.force_n);
        self.others.values_mut().for_each(keep);
        if !self.time_s.is_empty() {
            self.line = self.line[start..end].to_vec();
        }
        keep(&mut self.time_s);
    }

    /// A pull is recorded with either sign; afterwards elongation and pull count as positive, as depth and force elsewhere.
    pub(super) fn turn_to_push(&mut self) {
        let largest = self.force_n.iter().copied().fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a });
        if largest < 0.0 {
            self.turn();
        }
    }

    /// A display run without what it was told, or without what was measured, says nothing.
    pub(super) fn check_pairs(&self, file: &Path) -> Result<(), ExperimentError> {
        let complete = |(told, measured): &(&str, &str)| self.column(told).is_some() && self.column(measured).is_some();
        if DISPLAY_PAIRS.iter().any(complete) {
            return Ok(());
        }
        let pairs: Vec<String> =
            DISPLAY_PAIRS.iter().map(|(told, measured)| format!("{told} with {measured}")).collect();
        let problem = format!("a display run needs at least one pair of columns: {}", pairs.join(", or "));
        Err(ExperimentError::of_file(file, Problem::Contradiction(problem)))
    }

    /// Depth above the specimen's height is a wrong unit, direction or zero.
    pub(super) fn check_depth(&self, file: &Path, height_mm: f64) -> Result<(), ExperimentError> {
        let Some(at) = self.depth_mm.iter().position(|&depth| depth > height_mm) else {
            return Ok(());
        };
        let problem = Problem::DeeperThanSpecimen { depth_mm: self.depth_mm[at], height_mm };
        let field = self.depth_field.as_ref().map(|(index, name)| (*index, name.as_str()));
        Err(ExperimentError::of_row(file, self.line[at], field, problem))
    }
}

/// Columns of a display run: what it was told and what was measured, in pairs of which a run has at least one.
pub const DISPLAY_PAIRS: [(&str, &str); 4] =
    [("command_mm", "position_mm"), ("reference_N", "force_N"), ("command_A", "current_A"), ("current_A", "flux_T")];

/// Gap of a display's magnet: a column of its own, the same in all rows.
pub const GAP_MM: &str = "gap_mm";

/// Columns that a kind of test cannot do without.
pub(super) struct Need {
    columns: &'static [(&'static str, &'static str)],
    /// Columns that may be missing but must hold numbers where they are there.
    numbers: &'static [&'static str],
}

impl Need {
    pub fn of(test: Test) -> Self {
        const TIME: (&str, &str) = ("time_s", "every run needs time");
        let columns: &[_] = match test {
            Test::Air | Test::Mass => &[TIME, ("force_N", "the run measures force")],
            Test::Display => &[TIME],
            Test::Table => &[],
            _ => &[
                TIME,
                ("depth_mm", "force without depth says nothing"),
                ("force_N", "depth without force says nothing"),
            ],
        };
        let numbers: &[_] = match test {
            Test::Display => {
                &["command_mm", "position_mm", "reference_N", "force_N", "command_A", "current_A", "flux_T", GAP_MM]
            }
            _ => &[],
        };
        Self { columns, numbers }
    }

    fn includes(&self, wanted: &str) -> bool {
        self.columns.iter().any(|(name, _)| *name == wanted)
    }
}

/// A column of the file that is read: its field, its names and its conversion.
struct Field {
    index: usize,
    header: String,
    wanted: String,
    factor: f64,
    required: bool,
}

pub(super) fn read(
    path: &Path,
    need: &Need,
    columns: &BTreeMap<String, Mapping>,
    format: &Format,
) -> Result<Recording, ExperimentError> {
    let bytes =
        std::fs::read(path).map_err(|cause| ExperimentError::of_file(path, Problem::Unreadable(cause.to_string())))?;
    let text = decoded(path, &bytes, &format.encoding)?;
    let (table, first_line) = without_preamble(path, &text, format.skip_lines)?;
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(format.delimiter)
        .flexible(true)
        .trim(csv::Trim::All)
        .from_reader(table.as_bytes());
    let unreadable = |line: usize, cause: csv::Error| {
        ExperimentError::of_row(path, line, None, Problem::Unreadable(cause.to_string()))
    };
    let header = reader.headers().map_err(|cause| unreadable(first_line, cause))?.clone();
    if header.iter().all(str::is_empty) {
        return Err(ExperimentError::of_file(path, Problem::Empty("header line".to_owned())));
    }
    let at_header = |field, problem| ExperimentError::of_row(path, first_line, field, problem);
    let fields = fields(&header, need, columns).map_err(|problem| at_header(None, problem))?;
    let mut rows = Rows { path, format, fields: &fields, values: vec![Vec::new(); fields.len()] };
    let mut lines = Vec::new();
    let mut counter = LineCounter { text: table.as_bytes(), at: 0, line: first_line };
    for row in reader.records() {
        let line_so_far = lines.last().copied().unwrap_or(first_line) + 1;
        let row = row.map_err(|cause| unreadable(line_so_far, cause))?;
        let line = row.position().map_or(line_so_far, |p| counter.line_at(p.byte() as usize));
        // A delimiter at the end of a row opens a cell that nobody meant.
        if row.len() < header.len() || row.iter().skip(header.len()).any(|cell| !cell.is_empty()) {
            let problem = Problem::Ragged { found: row.len(), expected: header.len() };
            return Err(ExperimentError::of_row(path, line, None, problem));
        }
        rows.push(&row, line)?;
        lines.push(line);
    }
    if lines.is_empty() {
        return Err(ExperimentError::of_file(path, Problem::Empty("rows below its header".into())));
    }
    let recording = assembled(&fields, rows.values, lines);
    check_time(path, &fields, &recording)?;
    Ok(recording)
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

fn decoded(path: &Path, bytes: &[u8], label: &str) -> Result<String, ExperimentError> {
    let encoding = encoding_rs::Encoding::for_label(label.as_bytes())
        .ok_or_else(|| ExperimentError::of_file(path, Problem::UnknownEncoding(label.to_owned())))?;
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

fn fields(header: &csv::StringRecord, need: &Need, columns: &BTreeMap<String, Mapping>) -> Result<Vec<Field>, Problem> {
    let names: Vec<String> = header.iter().map(str::to_owned).collect();
    for (at, name) in names.iter().enumerate() {
        if !name.is_empty() && names[..at].contains(name) {
            return Err(Problem::DuplicateColumn(name.clone()));
        }
    }
    let mut wanted: Vec<(String, Mapping, Option<&str>)> = Vec::new();
    for (name, why) in need.columns {
        let plain = Mapping { name: (*name).to_owned(), scale: 1.0, sign: 1.0 };
        let mapping = columns.get(*name).cloned().unwrap_or(plain);
        wanted.push(((*name).to_owned(), mapping, Some(why)));
    }
    for (name, mapping) in columns.iter().filter(|(name, _)| !need.includes(name)) {
        wanted.push((name.clone(), mapping.clone(), None));
    }
    let mut fields = Vec::new();
    for (wanted, mapping, why) in wanted {
        let factor = mapping.scale * mapping.sign;
        match names.iter().position(|name| *name == mapping.name) {
            Some(index) => fields.push(Field { index, header: mapping.name, wanted, factor, required: why.is_some() }),
            None => {
                if let Some(why) = why {
                    let why = why.to_owned();
                    return Err(Problem::MissingColumn { name: mapping.name, why, header: names });
                }
            }
        }
    }
    for (index, name) in names.iter().enumerate() {
        if !name.is_empty() && !fields.iter().any(|field| field.index == index) {
            let header = name.clone();
            fields.push(Field { index, wanted: header.clone(), header, factor: 1.0, required: false });
        }
    }
    for field in &mut fields {
        field.required |= need.numbers.contains(&field.wanted.as_str());
    }
    Ok(fields)
}

/// Numbers read so far, by field.
struct Rows<'a> {
    path: &'a Path,
    format: &'a Format,
    fields: &'a [Field],
    values: Vec<Vec<f64>>,
}

impl Rows<'_> {
    fn push(&mut self, row: &csv::StringRecord, line: usize) -> Result<(), ExperimentError> {
        for (field, values) in self.fields.iter().zip(&mut self.values) {
            let cell = row.get(field.index).unwrap_or_default();
            let value = number(cell, self.format.decimal).map(|value| value * field.factor);
            match value {
                Ok(value) if value.is_finite() => values.push(value),
                _ if !field.required => values.push(f64::NAN),
                Ok(_) => {
                    let place = Some((field.index, field.header.as_str()));
                    let problem = Problem::Infinite(cell.to_owned());
                    return Err(ExperimentError::of_row(self.path, line, place, problem));
                }
                Err(problem) => {
                    let place = Some((field.index, field.header.as_str()));
                    return Err(ExperimentError::of_row(self.path, line, place, problem));
                }
            }
        }
        Ok(())
    }
}

fn number(cell: &str, decimal: char) -> Result<f64, Problem> {
    if cell.is_empty() {
        return Err(Problem::EmptyCell);
    }
    let value: f64 = if decimal == '.' {
        cell.parse()
    } else {
        // A point in a file with decimal commas is a thousands mark or a slip: refuse both.
        if cell.contains('.') {
            return Err(Problem::NotANumber(cell.to_owned()));
        }
        cell.replace(decimal, ".").parse()
    }
    .map_err(|_| Problem::NotANumber(cell.to_owned()))?;
    if value.is_nan() {
        return Err(Problem::Nan(cell.to_owned()));
    }
    if value.is_infinite() {
        return Err(Problem::Infinite(cell.to_owned()));
    }
    Ok(value)
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

fn check_time(path: &Path, fields: &[Field], recording: &Recording) -> Result<(), ExperimentError> {
    let Some(at) = recording.time_s.windows(2).position(|pair| pair[1] < pair[0]) else {
        return Ok(());
    };
    let (before, now) = (recording.time_s[at], recording.time_s[at + 1]);
    let field = fields.iter().find(|field| field.wanted == "time_s");
    let place = field.map(|field| (field.index, field.header.as_str()));
    let problem = Problem::TimeBackwards { before, now };
    Err(ExperimentError::of_row(path, recording.line[at + 1], place, problem))
}
