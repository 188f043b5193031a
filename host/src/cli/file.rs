//! Files that commands write.

use std::path::Path;

use miette::IntoDiagnostic;

/// Writes a file, and makes its folder where there is none; a file of another kind is not replaced.
pub(super) fn save(file: &Path, bytes: &[u8]) -> miette::Result<()> {
    crate::ownership::write_file(file, bytes, "the option that names it").into_diagnostic()
}
