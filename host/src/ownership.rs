//! What commands may write over: what they wrote themselves, and nobody has changed since.
//!
//! A folder that a command fills has a list of the files in it and their hashes, in the form that `sha256sum --check` reads.
//! An existing file that is not in the list, or not as it was written, is somebody's and stays.

use std::collections::BTreeMap;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

/// Name of the list.
const LIST: &str = "written-by-palpate.sha256";

/// Letters and digits of a name, small, with dashes for all else.
pub(crate) fn file_name(name: &str) -> String {
    let words = name.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
    words.collect::<Vec<_>>().join("-").to_ascii_lowercase()
}

/// A folder that a command fills.
#[derive(Debug)]
pub(crate) struct OwnFolder {
    folder: PathBuf,
    /// Option of the command that chooses another folder.
    option: &'static str,
    /// The documented default of a command, which is all its own.
    all_ours: bool,
    /// Hash of each file as it was written, hexadecimal, by name.
    written: BTreeMap<String, String>,
}

fn hash(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

fn named(path: &Path, cause: &io::Error) -> io::Error {
    io::Error::new(cause.kind(), format!("cannot write {}: {cause}", path.display()))
}

/// A file is in the way that is not the command's.
fn foreign(path: &Path, option: &str) -> io::Error {
    let text = format!(
        "{} exists, and palpate did not write it or it was changed since: it is kept, nothing was written over it. \
         Choose another place with {option}, or move the file away",
        path.display()
    );
    io::Error::new(ErrorKind::AlreadyExists, text)
}

impl OwnFolder {
    /// Makes the folder if need be; `default` is the one that the command uses when none is asked for.
    ///
    /// # Errors
    /// The operating system's, with the path.
    pub(crate) fn open(folder: &Path, option: &'static str, default: Option<&str>) -> io::Result<Self> {
        std::fs::create_dir_all(folder).map_err(|cause| named(folder, &cause))?;
        let list = folder.join(LIST);
        let text = match std::fs::read_to_string(&list) {
            Ok(text) => text,
            Err(cause) if cause.kind() == ErrorKind::NotFound => String::new(),
            Err(cause) => return Err(named(&list, &cause)),
        };
        let written = text.lines().filter_map(|line| line.split_once("  "));
        Ok(OwnFolder {
            folder: folder.to_owned(),
            option,
            all_ours: default.is_some_and(|default| folder == Path::new(default)),
            written: written.map(|(hash, name)| (name.to_owned(), hash.to_owned())).collect(),
        })
    }

    /// The file may be written, with whatever content.
    ///
    /// # Errors
    /// One that is not ours is in the way, with its path and the option that helps.
    pub(crate) fn check(&self, name: &str) -> io::Result<()> {
        self.check_for(name, None)
    }

    fn check_for(&self, name: &str, bytes: Option<&[u8]>) -> io::Result<()> {
        let path = self.folder.join(name);
        match std::fs::read(&path) {
            Err(cause) if cause.kind() == ErrorKind::NotFound => Ok(()),
            Err(_) => Err(foreign(&path, self.option)),
            // What has been written already, also by an earlier version, is lost to nobody.
            Ok(found) if self.all_ours || bytes == Some(&found[..]) => Ok(()),
            Ok(found) if self.written.get(name).is_some_and(|known| *known == hash(&found)) => Ok(()),
            Ok(_) => Err(foreign(&path, self.option)),
        }
    }

    /// Writes a file of ours.
    ///
    /// # Errors
    /// As [`OwnFolder::check`], and the operating system's, with the path.
    pub(crate) fn write(&mut self, name: &str, bytes: &[u8]) -> io::Result<PathBuf> {
        self.check_for(name, Some(bytes))?;
        let path = self.folder.join(name);
        std::fs::write(&path, bytes).map_err(|cause| named(&path, &cause))?;
        self.list(name, hash(bytes))?;
        Ok(path)
    }

    /// Removes a file of ours, so that another writer can make it anew; [`OwnFolder::adopt`] then lists it.
    ///
    /// # Errors
    /// As [`OwnFolder::write`].
    pub(crate) fn clear(&mut self, name: &str) -> io::Result<PathBuf> {
        self.check(name)?;
        let path = self.folder.join(name);
        match std::fs::remove_file(&path) {
            Err(cause) if cause.kind() != ErrorKind::NotFound => Err(named(&path, &cause)),
            _ => Ok(path),
        }
    }

    /// Lists a file that another writer has made.
    ///
    /// # Errors
    /// The operating system's, with the path.
    pub(crate) fn adopt(&mut self, name: &str) -> io::Result<()> {
        let path = self.folder.join(name);
        let bytes = std::fs::read(&path).map_err(|cause| named(&path, &cause))?;
        self.list(name, hash(&bytes))
    }

    fn list(&mut self, name: &str, hash: String) -> io::Result<()> {
        self.written.insert(name.to_owned(), hash);
        let text: String = self.written.iter().map(|(name, hash)| format!("{hash}  {name}\n")).collect();
        let list = self.folder.join(LIST);
        std::fs::write(&list, text).map_err(|cause| named(&list, &cause))
    }
}

/// Writes a single file, and makes its folder where there is none; a file of another kind is not replaced.
///
/// # Errors
/// As [`check_file`]; and the operating system's, with the path.
pub(crate) fn write_file(path: &Path, bytes: &[u8], option: &str) -> io::Result<()> {
    check_file(path, bytes, option)?;
    if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        std::fs::create_dir_all(folder).map_err(|cause| named(folder, &cause))?;
    }
    std::fs::write(path, bytes).map_err(|cause| named(path, &cause))
}

