//! Files that commands write.

use std::path::Path;

use miette::{IntoDiagnostic, WrapErr};

/// Writes a file, and makes its folder where there is none.
pub(super) fn save(file: &Path, bytes: &[u8]) -> miette::Result<()> {
    if let Some(folder) = file.parent() {
        std::fs::create_dir_all(folder)
            .into_diagnostic()
            .wrap_err_with(|| format!("cannot make the folder {}", folder.display()))?;
    }
    std::fs::write(file, bytes).into_diagnostic().wrap_err_with(|| format!("cannot write {}", file.display()))
}
