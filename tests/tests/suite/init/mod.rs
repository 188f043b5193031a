//! `palpate init`: from recordings as they are to an experiment that is read, with two numbers and no editor.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod formats;
mod real;
mod walk;

use std::path::{Path, PathBuf};

use palpate::experiment::{self, Experiment};
use palpate::init::{Draft, Options, look, write};

/// Looks at files, writes the experiment into a folder and reads it from there.
fn made(files: &[PathBuf], folder: &Path, options: &Options) -> Option<(Draft, Experiment)> {
    let mut draft = look(files, options);
    if draft.runs.is_empty() {
        return None;
    }
    std::fs::create_dir_all(folder).unwrap();
    draft.check(folder, options);
    write(folder, &draft.text(folder, options)).unwrap();
    let read = experiment::read(folder).unwrap_or_else(|error| panic!("{error}\n{}", draft.text(folder, options)));
    Some((draft, read))
}
