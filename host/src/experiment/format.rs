//! How data files are written.

/// Which column of the files holds a wanted quantity.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Source {
    /// The `nth` column (from 1) of this name in the header.
    Name {
        /// Name in the header.
        name: String,
        /// Which of several of that name; `None`: there is only one.
        nth: Option<usize>,
    },
    /// Its number in the row, from 1.
    Number(usize),
}

/// Where a wanted column is found in the files, and in which unit and direction.
#[derive(Debug, Clone, PartialEq)]
pub struct Mapping {
    /// The column.
    pub source: Source,
    /// Factor from the file's unit to the wanted one; nothing where none is stated, which counts as 1.
    pub scale: Option<f64>,
    /// +1 or -1: compression and force into the specimen are positive.
    pub sign: f64,
}

impl Mapping {
    /// The column of this name, as it is.
    #[must_use]
    pub fn named(name: &str) -> Self {
        Self { source: Source::Name { name: name.to_owned(), nth: None }, scale: None, sign: 1.0 }
    }

    /// Scale and sign together.
    #[must_use]
    pub fn factor(&self) -> f64 {
        self.scale.unwrap_or(1.0) * self.sign
    }

    /// The column of this number (from 1), as it is.
    #[must_use]
    pub fn numbered(number: usize) -> Self {
        Self { source: Source::Number(number), scale: None, sign: 1.0 }
    }
}

/// One of several parts of a file: a sheet of a workbook, a segment with its own header.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Part {
    /// By what it is called in the file.
    Name(String),
    /// By its place, from 1.
    Number(usize),
}

/// How the data files are written.
#[derive(Debug, Clone, PartialEq)]
pub struct Format {
    /// Character between cells; a blank stands for any number of blanks.
    pub delimiter: u8,
    /// Lines before the header.
    pub skip_lines: usize,
    /// Decimal sign.
    pub decimal: char,
    /// Mark between thousands, if there is one.
    pub thousands: Option<char>,
    /// Label of the text encoding.
    pub encoding: String,
    /// The row under the header holds units.
    pub units_row: bool,
    /// Columns are given by number: a first row of numbers is data, and names may repeat.
    pub by_number: bool,
    /// Sheet of a workbook; `None`: it has only one.
    pub sheet: Option<Part>,
    /// Segment of a file with headers inside; `None`: it has only one.
    pub segment: Option<Part>,
    /// Lines after the data.
    pub footer_lines: usize,
}

impl Default for Format {
    fn default() -> Self {
        Self {
            delimiter: b',',
            skip_lines: 0,
            decimal: '.',
            thousands: None,
            encoding: "utf-8".to_owned(),
            units_row: false,
            by_number: false,
            sheet: None,
            segment: None,
            footer_lines: 0,
        }
    }
}

/// Time of a run whose file has none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Pace {
    /// From row to row, s.
    Interval(f64),
    /// Speed of the indenter on its way, mm/s, in either direction.
    Speed(f64),
}
