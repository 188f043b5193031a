//! Frames that are files of a folder.

use std::cmp::Ordering;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::super::frame::Frame;
use super::ending::Ending;
use super::error::SourceError;
use super::still;

/// A file that is still being written is whole after this time.
const PATIENCE: Duration = Duration::from_secs(2);

/// Files of a folder.
#[derive(Debug)]
pub struct Folder<'a> {
    place: PathBuf,
    files: Vec<PathBuf>,
    next: usize,
    ending: Ending<'a>,
    failed: bool,
}

/// The PNG files of a folder, in the order of the numbers in their names.
fn files(place: &Path) -> Result<Vec<PathBuf>, SourceError> {
    let failed = |cause| SourceError::Unreadable { name: place.display().to_string(), cause };
    let mut files = Vec::new();
    for entry in std::fs::read_dir(place).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        let is_hidden = path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
        if !is_hidden && path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("png")) && !path.is_dir() {
            files.push(path);
        }
    }
    files.sort_by(|a, b| natural(&name_of(a), &name_of(b)));
    Ok(files)
}

fn name_of(path: &Path) -> String {
    path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

/// Numbers by their value, all else by letters.
fn natural(a: &str, b: &str) -> Ordering {
    let (mut a_rest, mut b_rest) = (a, b);
    loop {
        let digits = |text: &str| text.len() - text.trim_start_matches(|c: char| c.is_ascii_digit()).len();
        let (m, n) = (digits(a_rest), digits(b_rest));
        if m > 0 && n > 0 {
            let (x, y) = (a_rest[..m].trim_start_matches('0'), b_rest[..n].trim_start_matches('0'));
            match x.len().cmp(&y.len()).then_with(|| x.cmp(y)) {
                Ordering::Equal => (a_rest, b_rest) = (&a_rest[m..], &b_rest[n..]),
                order => return order,
            }
            continue;
        }
        match (a_rest.chars().next(), b_rest.chars().next()) {
            (None, None) => return a.cmp(b),
            (Some(x), Some(y)) if x == y => {
                (a_rest, b_rest) = (&a_rest[x.len_utf8()..], &b_rest[y.len_utf8()..]);
            }
            (x, y) => return x.cmp(&y),
        }
    }
}

impl<'a> Folder<'a> {
    /// Of a folder that has at least one file, or will have one.
    pub fn open(place: &Path, ending: Ending<'a>) -> Result<Self, SourceError> {
        loop {
            let files = files(place)?;
            if !files.is_empty() {
                return Ok(Self { place: place.to_owned(), files, next: 0, ending, failed: false });
            }
            if !ending.wait() {
                return Err(SourceError::Empty { name: place.display().to_string() });
            }
        }
    }

    /// Of one file.
    pub fn single(file: &Path) -> Self {
        let files = vec![file.to_owned()];
        Self { place: PathBuf::new(), files, next: 0, ending: Ending::Final, failed: false }
    }

    /// Name of the file that was read last.
    pub fn name(&self) -> String {
        self.files.get(self.next.saturating_sub(1)).map(|file| file.display().to_string()).unwrap_or_default()
    }

    /// A file; where the folder grows, its writer is given time to end it.
    fn read(&self, file: &Path) -> Result<Frame, SourceError> {
        let start = Instant::now();
        loop {
            let read = still::read(file);
            if read.is_ok() || start.elapsed() > PATIENCE || !self.ending.wait() {
                return read;
            }
        }
    }
}

impl Iterator for Folder<'_> {
    type Item = Result<Frame, SourceError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.failed {
            return None;
        }
        while self.next >= self.files.len() {
            if self.place.as_os_str().is_empty() || !self.ending.wait() {
                return None;
            }
            match files(&self.place) {
                // Only what follows the last: numbers rise in a recording.
                Ok(found) => {
                    let last = self.files.last().map(|file| name_of(file)).unwrap_or_default();
                    self.files.extend(found.into_iter().filter(|file| natural(&name_of(file), &last).is_gt()));
                }
                Err(error) => {
                    self.failed = true;
                    return Some(Err(error));
                }
            }
        }
        let file = self.files[self.next].clone();
        self.next += 1;
        let read = self.read(&file);
        self.failed = read.is_err();
        Some(read)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_order_files_by_their_value() {
        let mut names = ["f10.png", "f9.png", "f009a.png", "a.png", "f1.png", "f01.png", ""];
        names.sort_by(|a, b| natural(a, b));
        assert_eq!(names, ["", "a.png", "f01.png", "f1.png", "f9.png", "f009a.png", "f10.png"]);
    }
}
