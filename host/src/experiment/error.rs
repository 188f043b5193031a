//! What is wrong with an experiment folder, and where.

use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use miette::{Diagnostic, NamedSource, SourceSpan};

use super::format::Part;

/// A column of a text file as a reader would point at it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Column {
    /// Character position in a line of `experiment.toml`, from 1.
    Character(usize),
    /// Field of a data file, from 1, with the name in its header.
    Field(usize, String),
}

impl fmt::Display for Column {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Column::Character(n) => write!(f, "column {n}"),
            Column::Field(n, name) => write!(f, "column {n} ({name})"),
        }
    }
}

/// Kinds of mistakes in an experiment folder.
///
/// The texts are part of the interface and are tested; each names the value that was found and
/// what was expected.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Problem {
    /// The folder or a file it names is not there.
    #[error("no such file: {0}")]
    MissingFile(String),
    /// The operating system refused to read a file.
    #[error("cannot be read: {0}")]
    Unreadable(String),
    /// The text is not in the stated encoding.
    #[error("not valid {0}; state the file's encoding with [format] encoding = \"latin1\"")]
    Encoding(String),
    /// UTF-16 without a mark, read as something else.
    #[error("looks like UTF-16: write encoding = \"{0}\" in [format]")]
    LooksWide(&'static str),
    /// Bytes that no text has.
    #[error("no text and no workbook; expected a table as text (CSV) or a workbook (xlsx, xls, ods)")]
    NotText,
    /// A workbook that cannot be opened.
    #[error(
        "{what} that cannot be read: {cause}; open it, save it again without a password, or export its sheet as CSV"
    )]
    Workbook {
        /// What it looks like.
        what: &'static str,
        /// What the reader of workbooks said.
        cause: String,
    },
    /// A workbook with several sheets of which none is chosen.
    #[error("a workbook with several sheets: {}; write sheet = \"{}\" in [format], of all or of the run", quoted(.0), .0.first().map_or("", String::as_str))]
    ManySheets(Vec<String>),
    /// A sheet or segment that the file does not have, or has twice.
    #[error("no {what} {}, or more than one; the file has: {}", shown(.part), list(.known))]
    UnknownPart {
        /// Sheet or segment.
        what: &'static str,
        /// What was asked for.
        part: Part,
        /// What the file has.
        known: Vec<String>,
    },
    /// A column number beyond the row.
    #[error("`{wanted}` is column {number}, and the rows have {width}")]
    NoSuchColumn {
        /// What is wanted of it.
        wanted: String,
        /// Its number, from 1.
        number: usize,
        /// Cells in a row.
        width: usize,
    },
    /// Columns by number, and one without.
    #[error(
        "`{wanted}` has no column number; the file's first row is data, so that no column is called `{name}`. Write {wanted} = 1 (its number) in [columns]"
    )]
    NoNumber {
        /// What is wanted.
        wanted: String,
        /// The name that was given instead.
        name: String,
    },
    /// A mistake whose cause can be seen.
    #[error("{problem}; {hint}")]
    Hinted {
        /// The mistake.
        problem: Box<Problem>,
        /// The likely cause, and the key that helps.
        hint: String,
    },
    /// `encoding` names nothing that is known.
    #[error("unknown encoding \"{0}\"; expected a label such as \"utf-8\" or \"latin1\"")]
    UnknownEncoding(String),
    /// Not TOML.
    #[error("not valid TOML: {0}")]
    Syntax(String),
    /// A key nobody reads, which is most often a misspelt one.
    #[error("unknown key `{key}` in {table}{}", suggest(.nearest, .known))]
    UnknownKey {
        /// What was written.
        key: String,
        /// The table it stands in.
        table: String,
        /// The known key with the least edits, if one is close.
        nearest: Option<String>,
        /// All keys known there.
        known: Vec<String>,
    },
    /// A required key is absent.
    #[error("{table} lacks the key `{key}` ({expected})")]
    MissingKey {
        /// The key.
        key: String,
        /// The table that lacks it.
        table: String,
        /// What its value should be.
        expected: String,
    },
    /// A value of the wrong type or out of its range.
    #[error("`{key}` is {found}; expected {expected}")]
    BadValue {
        /// The key.
        key: String,
        /// What was found.
        found: String,
        /// What was expected.
        expected: String,
    },
    /// Values that do not go together.
    #[error("{0}")]
    Contradiction(String),
    /// A run names a specimen or indenter that is not described.
    #[error("`{key}` names \"{name}\", which is not described; known: {}", list(.known))]
    UnknownName {
        /// `specimen` or `indenter`.
        key: String,
        /// The name used.
        name: String,
        /// The names described.
        known: Vec<String>,
    },
    /// A data file without a header or without rows.
    #[error("the file has no {0}")]
    Empty(String),
    /// A required column is not in the header.
    #[error("no column `{name}` ({why}); the header has: {}. Map it in [columns] of experiment.toml", list(.header))]
    MissingColumn {
        /// The column as it is called in the file.
        name: String,
        /// Why it is needed.
        why: String,
        /// The names in the header.
        header: Vec<String>,
    },
    /// The same column name twice.
    #[error("the column `{0}` appears twice in the header")]
    DuplicateColumn(String),
    /// A row with more or fewer cells than the header.
    #[error("the row has {found} cells where the header has {expected}")]
    Ragged {
        /// Cells in the row.
        found: usize,
        /// Cells in the header.
        expected: usize,
    },
    /// A cell that is not a number.
    #[error("\"{0}\" is not a number")]
    NotANumber(String),
    /// An empty cell.
    #[error("the cell is empty; expected a number")]
    EmptyCell,
    /// NaN.
    #[error("\"{0}\" is NaN; expected a finite number")]
    Nan(String),
    /// Infinite, or beyond the range of a double.
    #[error("\"{0}\" is infinite; expected a finite number")]
    Infinite(String),
    /// A column in another unit than it is read in.
    #[error(
        "the column is in {unit}; write {wanted} = {{ name = \"{header}\", scale = {scale} }} in [columns] (scale = 1 where its name is wrong)"
    )]
    OtherUnit {
        /// Its name in the header.
        header: String,
        /// Name in the contract.
        wanted: String,
        /// Unit that the file tells.
        unit: String,
        /// Factor to the contract's.
        scale: f64,
    },
    /// Time falls from one row to the next.
    #[error("time goes backwards: {now} s after {before} s")]
    TimeBackwards {
        /// Time in the row before.
        before: f64,
        /// Time in this row.
        now: f64,
    },
    /// The indenter would be under the table the specimen lies on.
    #[error("depth {depth_mm} mm is above the specimen's height of {height_mm} mm{}", unit_hint(*.depth_mm, *.height_mm))]
    DeeperThanSpecimen {
        /// Depth of the row.
        depth_mm: f64,
        /// Declared height.
        height_mm: f64,
    },
}

