//! The folder of one call: where it is, and that nothing of anybody else is written over.

use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use jiff::Timestamp;

use crate::report::{MARK, Page};

/// File by which a folder is known as one of ours.
const PROVENANCE: &str = "provenance.json";
/// Most folders of one name.
const MOST_ALIKE: usize = 1000;
/// Longest part of a folder's name that comes from the experiment, characters.
const LONGEST_NAME: usize = 60;

/// Where results go.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Place {
    /// A new folder below this one, named after experiment and date.
    Below(PathBuf),
    /// A new folder below that of a table, named after the experiment alone.
    Inside(PathBuf),
    /// This folder; what an earlier call wrote there is replaced.
    Named(PathBuf),
}

/// Why results could not be kept.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum FolderError {
    /// The file system refused.
    #[error("cannot write the results to {path}: {cause}; --report DIR names another folder")]
    Refused {
        /// Folder or file.
        path: String,
        /// Why.
        cause: io::Error,
    },
    /// A file that no call of ours wrote has the name of one of our files.
    #[error("{path} was not written by palpate and is kept; --report DIR names another folder for the results")]
    Foreign {
        /// The file.
        path: String,
    },
}

impl FolderError {
    fn refused(path: &Path) -> impl FnOnce(io::Error) -> Self {
        let path = path.display().to_string();
        move |cause| Self::Refused { path, cause }
    }
}

/// The folder of one call.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
    /// Copy of the newest page, beside the folders of all calls.
    newest: Option<PathBuf>,
    /// What stands there comes from an earlier call.
    ours: bool,
}

impl Folder {
    /// Makes the folder of a call that was made `at` a time on an experiment.
    ///
    /// # Errors
    /// [`FolderError::Refused`] where no folder can be made.
    pub fn open(place: &Place, experiment: &str, at: Timestamp) -> Result<Self, FolderError> {
        match place {
            Place::Named(path) => {
                fs::create_dir_all(path).map_err(FolderError::refused(path))?;
                let ours = is_ours(path);
                if ours {
                    clear_figures(&path.join("figures")).map_err(FolderError::refused(path))?;
                }
                Ok(Self { path: path.clone(), newest: None, ours })
            }
            Place::Inside(root) => {
                let name = plain(experiment);
                let path = fresh(root, &name).map_err(FolderError::refused(&root.join(&name)))?;
                Ok(Self { path, newest: None, ours: false })
            }
            Place::Below(root) => {
                let name = format!("{}-{}", plain(experiment), at.strftime("%Y%m%dT%H%M%SZ"));
                let path = fresh(root, &name).map_err(FolderError::refused(&root.join(&name)))?;
                Ok(Self { path, newest: Some(root.join("report.html")), ours: false })
            }
        }
    }

    /// Where it is.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes a file of the folder.
    ///
    /// # Errors
    /// [`FolderError`].
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<PathBuf, FolderError> {
        let file = self.path.join(name);
        if !self.ours && file.exists() && name != PROVENANCE {
            return Err(FolderError::Foreign { path: file.display().to_string() });
        }
        if let Some(folder) = file.parent() {
            fs::create_dir_all(folder).map_err(FolderError::refused(folder))?;
        }
        fs::write(&file, bytes).map_err(FolderError::refused(&file))?;
        Ok(file)
    }

    /// Writes where the results come from, by which later calls know the folder.
    ///
    /// # Errors
    /// [`FolderError`].
    pub fn sign(&self, provenance: &serde_json::Value) -> Result<(), FolderError> {
        if !self.ours && self.path.join(PROVENANCE).exists() {
            return Err(FolderError::Foreign { path: self.path.join(PROVENANCE).display().to_string() });
        }
        self.write(PROVENANCE, format!("{provenance:#}\n").as_bytes()).map(|_| ())
    }

    /// Writes a page, its figures beside it as files, and where calls have folders of their own the copy of the newest.
    ///
    /// # Errors
    /// [`FolderError`].
    pub fn page(&self, name: &str, page: &Page) -> Result<PathBuf, FolderError> {
        let file = self.write(name, page.html().as_bytes())?;
        let stem = name.trim_end_matches(".html");
        for (at, picture) in page.pictures().iter().enumerate() {
            let of = if stem == "report" { String::new() } else { format!("{stem}-") };
            let title = plain(&picture.title);
            self.write(&format!("figures/{of}{:02}-{title}.svg", at + 1), picture.svg.as_bytes())?;
        }
        if let Some(newest) = self.newest.as_ref().filter(|_| stem == "report") {
            let foreign = fs::read_to_string(newest).is_ok_and(|text| !text.contains(MARK));
            if !foreign {
                fs::write(newest, page.html()).map_err(FolderError::refused(newest))?;
            }
        }
        Ok(file)
    }
}

