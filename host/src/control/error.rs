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
    /// A curve of a material that the library does not have.
    #[error("{}: material \"{material}\" is not in the library; expected one of {known}", file.display())]
    Stranger {
        /// The file.
        file: PathBuf,
        /// Its material.
        material: String,
        /// What the library has.
        known: String,
    },
    /// Two curves of one material.
    #[error(
        "{}: material \"{material}\" has a curve already, {}; expected one file a material",
        file.display(),
        other.display()
    )]
    Twice {
        /// The second file.
        file: PathBuf,
        /// The first.
        other: PathBuf,
        /// The material.
        material: String,
    },
    /// Curves of two displays.
    #[error("{}: for {is}; expected {was}, as {}: a display has one magnet and one fluid", file.display(), other.display())]
    OtherDisplay {
        /// The second file.
        file: PathBuf,
        /// Its magnet and fluid.
        is: String,
        /// The first file.
        other: PathBuf,
        /// Magnet and fluid of the first.
        was: String,
    },
}
