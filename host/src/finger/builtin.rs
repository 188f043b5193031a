//! Fingers that come with the program: files to press and to begin one's own from.

use std::path::{Path, PathBuf};

use super::{Described, parse};
use crate::experiment::{ExperimentError, Problem};

/// A finger that comes with the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BuiltIn {
    /// By what it is called.
    pub name: &'static str,
    /// Its file.
    pub text: &'static str,
}

macro_rules! built_in {
    ($($name:literal),*) => {
        [$(BuiltIn { name: $name, text: include_str!(concat!("../../fingers/", $name, ".toml")) }),*]
    };
}

/// All of them.
pub const BUILT_IN: [BuiltIn; 2] = built_in!["round", "thesis"];

/// The file of a finger and its text: that of this path, or else the one that comes with the program and has this name.
///
/// # Errors
/// A file that cannot be read, or neither file nor name.
pub fn text_of(name_or_path: &str) -> Result<(PathBuf, String), ExperimentError> {
    let file = Path::new(name_or_path);
    if file.is_file() {
        return Ok((file.to_owned(), crate::experiment::text_of(file)?));
    }
    let known = BUILT_IN.iter().find(|finger| finger.name == name_or_path);
    known.map(|finger| (PathBuf::from(finger.name), finger.text.to_owned())).ok_or_else(|| {
        let text = format!("no such file, and no finger of this name; known are {}", names());
        ExperimentError::of_file(file, Problem::Contradiction(text))
    })
}

/// The finger of a file or of a name.
///
/// # Errors
/// As [`text_of`] and [`parse`].
pub fn located(name_or_path: &str) -> Result<Described, ExperimentError> {
    let (file, text) = text_of(name_or_path)?;
    parse(&file, &text)
}

/// What they are called.
pub fn names() -> String {
    BUILT_IN.map(|finger| finger.name).join(", ")
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::panic)]
    use super::*;

    #[test]
    fn every_finger_that_comes_with_the_program_can_be_read() {
        for finger in BUILT_IN {
            let read = located(finger.name).unwrap_or_else(|e| panic!("{e}"));
            assert!(!read.title.is_empty() && !read.source.is_empty(), "{}", finger.name);
        }
        let text = located("thumb").unwrap_err().to_string();
        assert!(text.contains("thumb") && text.contains("no finger of this name; known are round, thesis"), "{text}");
    }
}
