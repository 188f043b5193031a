//! Rows of the table thesis, goal, measured.

use std::fmt::Write as _;

/// A figure of the thesis and what became of it.
pub struct Row {
    /// What is measured.
    pub what: &'static str,
    /// Where: a rate, a place.
    pub case: String,
    /// The thesis' figure.
    pub thesis: String,
    /// What is to be reached.
    pub goal: String,
    /// What was measured.
    pub measured: String,
    /// Whether the goal is met; none where it has not been measured.
    pub met: Option<bool>,
}

/// All rows as a table.
pub fn table(rows: &[Row]) -> String {
    let mut out = String::from("| figure | case | thesis | goal | measured | |\n|---|---|---|---|---|---|\n");
    for r in rows {
        let verdict = match r.met {
            Some(true) => "met",
            Some(false) => "MISSED",
            None => "not measured yet",
        };
        let _ = writeln!(out, "| {} | {} | {} | {} | {} | {verdict} |", r.what, r.case, r.thesis, r.goal, r.measured);
    }
    out
}
