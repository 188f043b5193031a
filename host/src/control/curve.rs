//! A control curve as a file.
//!
//! ```text
//! # material = ICF
//! # magnet = ring
//! # finger = index
//! # fluid = MRF-122
//! # bound_A = 0.05
//! # reachable_N = 0.1, 1.8
//! # felt_error = 0.062, 0.102
//! # provenance = palpate control-curve 0.1.0
//! force_N,travel_mm,area_mm2,shaft_mm,yield_kPa,flux_T,current_A,loop_gain
//! 0,0,0,0,0,0,0,0
//! 0.5,1.2,60,1.0,1.1,0.04,0.8,0.3
//! ```
//! Keys stand before the columns, each once, in any order; `felt_error` may be missing. Other lines that begin with `#` are
//! remarks.

use std::path::{Path, PathBuf};

use protocol::lut::{CURRENT_MAX_A, MAX_NODES};

use super::CurveError;

/// Columns of the file, in their order.
pub const COLUMNS: [&str; 8] =
    ["force_N", "travel_mm", "area_mm2", "shaft_mm", "yield_kPa", "flux_T", "current_A", "loop_gain"];

/// Most rows: as many nodes as a table's entry has.
pub const MOST_ROWS: usize = MAX_NODES;

/// What each key of the file holds.
const KEYS: [(&str, &str); 8] = [
    ("material", "the name of the material that is displayed"),
    ("magnet", "the name of the magnet that the current is for"),
    ("finger", "the name of the finger that presses"),
    ("fluid", "the name of the fluid in the gap"),
    ("bound_A", "the largest error of the current, 0 to 2.5 A"),
    ("reachable_N", "two forces, FROM, TO, N, with 0 <= FROM <= TO <= the last force of the curve"),
    ("provenance", "how the curve was made"),
    ("felt_error", "two parts, FORCE, AREA, 0 or more: root mean squares over those of the material"),
];

/// Curves that come with the program: file name and text.
const BUILT_IN: [(&str, &str); 4] = [
    ("a2.csv", include_str!("../../curves/a2.csv")),
    ("b1.csv", include_str!("../../curves/b1.csv")),
    ("eva.csv", include_str!("../../curves/eva.csv")),
    ("icf.csv", include_str!("../../curves/icf.csv")),
];

/// Control curve of a material: what the display must do at each force of the finger.
#[derive(Debug, Clone, PartialEq)]
pub struct ControlCurve {
    /// Material that is displayed.
    pub material: String,
    /// Magnet that the current is for.
    pub magnet: String,
    /// Finger that presses.
    pub finger: String,
    /// Fluid in the gap.
    pub fluid: String,
    /// Largest error of the current, A, 0 to [`CURRENT_MAX_A`].
    pub bound_a: f64,
    /// Forces, N, between which the magnet can make what is wanted; the current is held at its limit
    /// outside.
    pub reachable_n: (f64, f64),
    /// How far force and area that are felt differ from the material's: root mean squares over those of the material;
    /// `None` where nobody tells.
    pub felt_error: Option<(f64, f64)>,
    /// How the curve was made.
    pub provenance: String,
    /// Rows of rising force, the first without force; 2 to [`MOST_ROWS`].
    pub rows: Vec<Row>,
}

/// One force of a control curve. All but the loop gain are 0 or more.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// Force of the finger, N.
    pub force_n: f64,
    /// Travel of the finger that the material gives way, mm.
    pub travel_mm: f64,
    /// Area of the contact, mm2.
    pub area_mm2: f64,
    /// What of the travel the actuator's shaft must give way, mm.
    pub shaft_mm: f64,
    /// Shear yield stress of the fluid, kPa.
    pub yield_kpa: f64,
    /// Flux density in the fluid, T.
    pub flux_t: f64,
    /// Current of the coil, A, at most [`CURRENT_MAX_A`].
    pub current_a: f64,
    /// Gain of the loop of finger and display at this force.
    pub loop_gain: f64,
}

impl Row {
    fn of(cells: [f64; COLUMNS.len()]) -> Self {
        let [force_n, travel_mm, area_mm2, shaft_mm, yield_kpa, flux_t, current_a, loop_gain] = cells;
        Row { force_n, travel_mm, area_mm2, shaft_mm, yield_kpa, flux_t, current_a, loop_gain }
    }

    fn cells(&self) -> [f64; COLUMNS.len()] {
        [
            self.force_n,
            self.travel_mm,
            self.area_mm2,
            self.shaft_mm,
            self.yield_kpa,
            self.flux_t,
            self.current_a,
            self.loop_gain,
        ]
    }
}

