//! Files that commands write.

use std::path::Path;

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