/// A folder that did not exist; of several made in one second the later ones are numbered.
fn fresh(root: &Path, name: &str) -> io::Result<PathBuf> {
    fs::create_dir_all(root)?;
    for at in 1..=MOST_ALIKE {
        let path = if at == 1 { root.join(name) } else { root.join(format!("{name}-{at}")) };
        match fs::create_dir(&path) {
            Err(cause) if cause.kind() == ErrorKind::AlreadyExists => {}
            made => return made.map(|()| path),
        }
    }
    Err(io::Error::new(ErrorKind::AlreadyExists, format!("there are {MOST_ALIKE} folders of that name")))
}

fn is_ours(path: &Path) -> bool {
    let text = fs::read_to_string(path.join(PROVENANCE)).unwrap_or_default();
    serde_json::from_str(&text).is_ok_and(|told: serde_json::Value| told["program"] == super::provenance::PROGRAM)
}

/// Removes figures of an earlier call, numbered as ours are: there may be fewer this time.
fn clear_figures(folder: &Path) -> io::Result<()> {
    let Ok(entries) = fs::read_dir(folder) else { return Ok(()) };
    for entry in entries {
        let path = entry?.path();
        if path.extension().is_some_and(|ending| ending == "svg") {
            fs::remove_file(path)?;
        }
    }
    Ok(())
}

/// A name that any file system takes: letters and figures, everything else a dash.
#[must_use]
pub fn plain(name: &str) -> String {
    let mut out = String::new();
    for c in name.chars() {
        if c.is_alphanumeric() {
            out.extend(c.to_lowercase());
        } else if !out.is_empty() && !out.ends_with('-') {
            out.push('-');
        }
    }
    let out: String = out.chars().take(LONGEST_NAME).collect();
    let out = out.trim_end_matches('-');
    if out.is_empty() { "unnamed".to_owned() } else { out.to_owned() }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::expect_used)]
mod tests {
    use super::*;

    fn at() -> Timestamp {
        "2026-11-28T04:05:06Z".parse().unwrap()
    }

    #[test]
    fn every_call_has_a_folder_of_its_own() {
        let root = tempfile::tempdir().unwrap();
        let below = Place::Below(root.path().join("identify"));
        let one = Folder::open(&below, "EVA, two balls", at()).unwrap();
        let other = Folder::open(&below, "EVA, two balls", at()).unwrap();
        assert!(one.path().ends_with("eva-two-balls-20261128T040506Z"), "{:?}", one.path());
        assert!(other.path().ends_with("eva-two-balls-20261128T040506Z-2"));
        let mut page = Page::new("a", "");
        page.figure("<svg><title>Force over depth</title></svg>", "");
        one.page("report.html", &page).unwrap();
        assert!(one.path().join("figures/01-force-over-depth.svg").exists());
        assert!(root.path().join("identify/report.html").exists());
    }

    #[test]
    fn a_named_folder_is_replaced_only_where_it_is_ours() {
        let root = tempfile::tempdir().unwrap();
        let named = Place::Named(root.path().to_owned());
        std::fs::write(root.path().join("report.html"), "my own").unwrap();
        let folder = Folder::open(&named, "a", at()).unwrap();
        let refused = folder.page("report.html", &Page::new("a", "")).expect_err("refused").to_string();
        assert!(
            refused.contains("report.html was not written by palpate") && refused.contains("--report"),
            "{refused}"
        );
        assert_eq!(std::fs::read_to_string(root.path().join("report.html")).unwrap(), "my own");
        std::fs::remove_file(root.path().join("report.html")).unwrap();
        folder.sign(&serde_json::json!({ "program": "palpate" })).unwrap();
        let mut page = Page::new("a", "");
        page.figure("<svg><title>old</title></svg>", "");
        folder.page("report.html", &page).unwrap();
        let again = Folder::open(&named, "a", at()).unwrap();
        again.page("report.html", &Page::new("b", "")).unwrap();
        assert!(!root.path().join("figures/01-old.svg").exists());
    }

    #[test]
    fn a_folder_that_cannot_be_made_names_the_option() {
        let root = tempfile::tempdir().unwrap();
        let file = root.path().join("file");
        std::fs::write(&file, "").unwrap();
        let refused = Folder::open(&Place::Below(file.clone()), "a", at()).expect_err("a file").to_string();
        assert!(refused.contains(&file.display().to_string()) && refused.contains("--report DIR"), "{refused}");
    }

    #[test]
    fn names_suit_any_file_system() {
        assert_eq!(["EVA, two balls", "../x", "", "Ä b"].map(plain), ["eva-two-balls", "x", "unnamed", "ä-b"]);
    }
}
