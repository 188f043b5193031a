//! Golden files: bytes that must not change. `PALPATE_BLESS=1 cargo test -p tests` writes them anew.

use std::path::{Path, PathBuf};

/// Path of a golden file.
pub fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("golden").join(name)
}

/// Compares `text` with golden file `name`, or writes the file when blessing.
///
/// # Errors
/// The first line that differs, and how to bless.
pub fn compare(name: &str, text: &str) -> Result<(), String> {
    let path = path(name);
    if std::env::var_os("PALPATE_BLESS").is_some() {
        return std::fs::write(&path, text).map_err(|e| format!("{}: {e}", path.display()));
    }
    let golden = std::fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
    let mut lines = golden.lines().zip(text.lines()).enumerate();
    if let Some((number, (old, new))) = lines.find(|(_, (old, new))| old != new) {
        return Err(format!(
            "{name} line {}:\n  golden {old}\n  now    {new}\nIf the change is meant, raise the version and run PALPATE_BLESS=1 cargo test -p tests",
            number + 1
        ));
    }
    if golden.lines().count() != text.lines().count() {
        return Err(format!("{name}: {} lines, now {}", golden.lines().count(), text.lines().count()));
    }
    Ok(())
}

/// Bytes as hexadecimal digits.
pub fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|b| format!("{b:02x}")).collect()
}