impl ControlCurve {
    /// Reads a file.
    ///
    /// # Errors
    /// [`CurveError`]: the first mistake, with its line.
    pub fn read(file: &Path) -> Result<Self, CurveError> {
        let text =
            std::fs::read_to_string(file).map_err(|source| CurveError::Unreadable { file: file.to_owned(), source })?;
        Self::parse(file, &text)
    }

    /// Reads a file's text; `file` is what errors call it.
    ///
    /// # Errors
    /// As [`ControlCurve::read`].
    pub fn parse(file: &Path, text: &str) -> Result<Self, CurveError> {
        let mut reading = Reading { file, keys: Default::default(), headed: false, rows: Vec::new() };
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        for (line, content) in text.lines().enumerate() {
            reading.line(line + 1, content.trim())?;
        }
        reading.end()
    }

    /// The file's text, which [`ControlCurve::parse`] reads back as the same curve.
    ///
    /// # Errors
    /// [`CurveError`] for a curve that would not be read.
    pub fn to_csv(&self) -> Result<String, CurveError> {
        let (from, to) = self.reachable_n;
        let values = [
            Some(self.material.clone()),
            Some(self.magnet.clone()),
            Some(self.finger.clone()),
            Some(self.fluid.clone()),
            Some(self.bound_a.to_string()),
            Some(format!("{from}, {to}")),
            Some(self.provenance.clone()),
            self.felt_error.map(|(force, area)| format!("{force}, {area}")),
        ];
        let mut text = String::new();
        for ((key, expected), value) in KEYS.into_iter().zip(values).filter_map(|(key, value)| Some((key, value?))) {
            // A line's end in a value would be read as another line.
            if value.contains(char::is_control) || value.trim() != value {
                return Err(CurveError::Key {
                    file: PathBuf::from("control curve"),
                    line: text.lines().count() + 1,
                    key: key.to_owned(),
                    value: value.escape_debug().to_string(),
                    expected: format!("{expected}, in one line without spaces at its ends"),
                });
            }
            text.push_str(&format!("# {key} = {value}\n"));
        }
        text.push_str(&COLUMNS.join(","));
        text.push('\n');
        for row in &self.rows {
            text.push_str(&row.cells().map(|cell| cell.to_string()).join(","));
            text.push('\n');
        }
        Self::parse(Path::new("control curve"), &text)?;
        Ok(text)
    }

    /// The curve of a material that comes with the program, by the material's name, in letters of
    /// either case; `None` if there is none.
    pub fn built_in(material: &str) -> Option<Self> {
        Self::all_built_in().find(|curve| curve.material.eq_ignore_ascii_case(material))
    }

    /// All curves that come with the program.
    pub fn all_built_in() -> impl Iterator<Item = Self> {
        // A test reads every one of them.
        BUILT_IN.iter().filter_map(|(file, text)| Self::parse(Path::new(file), text).ok())
    }

    /// The largest force of the curve, N.
    pub fn most_n(&self) -> f64 {
        self.rows.last().map_or(0.0, |row| row.force_n)
    }
}

