//! A fingerprint of this crate's sources and of the versions of all it is built from: force models that another version has kept are not those of this one.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};
use std::{error::Error, fs};

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo:rerun-if-changed=src");
    // solvers and their numerics come from other crates
    const VERSIONS: &str = "../Cargo.lock";
    let has_versions = Path::new(VERSIONS).exists();
    if has_versions {
        println!("cargo:rerun-if-changed={VERSIONS}");
    }
    let mut files = Vec::new();
    collect(Path::new("src"), &mut files)?;
    // folders list their files in any order
    files.sort();
    if has_versions {
        files.push(VERSIONS.into());
    }
    let mut hasher = DefaultHasher::new();
    for file in &files {
        (file.to_string_lossy().replace('\\', "/"), fs::read(file)?).hash(&mut hasher);
    }
    println!("cargo:rustc-env=LUT_GEN_FINGERPRINT={:016x}", hasher.finish());
    Ok(())
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) -> Result<(), Box<dyn Error>> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() { collect(&path, files)? } else { files.push(path) }
    }
    Ok(())
}
