//! Names that no file has yet.

use std::fs::{File, OpenOptions};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use super::LogError;

/// Most recordings of one name, or in one folder.
const MOST: u32 = 100_000;

/// `rec.csv` for the first, then `rec-2.csv`, `rec-3.csv` and so on.
fn numbered(path: &Path, number: u32) -> PathBuf {
    if number < 2 {
        return path.into();
    }
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let mut name = format!("{stem}-{number}");
    if let Some(extension) = path.extension() {
        name = format!("{name}.{}", extension.to_string_lossy());
    }
    path.with_file_name(name)
}

/// Makes the files of a recording, all with the same number: the first for which none of them exists. Two processes
/// that record to the same name at the same time get two numbers.
///
/// # Errors
/// [`LogError`] when a folder or a file cannot be made, or a name is that of something else than a file.
pub(super) fn create_new(paths: &[&Path]) -> Result<Vec<(PathBuf, File)>, LogError> {
    for path in paths {
        if path.exists() && !path.is_file() {
            return Err(LogError::NoFile { path: path.to_path_buf() });
        }
        if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
            std::fs::create_dir_all(folder).map_err(|source| LogError::File { path: folder.into(), source })?;
        }
    }
    first_free(|number| paths.iter().map(|path| numbered(path, number)).collect())
}

/// Makes the files that `names` gives for the first number for which none of them exists.
///
/// # Errors
/// [`LogError`] when a file cannot be made.
pub(super) fn first_free(names: impl Fn(u32) -> Vec<PathBuf>) -> Result<Vec<(PathBuf, File)>, LogError> {
    for number in 1..MOST {
        let wanted = names(number);
        if let Some(made) = all_or_none(&wanted)? {
            return Ok(made);
        }
    }
    let path = names(1).into_iter().next().unwrap_or_default();
    Err(LogError::File { path, source: std::io::Error::other("all the names it could have are taken") })
}

/// `None` when one of the files exists already.
fn all_or_none(wanted: &[PathBuf]) -> Result<Option<Vec<(PathBuf, File)>>, LogError> {
    if wanted.iter().any(|path| path.symlink_metadata().is_ok()) {
        return Ok(None);
    }
    let mut made: Vec<(PathBuf, File)> = Vec::new();
    for path in wanted {
        match OpenOptions::new().write(true).create_new(true).open(path) {
            Ok(file) => made.push((path.clone(), file)),
            Err(source) => {
                // Those made a moment ago are empty, and nobody's.
                for (path, _) in made {
                    let _ = std::fs::remove_file(path);
                }
                return match source.kind() {
                    ErrorKind::AlreadyExists => Ok(None),
                    _ => Err(LogError::File { path: path.clone(), source }),
                };
            }
        }
    }
    Ok(Some(made))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn numbers_stand_before_the_extension() {
        for (path, expected) in [
            ("a/rec.csv", "a/rec-2.csv"),
            ("rec", "rec-2"),
            ("2026-01.tar.csv", "2026-01.tar-2.csv"),
            (".log", ".log-2"),
        ] {
            assert_eq!(numbered(Path::new(path), 1), Path::new(path));
            assert_eq!(numbered(Path::new(path), 2), Path::new(expected));
        }
    }

    #[test]
    fn files_of_a_recording_share_the_first_number_that_is_free_for_all() {
        let folder = tempfile::tempdir().unwrap();
        let [csv, mcap] = ["rec.csv", "rec.mcap"].map(|name| folder.path().join(name));
        std::fs::write(&csv, "mine").unwrap();
        std::fs::write(folder.path().join("rec-2.mcap"), "mine").unwrap();
        let made = create_new(&[&csv, &mcap]).unwrap();
        let names: Vec<_> = made.iter().map(|(path, _)| path.file_name().unwrap().to_owned()).collect();
        assert_eq!(names, ["rec-3.csv", "rec-3.mcap"]);
        assert_eq!(std::fs::read_to_string(&csv).unwrap(), "mine");
        assert!(!mcap.exists());
    }

    #[test]
    fn what_is_no_file_and_what_cannot_be_made_are_named() {
        let folder = tempfile::tempdir().unwrap();
        let error = create_new(&[folder.path()]).unwrap_err().to_string();
        assert_eq!(
            error,
            format!("cannot record to {}: it is not a file; choose another name", folder.path().display())
        );
        let file = folder.path().join("file");
        std::fs::write(&file, "").unwrap();
        let inside = file.join("rec.csv");
        let error = create_new(&[&inside]).unwrap_err().to_string();
        assert!(error.starts_with(&format!("recording {}: ", file.display())), "{error}");
    }
}