/// A file may be written that begins with `bytes`: none is there, or one that begins as palpate begins it, with the same first
/// line of a text, the same eight bytes of anything else.
///
/// # Errors
/// One that begins otherwise is in the way.
pub(crate) fn check_file(path: &Path, bytes: &[u8], option: &str) -> io::Result<()> {
    match std::fs::read(path) {
        Err(cause) if cause.kind() == ErrorKind::NotFound => Ok(()),
        Ok(found) if found.is_empty() || beginning(&found) == beginning(bytes) => Ok(()),
        Ok(_) => Err(foreign(path, option)),
        // A device or a pipe takes what it is given.
        Err(_) if path.exists() && !path.is_file() && !path.is_dir() => Ok(()),
        Err(cause) => Err(named(path, &cause)),
    }
}

/// Length of the mark that tables and sweeps begin with.
const MARK: usize = 8;

/// What tells one kind of file from another.
fn beginning(bytes: &[u8]) -> &[u8] {
    if bytes.iter().take(64).any(|byte| *byte == 0 || !byte.is_ascii()) {
        return bytes.get(..MARK).unwrap_or(bytes);
    }
    let line = bytes.split(|byte| *byte == b'\n').next().unwrap_or_default();
    // A picture is one long line: its first attribute names the format, the rest is this very picture.
    let end = String::from_utf8_lossy(line).find(" viewBox").unwrap_or(line.len());
    line.get(..end).unwrap_or(line)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn what_the_command_wrote_it_may_write_again_and_nothing_else() {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path().join("foam");
        let open = || OwnFolder::open(&folder, "--out", None).unwrap();
        open().write("experiment.toml", b"one").unwrap();
        open().write("experiment.toml", b"two").unwrap();
        let file = folder.join("experiment.toml");
        std::fs::write(&file, "two, and a remark of mine").unwrap();
        let error = open().write("experiment.toml", b"three").unwrap_err().to_string();
        assert_eq!(
            error,
            format!(
                "{} exists, and palpate did not write it or it was changed since: it is kept, nothing was written over it. \
                 Choose another place with --out, or move the file away",
                file.display()
            )
        );
        assert!(open().clear("experiment.toml").is_err() && open().check("experiment.toml").is_err());
        assert_eq!(std::fs::read_to_string(&file).unwrap(), "two, and a remark of mine");
        // The same content again harms nobody, and it is ours from then on.
        open().write("experiment.toml", b"two, and a remark of mine").unwrap();
        open().write("experiment.toml", b"three").unwrap();
        let list = std::fs::read_to_string(folder.join(LIST)).unwrap();
        assert_eq!(list, format!("{}  experiment.toml\n", hash(b"three")));
    }

    #[test]
    fn a_single_file_is_replaced_by_one_of_its_kind_only() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a/model.toml");
        write_file(&file, b"# A model.\nmu = 1\n", "--model").unwrap();
        write_file(&file, b"# A model.\nmu = 2\n", "--model").unwrap();
        std::fs::write(&file, "name = \"my experiment\"\n").unwrap();
        let error = write_file(&file, b"# A model.\nmu = 3\n", "--model").unwrap_err().to_string();
        assert!(error.starts_with(&file.display().to_string()) && error.contains("--model"), "{error}");
        assert_eq!(std::fs::read_to_string(&file).unwrap(), "name = \"my experiment\"\n");
        let picture = folder.path().join("a.svg");
        write_file(&picture, b"<svg xmlns=\"x\" viewBox=\"0 0 1 1\"/>", "--out").unwrap();
        write_file(&picture, b"<svg xmlns=\"x\" viewBox=\"0 0 2 2\"/>", "--out").unwrap();
        std::fs::write(&picture, "<?xml version=\"1.0\"?>\n<svg/>").unwrap();
        assert!(write_file(&picture, b"<svg xmlns=\"x\" viewBox=\"0 0 2 2\"/>", "--out").is_err());
    }
}