/// A file that is read line by line.
struct Reading<'a> {
    file: &'a Path,
    /// Line and value of each key.
    keys: [Option<(usize, &'a str)>; KEYS.len()],
    /// The columns' names have been read.
    headed: bool,
    rows: Vec<Row>,
}

impl<'a> Reading<'a> {
    fn line(&mut self, line: usize, content: &'a str) -> Result<(), CurveError> {
        match content.strip_prefix('#') {
            _ if content.is_empty() => Ok(()),
            Some(remark) if !self.headed => match remark.split_once('=') {
                Some((key, value)) => self.key(line, key.trim(), value.trim()),
                None => Ok(()),
            },
            Some(_) => Ok(()),
            None if self.headed => self.row(line, content),
            None => self.head(line, content),
        }
    }

    fn key(&mut self, line: usize, key: &str, value: &'a str) -> Result<(), CurveError> {
        let wrong = |expected: String| {
            let (key, value) = (key.to_owned(), value.to_owned());
            Err(CurveError::Key { file: self.file.to_owned(), line, key, value, expected })
        };
        let Some(at) = KEYS.iter().position(|known| known.0 == key) else {
            return wrong(format!("one of the keys {}", KEYS.map(|known| known.0).join(", ")));
        };
        if let Some((before, _)) = self.keys[at] {
            return wrong(format!("each key once, and it stands in line {before} already"));
        }
        if value.is_empty() {
            return wrong(KEYS[at].1.to_owned());
        }
        self.keys[at] = Some((line, value));
        Ok(())
    }

    fn cell(&self, line: usize, at: usize, value: &str, expected: impl Into<String>) -> CurveError {
        CurveError::Cell {
            file: self.file.to_owned(),
            line,
            number: at + 1,
            name: COLUMNS[at],
            value: value.to_owned(),
            expected: expected.into(),
        }
    }

    fn head(&mut self, line: usize, content: &str) -> Result<(), CurveError> {
        let names: Vec<&str> = content.split(',').map(str::trim).collect();
        for (at, name) in COLUMNS.into_iter().enumerate() {
            let found = names.get(at).copied().unwrap_or_default();
            if found != name {
                return Err(self.cell(line, at, found, format!("the columns {}", COLUMNS.join(","))));
            }
        }
        if let Some(more) = names.get(COLUMNS.len()) {
            return Err(self.cell(line, COLUMNS.len() - 1, more, "no column after this one"));
        }
        self.headed = true;
        Ok(())
    }

    fn row(&mut self, line: usize, content: &str) -> Result<(), CurveError> {
        let texts: Vec<&str> = content.split(',').map(str::trim).collect();
        if let Some(more) = texts.get(COLUMNS.len()) {
            return Err(self.cell(line, COLUMNS.len() - 1, more, "no cell after this column"));
        }
        let mut cells = [0.0; COLUMNS.len()];
        for (at, cell) in cells.iter_mut().enumerate() {
            let text = texts.get(at).copied().unwrap_or_default();
            *cell = self.number(line, at, text)?;
        }
        let row = Row::of(cells);
        match self.rows.last().map(|last| last.force_n) {
            None if row.force_n != 0.0 => return Err(self.cell(line, 0, texts[0], "a first row without force, 0")),
            Some(last) if row.force_n <= last => {
                return Err(self.cell(line, 0, texts[0], format!("a force above the {last} N of the row before")));
            }
            _ => {}
        }
        self.rows.push(row);
        Ok(())
    }

    fn number(&self, line: usize, at: usize, text: &str) -> Result<f64, CurveError> {
        let most_a = f64::from(CURRENT_MAX_A);
        let (range, expected) = match COLUMNS[at] {
            "loop_gain" => (f64::MIN..=f64::MAX, "a number".to_owned()),
            "current_A" => (0.0..=most_a, format!("a current of 0 to {most_a} A")),
            // what a table's counts hold with room
            _ => (0.0..=1e6, "a number, 0 or more".to_owned()),
        };
        match text.parse::<f64>() {
            Ok(number) if range.contains(&number) => Ok(number),
            _ => Err(self.cell(line, at, text, expected)),
        }
    }

    /// Line and value of a key.
    fn value(&self, at: usize) -> Result<(usize, &'a str), CurveError> {
        let (key, expected) = KEYS[at];
        self.keys[at].ok_or_else(|| CurveError::Missing { file: self.file.to_owned(), key, expected })
    }

    fn end(self) -> Result<ControlCurve, CurveError> {
        let text = |at: usize| self.value(at).map(|(_, value)| value.to_owned());
        let wrong = |at: usize, line: usize, value: &str| CurveError::Key {
            file: self.file.to_owned(),
            line,
            key: KEYS[at].0.to_owned(),
            value: value.to_owned(),
            expected: KEYS[at].1.to_owned(),
        };
        if !(2..=MOST_ROWS).contains(&self.rows.len()) {
            let expected = format!("2 to {MOST_ROWS}, below a line {}", COLUMNS.join(","));
            return Err(CurveError::Rows { file: self.file.to_owned(), rows: self.rows.len(), expected });
        }
        let (line, bound) = self.value(4)?;
        let bound_a = bound.parse::<f64>().ok().filter(|a| (0.0..=f64::from(CURRENT_MAX_A)).contains(a));
        let bound_a = bound_a.ok_or_else(|| wrong(4, line, bound))?;
        let (line, reachable) = self.value(5)?;
        let most_n = self.rows.last().map_or(0.0, |row| row.force_n);
        let reachable_n = match two(reachable) {
            Some((from, to)) if 0.0 <= from && from <= to && to <= most_n => (from, to),
            _ => return Err(wrong(5, line, reachable)),
        };
        let felt_error = match self.keys[7] {
            None => None,
            Some((line, text)) => {
                let good = two(text).filter(|(force, area)| (0.0..=1e3).contains(force) && (0.0..=1e3).contains(area));
                Some(good.ok_or_else(|| wrong(7, line, text))?)
            }
        };
        Ok(ControlCurve {
            material: text(0)?,
            magnet: text(1)?,
            finger: text(2)?,
            fluid: text(3)?,
            bound_a,
            reachable_n,
            felt_error,
            provenance: text(6)?,
            rows: self.rows,
        })
    }
}

/// Two numbers with a comma.
fn two(text: &str) -> Option<(f64, f64)> {
    let (first, second) = text.split_once(',')?;
    Some((first.trim().parse().ok()?, second.trim().parse().ok()?))
}

/// Files that come with the program.
#[cfg(test)]
pub(super) const fn built_in_files() -> usize {
    BUILT_IN.len()
}
