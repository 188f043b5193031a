//! A displacement table as a file.
//!
//! ```text
//! # material = EVA
//! # branch = loading
//! # cap_mm2 = 314
//! # thickness_mm = 12.7
//! # provenance = palpate displacement
//! force_N,shaft_mm
//! 0,0
//! 0.5,0.31
//! ```

use std::path::Path;

use protocol::lut::{DisplaySpec, MAX_NODES};

use crate::control::CurveError;

/// Places of the shaft over the finger's force.
#[derive(Debug, Clone, PartialEq)]
pub struct Displacement {
    /// Material that is displayed.
    pub material: String,
    /// Way that was recorded: loading or unloading.
    pub branch: String,
    /// Area of the cap, mm2.
    pub cap_mm2: f64,
    /// Thickness of the displayed material, mm.
    pub thickness_mm: f64,
    /// How it was made.
    pub provenance: String,
    /// Force, N, rising from 0, and place of the shaft, mm.
    pub rows: Vec<(f64, f64)>,
}

/// Largest force or place of a cell: what a table's counts hold with room.
const MOST: f64 = 1e6;

impl Displacement {
    /// The same as a display curve of a table.
    #[must_use]
    pub fn display(&self) -> DisplaySpec {
        let (force_n, shaft_mm) = self.rows.iter().copied().unzip();
        DisplaySpec { force_n, shaft_mm, coil: None }
    }

    /// The file's text, which [`Displacement::parse`] reads back.
    #[must_use]
    pub fn to_csv(&self) -> String {
        let one_line = |text: &str| text.replace(char::is_control, " ").trim().to_owned();
        let mut text = format!(
            "# material = {}\n# branch = {}\n# cap_mm2 = {}\n# thickness_mm = {}\n# provenance = {}\nforce_N,shaft_mm\n",
            one_line(&self.material),
            self.branch,
            self.cap_mm2,
            self.thickness_mm,
            one_line(&self.provenance)
        );
        self.rows.iter().for_each(|(force_n, shaft_mm)| text.push_str(&format!("{force_n},{shaft_mm}\n")));
        text
    }

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
    /// As [`Displacement::read`].
    pub fn parse(file: &Path, text: &str) -> Result<Self, CurveError> {
        let lines = || text.strip_prefix('\u{feff}').unwrap_or(text).lines().enumerate();
        let key = |wanted: &str| {
            let pairs = lines().filter_map(|(at, line)| Some((at, line.trim().strip_prefix('#')?.split_once('=')?)));
            let mut found =
                pairs.filter(|(_, (key, _))| key.trim() == wanted).map(|(at, (_, value))| (at + 1, value.trim()));
            found.next().filter(|(_, value)| !value.is_empty())
        };
        let given = |name: &'static str, expected: &'static str| {
            key(name).ok_or(CurveError::Missing { file: file.to_owned(), key: name, expected })
        };
        let number = |name: &'static str, expected: &'static str| {
            let (line, value) = given(name, expected)?;
            let wrong = || {
                let (key, value) = (name.to_owned(), value.to_owned());
                CurveError::Key { file: file.to_owned(), line, key, value, expected: expected.to_owned() }
            };
            value.parse::<f64>().ok().filter(|v| *v > 0.0 && *v <= MOST).ok_or_else(wrong)
        };
        Ok(Displacement {
            material: given("material", "the name of the material that is displayed")?.1.to_owned(),
            branch: key("branch").map_or("loading", |(_, value)| value).to_owned(),
            cap_mm2: number("cap_mm2", "the area of the cap, mm2, above 0")?,
            thickness_mm: number("thickness_mm", "the thickness of the displayed material, mm, above 0")?,
            provenance: given("provenance", "how the table was made")?.1.to_owned(),
            rows: rows(file, lines())?,
        })
    }
}

fn rows<'a>(file: &Path, lines: impl Iterator<Item = (usize, &'a str)>) -> Result<Vec<(f64, f64)>, CurveError> {
    const COLUMNS: [&str; 2] = ["force_N", "shaft_mm"];
    let mut rows: Vec<(f64, f64)> = Vec::new();
    let mut headed = false;
    for (at, content) in lines {
        let content = content.trim();
        if content.is_empty() || content.starts_with('#') {
            continue;
        }
        let cells: Vec<&str> = content.split(',').map(str::trim).collect();
        let wrong = |column: usize, expected: String| CurveError::Cell {
            file: file.to_owned(),
            line: at + 1,
            number: column + 1,
            name: COLUMNS[column],
            value: cells.get(column).copied().unwrap_or_default().to_owned(),
            expected,
        };
        if !headed {
            if let Some(column) = (0..2).find(|c| cells.get(*c) != Some(&COLUMNS[*c])) {
                return Err(wrong(column, "the columns force_N,shaft_mm".to_owned()));
            }
            headed = true;
            continue;
        }
        let cell = |column: usize| {
            let value =
                cells.get(column).and_then(|text| text.parse::<f64>().ok()).filter(|v| (0.0..=MOST).contains(v));
            value.ok_or_else(|| wrong(column, "a number, 0 or more".to_owned()))
        };
        let row = (cell(0)?, cell(1)?);
        match rows.last() {
            None if row.0 != 0.0 => return Err(wrong(0, "a first row without force, 0".to_owned())),
            Some(last) if row.0 <= last.0 => {
                return Err(wrong(0, format!("a force above the {} N of the row before", last.0)));
            }
            _ => rows.push(row),
        }
    }
    if !(2..=MAX_NODES).contains(&rows.len()) {
        return Err(CurveError::Rows {
            file: file.to_owned(),
            rows: rows.len(),
            expected: format!("2 to {MAX_NODES}"),
        });
    }
    Ok(rows)
}