impl Problem {
    /// The mistake with its likely cause, where one can be seen.
    pub(super) fn with(self, hint: Option<String>) -> Self {
        match hint {
            Some(hint) => Problem::Hinted { problem: Box::new(self), hint },
            None => self,
        }
    }
}

fn quoted(names: &[String]) -> String {
    names.iter().map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(", ")
}

fn shown(part: &Part) -> String {
    match part {
        Part::Name(name) => format!("\"{name}\""),
        Part::Number(number) => number.to_string(),
    }
}

fn list(names: &[String]) -> String {
    if names.is_empty() { "none".to_owned() } else { names.join(", ") }
}

fn suggest(nearest: &Option<String>, known: &[String]) -> String {
    match nearest {
        Some(name) => format!("; did you mean `{name}`?"),
        None => format!("; known keys: {}", list(known)),
    }
}

fn unit_hint(depth_mm: f64, height_mm: f64) -> &'static str {
    if depth_mm > 50.0 * height_mm {
        "; is the column in micrometres? Then write { name = \"...\", scale = 0.001 } in [columns]"
    } else {
        "; check the unit, the direction and the zero of the depth column"
    }
}

/// A mistake with its place, printable with the line that holds it.
#[derive(Debug, thiserror::Error, Diagnostic)]
#[error("{}: {problem}", self.place())]
pub struct ExperimentError {
    /// The file at fault, as the user named its folder.
    pub file: PathBuf,
    /// Line in that file, from 1.
    pub line: Option<usize>,
    /// Column in that line.
    pub column: Option<Column>,
    /// What is wrong.
    pub problem: Box<Problem>,
    #[source_code]
    snippet: Option<Arc<NamedSource<String>>>,
    #[label("here")]
    span: Option<SourceSpan>,
}

impl ExperimentError {
    /// A mistake of a whole file.
    pub fn of_file(file: &Path, problem: Problem) -> Self {
        Self { file: file.to_owned(), line: None, column: None, problem: Box::new(problem), snippet: None, span: None }
    }

    /// A mistake in a line (from 1) of a data file, at a field (from 0) if one is at fault.
    pub fn of_row(file: &Path, line: usize, field: Option<(usize, &str)>, problem: Problem) -> Self {
        let column = field.map(|(index, name)| Column::Field(index + 1, name.to_owned()));
        Self { file: file.to_owned(), line: Some(line), column, problem: Box::new(problem), snippet: None, span: None }
    }

    /// A mistake at a byte range of a text whose lines are shown with the message.
    pub fn of_text(file: &Path, text: &str, span: std::ops::Range<usize>, problem: Problem) -> Self {
        let start = floor_char_boundary(text, span.start);
        let end = floor_char_boundary(text, span.end.max(start));
        let before = &text[..start];
        let line = before.matches('\n').count() + 1;
        let line_start = before.rfind('\n').map_or(0, |at| at + 1);
        let column = before[line_start..].chars().count() + 1;
        let name = file.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
        Self {
            file: file.to_owned(),
            line: Some(line),
            column: Some(Column::Character(column)),
            problem: Box::new(problem),
            snippet: Some(Arc::new(NamedSource::new(name, text.to_owned()))),
            span: Some(SourceSpan::from((start, end - start))),
        }
    }

    fn place(&self) -> String {
        let mut place = self.file.display().to_string();
        if let Some(line) = self.line {
            place.push_str(&format!(", line {line}"));
        }
        if let Some(column) = &self.column {
            place.push_str(&format!(", {column}"));
        }
        place
    }
}

fn floor_char_boundary(text: &str, at: usize) -> usize {
    let mut at = at.min(text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}
