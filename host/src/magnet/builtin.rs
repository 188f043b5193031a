//! Magnets that come with the program: files to run and to begin one's own from.

use std::path::{Path, PathBuf};

use crate::experiment::{ExperimentError, text_of};

/// A magnet that comes with the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BuiltIn {
    /// By what it is called.
    pub name: &'static str,
    /// Its file.
    pub text: &'static str,
}

macro_rules! built_in {
    ($($name:literal),*) => {
        [$(BuiltIn { name: $name, text: include_str!(concat!("../../magnets/", $name, ".toml")) }),*]
    };
}

/// All of them. The first four are after Fig. 49 of the thesis, the rings after Figs. 51 and 90; one ring is what a search found.
pub const BUILT_IN: [BuiltIn; 9] = built_in![
    "quadrupole",
    "quadrupole-joined",
    "closed-circuit",
    "single-magnet",
    "ring",
    "ring-probe",
    "ring-strong",
    "two-rings",
    "pot"
];

/// The file of a magnet and its text: that at `file`, or else the one that comes with the program and is called `name`.
/// `None` for neither.
///
/// # Errors
/// A file that cannot be read.
pub fn located(file: &Path, name: &str) -> Result<Option<(PathBuf, String)>, ExperimentError> {
    if file.is_file() {
        return Ok(Some((file.to_owned(), text_of(file)?)));
    }
    let known = BUILT_IN.iter().find(|magnet| magnet.name == name);
    Ok(known.map(|magnet| (PathBuf::from(magnet.name), magnet.text.to_owned())))
}

/// What they are called.
pub fn names() -> String {
    BUILT_IN.map(|magnet| magnet.name).join(", ")
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::panic)]
    use super::*;

    #[test]
    fn every_magnet_that_comes_with_the_program_can_be_read_and_meshed() {
        for magnet in BUILT_IN {
            let read = super::super::parse(Path::new(magnet.name), magnet.text, &Default::default())
                .unwrap_or_else(|e| panic!("{e}"));
            assert!(read.design.check().is_ok() && !read.title.is_empty(), "{}", magnet.name);
            assert!(read.control.is_some(), "{} says where its flux density is read", magnet.name);
            assert!(!read.source.is_empty(), "{} says where its measures come from", magnet.name);
        }
    }
}
