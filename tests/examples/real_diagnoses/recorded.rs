//! Where the recordings lie, and tables of numbers in text files.

use std::path::Path;

use palpate::experiment::{self, Experiment};
use tests::shared_or_skipped;

use super::Outcome;

/// The experiment of a folder in `tests/experiments` over a set of recordings, or `None` where they are absent.
pub fn experiment(folder: &str, set: &str) -> Outcome<Option<Experiment>> {
    if shared_or_skipped(set).is_none() {
        return Ok(None);
    }
    Ok(Some(experiment::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("experiments").join(folder))?))
}

/// Rows of numbers of a text file whose columns are set apart by commas, tabs or blanks. Lines that do not begin with as many numbers as
/// are wanted (headers, marks) are left out.
pub fn rows(file: &Path, columns: usize) -> Outcome<Vec<Vec<f64>>> {
    let text = std::fs::read_to_string(file)?;
    let row = |line: &str| -> Option<Vec<f64>> {
        let cells = line.split([',', '\t', ' ']).filter(|cell| !cell.is_empty());
        let numbers: Option<Vec<f64>> = cells.take(columns).map(|cell| cell.trim().parse().ok()).collect();
        numbers.filter(|numbers| numbers.len() == columns && numbers.iter().all(|x: &f64| x.is_finite()))
    };
    let rows: Vec<Vec<f64>> = text.lines().filter_map(row).collect();
    if rows.is_empty() {
        return Err(format!("{}: no line with {columns} numbers", file.display()).into());
    }
    Ok(rows)
}
