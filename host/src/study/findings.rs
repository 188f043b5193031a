//! What a study hands over, and how it is written.

use std::io;
use std::path::{Path, PathBuf};

use serde_json::{Map, Value, json};

use crate::ownership::OwnFolder;
use crate::report::Page;

/// A picture with a name for its file.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// File name without ending.
    pub file: String,
    /// An `<svg>` element.
    pub svg: String,
    /// What is seen.
    pub caption: String,
}

/// A table.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Column heads.
    pub head: Vec<String>,
    /// Rows.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// A table from its heads.
    #[must_use]
    pub fn new(head: &[&str]) -> Self {
        Self { head: head.iter().map(|cell| (*cell).to_owned()).collect(), rows: Vec::new() }
    }

    /// Columns set with spaces, for a terminal: text to the left, numbers to the right.
    #[must_use]
    pub fn text(&self) -> String {
        let all = || std::iter::once(&self.head).chain(&self.rows);
        let width =
            |column: usize| all().filter_map(|row| row.get(column)).map(|cell| cell.chars().count()).max().unwrap_or(0);
        let numeric = |column: usize| self.rows.iter().all(|row| row.get(column).is_none_or(|c| is_number(c)));
        let columns: Vec<(usize, bool)> = (0..self.head.len()).map(|c| (width(c), numeric(c))).collect();
        let line = |row: &Vec<String>| {
            let cells = row.iter().zip(&columns).map(|(cell, (width, numeric))| {
                if *numeric { format!("{cell:>width$}") } else { format!("{cell:width$}") }
            });
            cells.collect::<Vec<_>>().join("  ").trim_end().to_owned() + "\n"
        };
        all().map(line).collect()
    }
}

fn is_number(cell: &str) -> bool {
    cell.is_empty() || cell.parse::<f64>().is_ok()
}

/// What a study found.
#[derive(Debug, Clone, PartialEq)]
pub struct Findings {
    /// Name of the study, also that of its files.
    pub study: &'static str,
    /// Heading.
    pub title: String,
    /// Whose recordings.
    pub subject: String,
    /// What was asked and how it was done.
    pub method: Vec<String>,
    /// What came out, a sentence each.
    pub answer: Vec<String>,
    /// Numbers.
    pub tables: Vec<Table>,
    /// Pictures.
    pub pictures: Vec<Picture>,
    /// Everything for programs.
    pub json: Map<String, Value>,
}

/// Folder of reports where none is asked for.
pub const DEFAULT_FOLDER: &str = "out/study";

impl Findings {
    /// The report page.
    #[must_use]
    pub fn page(&self) -> Page {
        let mut page = Page::new(&self.title, &format!("{}. Units: mm, N, MPa, s.", self.subject));
        page.section("Answer");
        page.list(&self.answer);
        for table in &self.tables {
            let head: Vec<&str> = table.head.iter().map(String::as_str).collect();
            page.table(&head, &table.rows);
        }
        page.section("Pictures");
        for picture in &self.pictures {
            page.figure(&picture.svg, &picture.caption);
        }
        page.section("How");
        page.list(&self.method);
        page
    }

    /// Writes `NAME.html` and an SVG a picture into a folder; returns the page's path.
    ///
    /// # Errors
    /// Those of the file system, and a file in the way that no study wrote.
    pub fn write(&self, folder: &Path) -> io::Result<PathBuf> {
        let mut folder = OwnFolder::open(folder, "--report", Some(DEFAULT_FOLDER))?;
        let page = folder.write(&format!("{}.html", self.study), self.page().html().as_bytes())?;
        for picture in &self.pictures {
            folder.write(&format!("{}.svg", picture.file), picture.svg.as_bytes())?;
        }
        Ok(page)
    }

    /// One object: study, subject, answer, the study's own keys, and where the report is.
    #[must_use]
    pub fn answer(&self, report: Option<&Path>) -> Value {
        let mut answer = Map::new();
        answer.insert("study".to_owned(), json!(self.study));
        answer.insert("subject".to_owned(), json!(self.subject));
        answer.insert("answer".to_owned(), json!(self.answer));
        answer.extend(self.json.clone());
        if let Some(report) = report {
            answer.insert("report".to_owned(), json!(report.display().to_string()));
        }
        Value::Object(answer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_lines_up_and_sets_numbers_to_the_right() {
        let mut table = Table::new(&["ball", "mu"]);
        table.rows.push(vec!["both".to_owned(), "0.2".to_owned()]);
        table.rows.push(vec!["of 4 mm".to_owned(), "0.245".to_owned()]);
        assert_eq!(table.text(), "ball        mu\nboth       0.2\nof 4 mm  0.245\n");
    }
}
