//! Why a file is no control curve.

use std::path::PathBuf;

/// What is wrong with a control curve, and where. The texts are part of the interface.
#[derive(Debug, thiserror::Error)]
pub enum CurveError {
    /// The operating system refused to read the file.
    #[error("{}: cannot be read: {source}", file.display())]
    Unreadable {
        /// The file.
        file: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A `# key = value` line that must be there.
    #[error("{}: the line `# {key} = ...` is missing; expected {expected}", file.display())]
    Missing {
        /// The file.
        file: PathBuf,
        /// The key.
        key: &'static str,
        /// What its value is.
        expected: &'static str,
    },
    /// A `# key = value` line that breaks a rule.
    #[error("{}, line {line}, key {key}: \"{value}\"; expected {expected}", file.display())]
    Key {
        /// The file.
        file: PathBuf,
        /// Line, from 1.
        line: usize,
        /// The key.
        key: String,
        /// What stands there.
        value: String,
        /// What was expected.
        expected: String,
    },
    /// A cell that breaks a rule.
    #[error("{}, line {line}, column {number} ({name}): \"{value}\"; expected {expected}", file.display())]
    Cell {
        /// The file.
        file: PathBuf,
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        number: usize,
        /// Its name.
        name: &'static str,
        /// What stands there.
        value: String,
        /// What was expected.
        expected: String,
    },
    /// Too few or too many rows.
    #[error("{}: {rows} rows; expected {expected}", file.display())]
    Rows {
        /// The file.
        file: PathBuf,
        /// Rows that are there.
        rows: usize,
        /// What was expected.
        expected: String,
    },
}
