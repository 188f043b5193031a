//! Shared ground of the cross-crate tests: where golden files lie, one sample of every message,
//! force curves of other codes, simulated palpations, experiments with hidden effects, what must hold of any bytes, and the documents that commands rewrite.

pub mod arguments;
pub mod bench;
pub mod bounding;
pub mod display;
pub mod document;
pub mod golden;
pub mod hidden;
pub mod laboratory;
pub mod liver;
pub mod magnets;
pub mod palpations;
pub mod processor;
pub mod recovery;
pub mod reference;
pub mod regressions;
pub mod robustness;
pub mod samples;
pub mod score;
pub mod silent;
pub mod stated;
pub mod thousand;
pub mod tissue;

use std::path::{Path, PathBuf};

/// Folder of reference curves and recordings beside the checkout, or what the environment variable `PALPATE_SHARED` names.
#[must_use]
pub fn shared() -> PathBuf {
    std::env::var_os("PALPATE_SHARED")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared"), PathBuf::from)
}

/// A file or folder in [`shared`], or `None` with a visible message where it is absent.
#[must_use]
pub fn shared_or_skipped(inside: &str) -> Option<PathBuf> {
    let found = shared().join(inside);
    if found.exists() {
        return Some(found);
    }
    println!("SKIPPED: {} not found", found.display());
    None
}
