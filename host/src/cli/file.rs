//! Files that commands write.

use std::path::{Path, PathBuf};

use miette::IntoDiagnostic;

/// Writes a file, and makes its folder where there is none; a file of another kind is not replaced.
pub(super) fn save(file: &Path, bytes: &[u8]) -> miette::Result<()> {
    crate::ownership::write_file(file, bytes, "the option that names it").into_diagnostic()
}

/// Copies the text of a file that comes with the program to a new file, and says so.
pub(super) fn copy(file: &Path, text: &str) -> miette::Result<()> {
    if file.exists() {
        return Err(miette::miette!("{} is there already; expected the name of a new file", file.display()));
    }
    save(file, text.as_bytes())?;
    outln!("written {}", file.display());
    Ok(())
}

/// Paths as an answer for programs has them.
pub(super) fn names(files: &[PathBuf]) -> Vec<String> {
    files.iter().map(|file| file.display().to_string()).collect()
}

/// Says where files were written: the first is what people look at.
pub(super) fn told(files: &[PathBuf]) {
    if let Some(first) = files.first() {
        outln!("written {} and {} more files beside it", first.display(), files.len() - 1);
    }
}
